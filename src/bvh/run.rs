//! Sixty-four rays that are judged together, and which way they go.

use super::{Bvh, Leaves, Node, Stream, Tally, Way, cost::Cost, entry::Segments, occluder::Occluder};
use crate::geometry::{Ray, RayLanes, Rayx8};
use crate::simd::{LANES, Mask, Mask8, Real, Vec3x8, transpose};

/// Packets in a run.
pub(super) const PACKETS: usize = 8;
/// Rays in a run.
pub(super) const RUN: usize = PACKETS * LANES;
/// Runs up to this [`spread`](Run::spread) may go as tiles.
const TILE_SPREAD: f32 = 0.35;
/// Occlusion rays up to this one may go as packets: most are blocked after a few nodes, which a wave can't
/// make up for its setting up.
const PACKET_SPREAD: f32 = 1.2;
/// One run in so many goes the way that has cost more, to see whether it still does; in twice as many if that
/// has cost twice as much.
const PROBE: u32 = 64;

/// The same for scattered rays, which packets seldom suit.
const PROBE_SCATTERED: u32 = 512;

/// Up to sixty-four neighbours.
pub(super) struct Run {
    /// Place of the first ray in its stream.
    pub(super) first: usize,
    len: usize,
    pub(super) rays: [Rayx8; PACKETS],
    pub(super) active: [Mask8; PACKETS],
    /// Occlusion rays that are known to be blocked; they are not active.
    pub(super) blocked: [Mask8; PACKETS],
}

impl Run {
    /// Packets that hold a ray.
    pub(super) fn packets(&self) -> usize {
        self.len.div_ceil(LANES)
    }

    /// Which places of the run are in the stream: ray i is bit i.
    pub(super) fn there(&self) -> u64 {
        if self.len == 0 { 0 } else { u64::MAX >> (RUN - self.len) }
    }

    /// The rays that are known to be blocked: ray i is bit i.
    pub(super) fn blocked(&self) -> u64 {
        let bits = |(i, blocked): (usize, &Mask8)| u64::from(blocked.to_bitmask()) << (i * LANES);
        self.blocked.iter().enumerate().map(bits).sum()
    }

    fn load<S: Stream>(&mut self, stream: &S, first: usize, reach: glam::Vec3) {
        (self.first, self.len) = (first, RUN.min(stream.len() - first));
        for packet in 0..PACKETS {
            self.active[packet] = Mask8::splat(false);
            self.blocked[packet] = Mask8::splat(false);
            if packet * LANES < self.len {
                let (rays, active) = stream.packet(first + packet * LANES);
                (self.rays[packet], self.active[packet]) = (rays.within(reach), active);
            }
        }
    }

    /// Where occlusion rays may start; `None` if their segments are not all bounded.
    pub(super) fn entry(&self, bvh: &Bvh) -> Option<Node> {
        let mut segments = Segments::none();
        for (rays, active) in self.rays.iter().zip(self.active) {
            segments.add(rays, active);
        }
        segments.bounds(bvh.reach()).map(|bounds| bvh.entry(bounds))
    }

    /// The diagonal of the box around the directions, in lengths of its middle; `None` if they point into
    /// several octants.
    fn spread(&self) -> Option<f32> {
        let mut low = Vec3x8::splat(glam::Vec3::INFINITY);
        let mut high = Vec3x8::splat(glam::Vec3::NEG_INFINITY);
        for (rays, &active) in self.rays.iter().zip(&self.active) {
            if active.all() {
                (low, high) = (rays.dir.min(low), rays.dir.max(high));
            } else {
                low = Vec3x8::select(active, rays.dir.min(low), low);
                high = Vec3x8::select(active, rays.dir.max(high), high);
            }
        }
        // Six minima over lanes by one transposition.
        let [low, high] = [low, -high].map(|v| [v.x, v.y, v.z]);
        let rows = transpose([low[0], low[1], low[2], low[2], high[0], high[1], high[2], high[2]]);
        let [lx, ly, lz, _, hx, hy, hz, _] = rows.into_iter().reduce(Real::min)?.to_array();
        let (mut diagonal, mut length) = (0.0, 0.0);
        for (low, high) in [(lx, -hx), (ly, -hy), (lz, -hz)] {
            if low < 0.0 && high > 0.0 {
                return None;
            }
            diagonal += (high - low) * (high - low);
            length += (high + low) * (high + low) * 0.25;
        }
        Some((diagonal / length).sqrt())
    }
}

