//! Sixty-four rays that are judged together, and which way they go.

use super::{
    Bvh, Leaves, Node, Stream, Tally, Way,
    bundle::{BUNDLE, Grouping},
    cost::Cost,
    entry::{Segments, children_entered},
    extent::{Extent, diagonal},
    habit::{Coherence, Habit},
    occluder::Occluder,
    stream::TILE_RUNS,
};
use crate::geometry::{Ray, RayLanes, Rayx8, Rayx16};
use crate::simd::{LANES, Mask, Mask16, Real, Vec3x16, f32x8, transpose, u32x8};

/// Packets in a run.
pub(super) const PACKETS: usize = 8;
/// Bundles in a run.
pub(super) const BUNDLES: usize = 4;
/// Rays in a run.
pub(super) const RUN: usize = PACKETS * LANES;
/// Runs up to this [`spread`](Run::spread) may go as tiles.
const TILE_SPREAD: f32 = 0.35;
/// Occlusion rays up to this one may go as packets: most are blocked after a few nodes, which a wave can't
/// make up for its setting up.
const PACKET_SPREAD: f32 = 1.2;

/// Up to sixty-four neighbours, in [places](Grouping).
pub(super) struct Run {
    /// Number of the first ray in its stream.
    pub(super) first: usize,
    len: usize,
    grouping: Grouping,
    pub(super) bundles: [Rayx16; BUNDLES],
    /// Bounds on them, if all were to be traced when they were taken.
    extent: Option<Extent>,
    /// Those that are to be traced: a place is a bit.
    pub(super) active: u64,
    /// Occlusion rays that are known to be blocked; they are not active.
    pub(super) blocked: u64,
}

impl Run {
    /// Bundles that hold a ray.
    pub(super) fn bundles(&self) -> usize {
        self.len.div_ceil(BUNDLE)
    }

    /// Packets that hold a ray.
    pub(super) fn packets(&self) -> usize {
        self.len.div_ceil(LANES)
    }

    /// The rays of a packet.
    #[inline]
    pub(super) fn packet(&self, packet: usize) -> Rayx8 {
        self.bundles[packet / 2].eight(packet % 2)
    }

    /// The rays of a bundle, and which of them are active.
    #[inline]
    pub(super) fn bundle(&self, i: usize) -> (&Rayx16, Mask16) {
        (&self.bundles[i], Mask16::from_bitmask((self.active >> (i * BUNDLE)) as u32 & 0xffff))
    }

    /// How many rays there are.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Are all rays there, and to be traced?
    pub(super) fn is_whole(&self) -> bool {
        self.active == u64::MAX
    }

    /// Which ray of the stream is at a place.
    #[inline]
    pub(super) fn ray(&self, place: usize) -> usize {
        self.first + self.grouping.ray(place)
    }

    /// The same for a packet.
    #[inline]
    pub(super) fn numbers(&self, packet: usize) -> u32x8 {
        let [low, high] = [0, LANES / 2].map(|lane| self.ray(packet * LANES + lane) as u32);
        u32x8::new([low, low + 1, low + 2, low + 3, high, high + 1, high + 2, high + 3])
    }

    pub(super) fn grouping(&self) -> Grouping {
        self.grouping
    }

    /// May two runs be one tile?
    fn goes_with(&self, other: &Self) -> bool {
        let octant = |run: &Self| run.bundles[0].rdir.lane(0).to_array().map(|r| r < 0.0);
        self.extent().is_some() && other.extent().is_some() && octant(self) == octant(other)
    }

    /// Which places hold rays of the stream.
    pub(super) fn there(&self) -> u64 {
        if self.len == 0 { 0 } else { u64::MAX >> (RUN - self.len) }
    }

    fn load<S: Stream>(&mut self, stream: &S, first: usize, grouping: Grouping) {
        (self.first, self.len) = (first, RUN.min(stream.len() - first));
        self.grouping = if self.len == RUN { grouping } else { Grouping::Rows };
        (self.active, self.blocked) = (0, 0);
        for packet in 0..self.packets() {
            let number = packet * LANES;
            let (rays, active) = stream.packet(first + number);
            self.grouping.put(&rays, number, &mut self.bundles);
            let active = u64::from(active.to_bitmask());
            self.active |= (active & 0xf) << self.grouping.place(number)
                | (active >> 4) << self.grouping.place(number + 4);
        }
        self.extent = None;
    }

