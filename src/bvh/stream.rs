//! Any rays, in order, each by the way that suits its neighbours.
//!
//! Nothing is known about where the rays come from. Runs of sixty-four are judged by what is in them (see
//! [`Runs`]): those that point into one octant and spread little may go as a tile, occlusion rays as packets,
//! as long as that turns out to cost less than the wave, which takes all the others. The answer does not
//! depend on the way.

use super::{
    Bvh, Child, Hitx16, Leaves, Tally, Traversal, Wave,
    beam::Beam,
    bundle::BUNDLE,
    cost::Cost,
    run::{BUNDLES, RUN, Run, Runs},
};
use crate::geometry::{Hit, Rayx8};
use crate::simd::{LANES, Mask, Mask8, Real, f32x16};

/// Rays to be traced, and where their answers go.
pub trait Stream {
    /// How many rays there are.
    fn len(&self) -> usize;
    /// The rays from a multiple of eight on, and which of them are rays.
    fn packet(&self, first: usize) -> (Rayx8, Mask8);
    /// Takes an answer: [`Hit::MISS`], a hit, or for an occlusion query [`Hit::BLOCKED`].
    fn answer(&mut self, index: usize, hit: &Hit);
    /// Takes the answers of eight neighbours.
    #[inline]
    fn answer_packet(&mut self, first: usize, hits: [Hit; LANES]) {
        hits.iter().enumerate().for_each(|(i, hit)| self.answer(first + i, hit));
    }

    /// Takes the answers of an occlusion query for up to 64 neighbours: the i-th is blocked if bit i says so.
    #[inline]
    fn answer_blocked(&mut self, first: usize, count: usize, blocked: u64) {
        for i in 0..count {
            let hit = if blocked >> i & 1 != 0 { Hit::BLOCKED } else { Hit::MISS };
            self.answer(first + i, &hit);
        }
    }

    /// Eight rays, from a multiple of eight on, will be asked for soon, and their answers given: memory may begin to bring
    /// both. There may be no such rays.
    #[inline]
    fn expect(&self, first: usize) {
        let _ = first;
    }

    /// Is there nothing to trace?
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// What tracing needs beside the tree, kept from stream to stream.
pub struct Tracer<T = ()> {
    /// For packets and single rays.
    pub traversal: Traversal<T>,
    runs: Runs,
    wave: Wave,
}

impl<T> Tracer<T> {
    /// Nothing traced yet.
    pub fn new(tally: T) -> Self {
        Self { traversal: Traversal::new(tally), runs: Runs::default(), wave: Wave::default() }
    }
}

/// Runs in a tile, and their bundles.
pub(super) const TILE_RUNS: usize = 4;
pub(super) const TILE: usize = TILE_RUNS * BUNDLES;

/// How many rays a stream expects before they are loaded: a tile.
pub(super) const AHEAD: usize = TILE_RUNS * RUN;

/// Asks memory for the next rays step by step, while those before are traced: all at once would be more than it can
/// have on its way, and the processor would wait until the queue is shorter.
pub(super) struct Ahead {
    next: usize,
    end: usize,
}

impl Ahead {
    /// While rays from `first` on are traced, `count` of them.
    pub(super) fn new(first: usize, count: usize) -> Self {
        Self { next: first + AHEAD, end: first + AHEAD + count }
    }

    /// Eight more.
    #[inline]
    pub(super) fn step<S: Stream>(&mut self, stream: &S) {
        if self.next < self.end {
            stream.expect(self.next);
            self.next += LANES;
        }
    }

    /// Whatever has not been asked for yet.
    pub(super) fn finish<S: Stream>(&mut self, stream: &S) {
        while self.next < self.end {
            self.step(stream);
        }
    }
}

/// How to go through the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Whatever suits the rays.
    Chosen,
    /// Tiles of up to 256, as packets where they point into several octants.
    Tile,
    /// Packets of sixteen.
    Packet,
    /// Thirty-two single rays in turn.
    Wave,
}