/// The runs of a stream, one after the other, and what has been learnt from those before.
pub(super) struct Runs {
    run: Box<Run>,
    next: usize,
    forced: Way,
    /// The way of the run that is loaded and has not been taken.
    waiting: Option<Way>,
    /// Does it point into one octant and spread little?
    bundle: bool,
    /// Is the tree one that scattered rays had better go through alone?
    far: bool,
    /// What has been learnt from closest hits and from occlusion, of scattered rays and of bundles.
    habits: [[Habit; 2]; 2],
    pub(super) occluder: Occluder,
}

/// What a ray cost lately; 0 before anything is known.
#[derive(Clone, Copy, Debug, Default)]
struct Habit {
    together: f32,
    alone: f32,
    turn: u32,
}

impl Habit {
    fn choose_together(&mut self, probe: u32) -> bool {
        let (less, more) = (self.together.min(self.alone), self.together.max(self.alone));
        let cheaper = less == 0.0 || self.together <= self.alone;
        // The dearer the other way, the less often it is worth a try.
        self.turn += 1;
        if self.turn as f32 * less < probe as f32 * more {
            return cheaper;
        }
        self.turn = 0;
        !cheaper
    }
}

fn blend(lately: &mut f32, now: f32) {
    *lately = if *lately == 0.0 { now } else { 0.75 * *lately + 0.25 * now };
}

impl Default for Runs {
    fn default() -> Self {
        let nothing = RayLanes::splat(&Ray::new(glam::Vec3::ZERO, glam::Vec3::ONE, 0.0, -1.0));
        let (rays, active) = ([nothing; PACKETS], [Mask8::splat(false); PACKETS]);
        let run = Box::new(Run { first: 0, len: 0, rays, active, blocked: active });
        Self {
            run,
            next: 0,
            forced: Way::Chosen,
            waiting: None,
            bundle: false,
            far: false,
            habits: [[Habit::default(); 2]; 2],
            occluder: Occluder::default(),
        }
    }
}

impl Runs {
    /// Begins a stream.
    pub(super) fn start(&mut self, way: Way, far: bool) {
        (self.next, self.forced, self.waiting, self.far) = (0, way, None, far);
        self.occluder.forget();
    }

    /// The way that the next run goes; `None` at the end of the stream.
    pub(super) fn peek<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &mut self,
        bvh: &Bvh,
        leaves: &L,
        stream: &S,
        tally: &mut T,
    ) -> Option<Way> {
        if self.waiting.is_none() && self.next < stream.len() {
            self.run.load(stream, self.next, bvh.reach());
            self.next += self.run.len;
            if ANY {
                self.occluder.block(&mut self.run, leaves, tally);
            }
            self.waiting = Some(if self.forced == Way::Chosen { self.choose::<ANY>() } else { self.forced });
        }
        self.waiting
    }

    /// The run that was looked at.
    pub(super) fn take(&mut self) -> &Run {
        self.waiting = None;
        &self.run
    }

    /// The kind of the run that was looked at: bit 0 if it is scattered, bit 1 if it is a bundle.
    pub(super) fn kind(&self) -> u32 {
        1 << u32::from(self.bundle)
    }

    /// Remembers what the run that was taken cost as a tile or as packets.
    pub(super) fn learn_together<const ANY: bool>(&mut self, cost: Cost) {
        let habit = &mut self.habits[usize::from(ANY)][usize::from(self.bundle)];
        let cost = if self.bundle { cost } else { cost * Cost::FAR };
        blend(&mut habit.together, cost.0 / self.run.len as f32);
    }

    /// Remembers what rays of some kinds cost in a wave.
    pub(super) fn learn_alone<const ANY: bool>(&mut self, cost: Cost, rays: u32, kinds: u32) {
        for (bit, habit) in self.habits[usize::from(ANY)].iter_mut().enumerate() {
            if kinds >> bit & 1 != 0 {
                blend(&mut habit.alone, cost.0 / rays as f32);
            }
        }
    }

    fn choose<const ANY: bool>(&mut self) -> Way {
        let limit = if ANY { PACKET_SPREAD } else { TILE_SPREAD };
        self.bundle = self.run.spread().is_some_and(|spread| spread <= limit);
        if !self.bundle && self.far {
            return Way::Wave;
        }
        let probe = if self.bundle { PROBE } else { PROBE_SCATTERED };
        if !self.habits[usize::from(ANY)][usize::from(self.bundle)].choose_together(probe) {
            Way::Wave
        } else if self.bundle && !ANY {
            Way::Tile
        } else {
            Way::Packet
        }
    }
}