    /// Where occlusion rays may start; `None` if their segments are not all bounded.
    pub(super) fn entry(&self, bvh: &Bvh) -> Option<Node> {
        let mut segments = Segments::none();
        for i in 0..self.bundles() {
            let (rays, active) = self.bundle(i);
            segments.add(rays, active);
        }
        segments.bounds(bvh.reach()).map(|bounds| bvh.entry(bounds))
    }

    /// Which children of a node each ray enters, as bits, and which places hold rays that enter any.
    pub(super) fn enter(&self, node: &Node, entered: &mut [u8; RUN]) -> u64 {
        let mut any = 0;
        for (bundle, entered) in (0..self.bundles()).zip(entered.as_chunks_mut().0) {
            let rays;
            (*entered, rays) = children_entered(node, &self.bundles[bundle]);
            any |= u64::from(rays) << (bundle * BUNDLE);
        }
        any
    }

    /// Bounds on the rays, where they may be wanted: for a tile.
    fn bound(&mut self) {
        if self.is_whole() {
            self.extent = Extent::of(&self.bundles);
        }
    }

    /// Bounds on the rays; `None` unless all are there, to be traced, and may point into one octant.
    pub(super) fn extent(&self) -> Option<&Extent> {
        self.extent.as_ref().filter(|_| self.is_whole())
    }

    /// The diagonal of the box around the directions, in lengths of its middle, and whether they point into one
    /// octant.
    fn spread(&self) -> (f32, bool) {
        if let Some(spread) = self.extent().and_then(Extent::spread) {
            return (spread, true);
        }
        let (mut low, mut high) =
            (Vec3x16::splat(glam::Vec3::INFINITY), Vec3x16::splat(glam::Vec3::NEG_INFINITY));
        for i in 0..BUNDLES {
            let (rays, active) = self.bundle(i);
            low = Vec3x16::select(active, rays.dir.min(low), low);
            high = Vec3x16::select(active, rays.dir.max(high), high);
        }
        let fold = |v: Vec3x16, of: fn(f32x8, f32x8) -> f32x8| {
            v.map(|v| {
                let [one, other] = v.halves();
                of(one, other)
            })
        };
        let (low, high) = (fold(low, Real::min), fold(high, Real::max));
        // Six minima over lanes by one transposition.
        let [low, high] = [low, -high].map(|v| [v.x, v.y, v.z]);
        let rows = transpose([low[0], low[1], low[2], low[2], high[0], high[1], high[2], high[2]]);
        let least = rows.into_iter().reduce(Real::min).unwrap_or_default();
        let [lx, ly, lz, _, hx, hy, hz, _] = least.to_array();
        let sides = [(lx, -hx), (ly, -hy), (lz, -hz)];
        (diagonal(sides), sides.iter().all(|&(low, high)| low >= 0.0 || high <= 0.0))
    }
}

/// The runs of a stream, one after the other, and what has been learnt from those before.
pub(super) struct Runs {
    /// The run that is looked at, and those after it.
    run: Box<[Run; TILE_RUNS]>,
    next: usize,
    /// What would have suited the last run.
    grouping: Grouping,
    forced: Way,
    /// The ways of those that are loaded and have not been taken.
    waiting: [Option<Way>; TILE_RUNS],
    /// How their rays lie together.
    coherence: [Coherence; TILE_RUNS],
    /// Is the tree one that scattered rays had better go through alone?
    far: bool,
    /// What has been learnt from closest hits and from occlusion, of each kind of rays.
    habits: [[Habit; Coherence::COUNT]; 2],
    pub(super) occluder: Occluder,
}

impl Default for Runs {
    fn default() -> Self {
        let nothing = RayLanes::splat(&Ray::new(glam::Vec3::ZERO, glam::Vec3::ONE, 0.0, -1.0));
        let (bundles, grouping) = ([nothing; BUNDLES], Grouping::Rows);
        let run = || Run { first: 0, len: 0, grouping, bundles, extent: None, active: 0, blocked: 0 };
        Self {
            run: Box::new(std::array::from_fn(|_| run())),
            next: 0,
            grouping: Grouping::Rows,
            forced: Way::Chosen,
            waiting: [None; TILE_RUNS],
            coherence: [Coherence::Scattered; TILE_RUNS],
            far: false,
            habits: [[Habit::default(); Coherence::COUNT]; 2],
            occluder: Occluder::default(),
        }
    }
}

impl Runs {
    /// Begins a stream.
    pub(super) fn start(&mut self, way: Way, far: bool) {
        (self.next, self.forced, self.waiting, self.far) = (0, way, [None; TILE_RUNS], far);
        self.occluder.forget();
    }

