//! Rays made ready for a wave, a run of neighbours at a time.

use super::slot::Slot;
use crate::bvh::{
    Bvh, Leaves, Node, Stream, Tally, Way,
    cost::Cost,
    node::Side,
    run::{PACKETS, RUN, Runs},
    stream::Ahead,
};
use crate::geometry::{Hit, RayLanes, Rayx8};
use crate::simd::{Groups, LANES, Mask, Real, Vec3x8, f32x8, transpose, u32x8, vector3};

/// Ulps of |rdir|·(|org| + |bound|) by which slabs are widened: 3 for the fused form and its constant, 12
/// for the widening and the rounding of the kernels' own test.
const MARGIN: f32 = 8.0 * f32::EPSILON;
/// The same for distances of so few bits that each operation may be off by one of them.
const LEAST: f32 = 1e-43;
/// Greatest magnitude of a reciprocal direction in box tests.
const STEEPEST: f32 = 1e18;

/// All that a ray needs on its way, in rows that are copied whole.
///
/// ```text
/// inv x y z     near shift x y z   t_near  t_far
/// far shift x y z   index          org x y z    t_near
/// dir x y z   margin               rdir x y z   –
/// ```
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Ready {
    rows: [[f32; 8]; 3],
    /// Which plane is met first along each axis, and which last: no step has to work out either. The fourth fills a word.
    near: [Side; 4],
    far: [Side; 4],
}

/// What a box test needs along an axis: a plane at x is met at x·inv + shift.
pub(super) struct Slab {
    pub(super) inv: f32,
    /// The plane that is met first, moved back by the margin.
    pub(super) near: Side,
    pub(super) near_shift: f32,
    /// The one that is met last, moved on.
    pub(super) far: Side,
    pub(super) far_shift: f32,
}

impl Ready {
    pub(super) const NOTHING: Self =
        Self { rows: [[0.0; 8]; 3], near: [Side::Lower; 4], far: [Side::Upper; 4] };

    #[inline]
    pub(super) fn slab(&self, axis: usize) -> Slab {
        let [first, second, _] = &self.rows;
        let (near, far) = (self.near[axis], self.far[axis]);
        Slab { inv: first[axis], near, near_shift: first[axis + 3], far, far_shift: second[axis] }
    }

    /// Lower end of the ray, not below 0, for box tests.
    #[inline]
    pub(super) fn t_near(&self) -> f32 {
        self.rows[0][6]
    }

    #[inline]
    pub(super) fn t_far(&self) -> f32 {
        self.rows[0][7]
    }

    #[inline]
    pub(super) fn index(&self) -> usize {
        self.rows[1][3].to_bits() as usize
    }

    /// The rays themselves, each in a group of lanes, for the leaves, up to where each ends by now.
    #[inline(always)]
    pub(super) fn lanes<const N: usize, R: Groups<N>>(rays: [&Self; N], ends: [f32; N]) -> RayLanes<R> {
        let splats = |row: usize, half: usize| {
            let mut numbers = [[0.0; 4]; N];
            for (numbers, ray) in numbers.iter_mut().zip(rays) {
                numbers.copy_from_slice(&ray.rows[row][half * 4..half * 4 + 4]);
            }
            R::splats(numbers)
        };
        let [org_x, org_y, org_z, t_near] = splats(1, 1);
        let [dir_x, dir_y, dir_z, margin] = splats(2, 0);
        let [rdir_x, rdir_y, rdir_z, _] = splats(2, 1);
        RayLanes {
            org: vector3(org_x, org_y, org_z),
            dir: vector3(dir_x, dir_y, dir_z),
            rdir: vector3(rdir_x, rdir_y, rdir_z),
            t_near,
            t_far: R::splat_each(ends),
            margin,
        }
    }

    /// The rays of a packet that starts at a place in its stream.
    fn packet(rays: &Rayx8, index: u32x8, reach: glam::Vec3, ready: &mut [Self; LANES]) {
        let RayLanes { org, dir, rdir, t_near, t_far, margin } = rays;
        let inv = rdir.map(|r| r.max(f32x8::splat(-STEEPEST)).min(f32x8::splat(STEEPEST)));
        let reach = Vec3x8::splat(reach);
        // At this t a ray has left what can be hit, whichever axis says so (0·∞ says nothing); twice, against rounding.
        let leaves = |rdir: f32x8, org: f32x8, reach: f32x8| (org.abs() + reach) * rdir.abs();
        let last = leaves(rdir.x, org.x, reach.x).min(f32x8::splat(f32::INFINITY));
        let last = leaves(rdir.y, org.y, reach.y).min(leaves(rdir.z, org.z, reach.z).min(last));
        let last = last + last;
        let axis = |rdir: f32x8, inv: f32x8, org: f32x8, reach: f32x8| {
            // A slab that is met too early because its reciprocal was cut off stays open until then.
            let steep = f32x8::splat(STEEPEST).lt(rdir.abs());
            let open = f32x8::select(steep, last, f32x8::splat(LEAST));
            let room = f32x8::splat(MARGIN) * inv.abs() * (org.abs() + reach) + open;
            // Nothing is moved where there is all the room: a difference of infinities would be nowhere.
            let shift = -(org * inv).only(room.lt(f32x8::splat(f32::INFINITY)));
            (shift - room, shift + room)
        };
        let x = axis(rdir.x, inv.x, org.x, reach.x);
        let y = axis(rdir.y, inv.y, org.y, reach.y);
        let z = axis(rdir.z, inv.z, org.z, reach.z);
        let rows = [
            transpose([inv.x, inv.y, inv.z, x.0, y.0, z.0, t_near.max(f32x8::zero()), *t_far]),
            transpose([x.1, y.1, z.1, f32x8::from_bits(index), org.x, org.y, org.z, *t_near]),
            transpose([dir.x, dir.y, dir.z, *margin, rdir.x, rdir.y, rdir.z, f32x8::zero()]),
        ];
        let negative = [inv.x, inv.y, inv.z].map(|inv| inv.lt(f32x8::zero()).to_bitmask());
        for (i, ready) in ready.iter_mut().enumerate() {
            let sides = |sides: [Side; 2]| {
                let of = |axis: usize| sides[usize::from(negative[axis] >> i & 1 != 0)];
                [of(0), of(1), of(2), Side::Lower]
            };
            *ready = Self {
                rows: [rows[0][i].to_array(), rows[1][i].to_array(), rows[2][i].to_array()],
                near: sides([Side::Lower, Side::Upper]),
                far: sides([Side::Upper, Side::Lower]),
            };
        }
    }
}