impl Bvh {
    /// Traces all rays of a stream. Every [`Way`] gives the same answers, to the bit.
    pub fn intersect_stream<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &self,
        leaves: &L,
        stream: &mut S,
        way: Way,
        tracer: &mut Tracer<T>,
    ) {
        let Tracer { traversal, runs, wave } = tracer;
        runs.start(way, self.is_far());
        // Leaves are those of one tree, and a tracer may go from one to the next.
        traversal.blocker = Child::ABSENT;
        while let Some(way) = runs.peek::<ANY, L, S, T>(leaves, stream, &mut traversal.tally) {
            match way {
                // Runs that follow each other are one wave, which is filled and drained once.
                Way::Wave => {
                    self.intersect_wave::<ANY, L, S, T>(leaves, stream, runs, wave, &mut traversal.tally);
                }
                Way::Packet => {
                    let cost = self.packets::<ANY, L, S, T>(leaves, stream, runs.take(), traversal);
                    runs.occluder.remember(traversal.blocker);
                    runs.learn_together::<ANY>(cost, RUN);
                }
                Way::Chosen | Way::Tile => {
                    let tally = &mut traversal.tally;
                    let tile = runs.take_tile::<ANY, L, S, T>(leaves, stream, tally);
                    let rays = tile.iter().map(Run::len).sum();
                    let cost = match self.tile::<ANY, L, S, T>(leaves, stream, tile, traversal) {
                        Some(cost) => cost,
                        None => tile.iter().fold(Cost::default(), |cost, run| {
                            cost + self.packets::<ANY, L, S, T>(leaves, stream, run, traversal)
                        }),
                    };
                    runs.learn_together::<ANY>(cost, rays);
                }
            }
        }
    }

    /// Traces up to four runs as a tile if they are whole and point into one octant.
    fn tile<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &self,
        leaves: &L,
        stream: &mut S,
        runs: &[Run],
        traversal: &mut Traversal<T>,
    ) -> Option<Cost> {
        let extent = |i: usize| runs.get(i).or(runs.last()).and_then(Run::extent);
        let beams = Beam::of_runs([extent(0)?, extent(1)?, extent(2)?, extent(3)?])?;
        let bundle = |i: usize| runs.get(i / BUNDLES).map(|run| &run.bundles[i % BUNDLES]);
        let rays = std::array::from_fn(|i| bundle(i).unwrap_or(&runs[0].bundles[0]));
        // Nothing is hit before −∞, where there is no ray.
        let mut hits = [Hitx16::nothing(f32x16::splat(f32::NEG_INFINITY)); TILE];
        for (hit, rays) in hits.iter_mut().zip(runs.iter().flat_map(|run| &run.bundles)) {
            hit.t = rays.t_far;
        }
        let mut ahead = Ahead::new(runs[0].first, RUN * runs.len());
        let step = || ahead.step(stream);
        let cost = self.intersect_tile::<ANY, L, T>(leaves, (&rays, &beams), &mut hits, step, traversal);
        for (run, hits) in runs.iter().zip(hits.chunks(BUNDLES)) {
            if ANY {
                let bits =
                    |hit: &Hitx16| u64::from(hit.t.equal(f32x16::splat(f32::NEG_INFINITY)).to_bitmask());
                let blocked = hits.iter().rev().fold(0, |blocked, hit| blocked << BUNDLE | bits(hit));
                stream.answer_blocked(run.first, RUN, run.grouping().in_order(blocked));
                continue;
            }
            for first in (0..RUN).step_by(LANES) {
                let hits = run.grouping().hits(first, hits).or_miss(Mask8::splat(true)).to_hits();
                stream.answer_packet(run.first + first, hits);
                ahead.step(stream);
            }
        }
        ahead.finish(stream);
        Some(cost)
    }

    /// Traces a run as packets, and returns what that cost.
    fn packets<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &self,
        leaves: &L,
        stream: &mut S,
        run: &Run,
        traversal: &mut Traversal<T>,
    ) -> Cost {
        let mut cost = Cost::default();
        let entry = if ANY { run.entry(self) } else { None };
        let start = entry.as_ref().or(self.nodes.first());
        let mut blocked = run.blocked;
        let mut hits = [Hitx16::nothing(f32x16::zero()); BUNDLES];
        let mut ahead = Ahead::new(run.first, RUN);
        for (i, hit) in hits.iter_mut().enumerate().take(run.bundles()) {
            ahead.step(stream);
            ahead.step(stream);
            let (ray, active) = run.bundle(i);
            hit.t = ray.t_far;
            if let Some(start) = start {
                let rays = (ray, active);
                cost += self.intersect_packet_from::<ANY, f32x16, L, T>(start, leaves, rays, hit, traversal);
            }
            if ANY {
                let bits = (hit.t.equal(f32x16::splat(f32::NEG_INFINITY)) & active).to_bitmask();
                blocked |= u64::from(bits) << (i * BUNDLE);
            }
        }
        if ANY {
            stream.answer_blocked(run.first, run.len(), run.grouping().in_order(blocked));
        } else {
            let active = run.grouping().in_order(run.active);
            for first in (0..run.len()).step_by(LANES) {
                let active = Mask8::from_bitmask((active >> first) as u32 & 0xff);
                let hits = run.grouping().hits(first, &hits).or_miss(active).to_hits();
                if run.len() - first >= LANES {
                    stream.answer_packet(run.first + first, hits);
                } else {
                    some(stream, run.first + first, &hits[..run.len() - first]);
                }
            }
        }
        if self.is_far() { cost * Cost::FAR } else { cost }
    }
}

/// Hands hits to the last rays of a stream.
#[cold]
#[inline(never)]
fn some<S: Stream>(stream: &mut S, first: usize, hits: &[Hit]) {
    hits.iter().enumerate().for_each(|(i, hit)| stream.answer(first + i, hit));
}