    /// The way that the next run goes; `None` at the end of the stream.
    pub(super) fn peek<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &mut self,
        leaves: &L,
        stream: &S,
        tally: &mut T,
    ) -> Option<Way> {
        if self.waiting[0].is_none() {
            if let Some(left) = (1..TILE_RUNS).find(|&i| self.waiting[i].is_some()) {
                self.run.swap(0, left);
                self.waiting.swap(0, left);
                self.coherence.swap(0, left);
            } else if self.load::<ANY, L, S, T>(0, leaves, stream, tally) {
                self.judge::<ANY>(0);
            }
        }
        self.waiting[0]
    }

    /// Loads the next run; false if there is none.
    fn load<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &mut self,
        which: usize,
        leaves: &L,
        stream: &S,
        tally: &mut T,
    ) -> bool {
        if self.next >= stream.len() {
            return false;
        }
        let run = &mut self.run[which];
        run.load(stream, self.next, self.grouping);
        // What suits one run of a stream mostly suits the others.
        if run.len == RUN && self.next.is_multiple_of(TILE_RUNS * RUN) {
            self.grouping = run.grouping.better(&run.bundles);
        }
        self.next += run.len;
        if ANY {
            self.occluder.block(run, leaves, tally);
        }
        if !ANY || self.forced == Way::Tile {
            run.bound();
        }
        true
    }

    /// Decides which way a run goes that was loaded.
    fn judge<const ANY: bool>(&mut self, which: usize) {
        let chosen = self.forced == Way::Chosen;
        self.waiting[which] = Some(if chosen { self.choose::<ANY>(which) } else { self.forced });
    }

    /// The run that was looked at.
    pub(super) fn take(&mut self) -> &Run {
        self.waiting[0] = None;
        &self.run[0]
    }

    /// The run that was looked at and goes as a tile, and those after it as far as they go with it: up to the next whole
    /// tile of the stream, as neighbours come in squares, or not at all.
    pub(super) fn take_tile<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &mut self,
        leaves: &L,
        stream: &S,
        tally: &mut T,
    ) -> &[Run] {
        self.waiting[0] = None;
        let mut count = 1;
        while !self.next.is_multiple_of(TILE_RUNS * RUN)
            && self.load::<ANY, L, S, T>(count, leaves, stream, tally)
        {
            if !self.run[0].goes_with(&self.run[count]) {
                self.judge::<ANY>(count);
                break;
            }
            count += 1;
        }
        &self.run[..count]
    }

    /// The [`Coherence`] of the run that was looked at, as a set.
    pub(super) fn kind(&self) -> u32 {
        self.coherence[0].bit()
    }

    /// Remembers what the run that was taken cost as a tile or as packets.
    pub(super) fn learn_together<const ANY: bool>(&mut self, cost: Cost, rays: usize) {
        let coherence = self.coherence[0];
        let cost = match (ANY, coherence) {
            (true, _) => cost * Cost::OCCLUSION,
            (false, Coherence::Scattered) => cost * Cost::FAR,
            _ => cost,
        };
        self.habits[usize::from(ANY)][coherence as usize].learn_together(cost.0 / rays as f32);
    }

    /// Remembers what rays of some kinds cost in a wave.
    pub(super) fn learn_alone<const ANY: bool>(&mut self, cost: Cost, rays: u32, kinds: u32) {
        for (kind, habit) in self.habits[usize::from(ANY)].iter_mut().enumerate() {
            if rays > 0 && kinds >> kind & 1 != 0 {
                habit.learn_alone(cost.0 / rays as f32);
            }
        }
    }

    fn choose<const ANY: bool>(&mut self, which: usize) -> Way {
        let coherence = match self.run[which].spread() {
            (spread, true) if spread <= if ANY { PACKET_SPREAD } else { TILE_SPREAD } => Coherence::Coherent,
            (spread, _) if !ANY && spread <= TILE_SPREAD => Coherence::Straddling,
            _ => Coherence::Scattered,
        };
        self.coherence[which] = coherence;
        if coherence == Coherence::Scattered && self.far {
            return Way::Wave;
        }
        if !self.habits[usize::from(ANY)][coherence as usize].choose_together(coherence) {
            Way::Wave
        } else if coherence == Coherence::Coherent && !ANY {
            Way::Tile
        } else {
            Way::Packet
        }
    }
}