/// The rays of a run that have not started.
pub(super) struct Feed {
    ready: Box<[[Ready; LANES]; PACKETS]>,
    /// Ray i is bit i.
    waiting: u64,
    /// Where occlusion rays of the run start, if not at the root.
    entry: Option<Node>,
    /// The children of it that each ray enters, as bits.
    entered: [u8; RUN],
    /// Rays that were answered at once since this was last asked, and the [kinds](Runs::kind) of all.
    answered: u32,
    kinds: u32,
    /// The kind of the run that is handed out.
    kind: u32,
}

impl Default for Feed {
    fn default() -> Self {
        Self {
            ready: Box::new([[Ready::NOTHING; LANES]; PACKETS]),
            waiting: 0,
            entry: None,
            entered: [0; RUN],
            answered: 0,
            kinds: 0,
            kind: 0,
        }
    }
}

impl Feed {
    /// A wave begins.
    pub(super) fn begin(&mut self) {
        (self.answered, self.kinds, self.kind) = (0, 0, 0);
    }

    /// Remembers what the rays since this was last said have cost: those that the wave answered, and those that
    /// were answered at once.
    // Out of the way: the wave has no register to spare for what happens once in sixty-four rays.
    #[cold]
    #[inline(never)]
    pub(super) fn tell<const ANY: bool>(&mut self, runs: &mut Runs, ended: u32, cost: Cost) {
        let rays = std::mem::take(&mut self.answered) + ended;
        let kinds = std::mem::replace(&mut self.kinds, self.kind);
        runs.learn_alone::<ANY>(cost + Cost::RAY * rays, rays, kinds);
    }

    /// Starts the next ray in a slot; false if there is none, or if the next run goes another way. Rays that
    /// can't hit anything are answered.
    #[inline]
    pub(super) fn next<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &mut self,
        bvh: &Bvh,
        leaves: &L,
        stream: &mut S,
        runs: &mut Runs,
        slot: &mut Slot,
        tally: &mut T,
    ) -> bool {
        while self.waiting == 0 {
            if runs.peek::<ANY, L, S, T>(leaves, stream, tally) != Some(Way::Wave) {
                return false;
            }
            self.refill::<ANY, S>(bvh, stream, runs);
        }
        let next = self.waiting.trailing_zeros() as usize % RUN;
        self.waiting &= self.waiting - 1;
        let ray = &self.ready[next / LANES][next % LANES];
        match &self.entry {
            Some(node) if ANY => slot.start_below(ray, node, self.entered[next]),
            _ => slot.start(ray),
        }
        true
    }

    fn refill<const ANY: bool, S: Stream>(&mut self, bvh: &Bvh, stream: &mut S, runs: &mut Runs) {
        self.kind = runs.kind();
        self.kinds |= self.kind;
        let run = runs.take();
        Ahead::new(run.first, RUN).finish(stream);
        self.entry = if ANY { run.entry(bvh) } else { None };
        if !bvh.nodes.is_empty() {
            let reach = bvh.reach();
            self.waiting = match &self.entry {
                Some(node) if ANY => run.active & run.enter(node, &mut self.entered),
                _ => run.active,
            };
            for packet in 0..run.packets() {
                if self.waiting >> (packet * LANES) & 0xff == 0 {
                    continue;
                }
                let index = run.numbers(packet);
                Ready::packet(&run.packet(packet), index, reach, &mut self.ready[packet]);
            }
        }
        self.waiting &= run.there();
        let blocked = run.blocked;
        let mut never = run.there() & !self.waiting;
        self.answered += never.count_ones();
        while never != 0 {
            let which = never.trailing_zeros() as usize;
            let hit = if blocked >> which & 1 != 0 { Hit::BLOCKED } else { Hit::MISS };
            stream.answer(run.ray(which), &hit);
            never &= never - 1;
        }
    }
}
