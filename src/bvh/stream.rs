//! Any rays, in order, each by the way that suits its neighbours.
//!
//! Nothing is known about where the rays come from. Runs of sixty-four are judged by what is in them (see
//! [`Runs`]): those that point into one octant and spread little may go as a tile, occlusion rays as packets,
//! as long as that turns out to cost less than the wave, which takes all the others. The answer does not
//! depend on the way.

use super::{
    Bvh, Child, Hitx8, Leaves, Tally, Traversal, Wave,
    cost::Cost,
    run::{PACKETS, Run, Runs},
};
use crate::geometry::{Hit, Rayx8};
use crate::simd::{LANES, Mask, Mask8, Real, f32x8};

/// Rays to be traced, and where their answers go.
pub trait Stream {
    /// How many rays there are.
    fn len(&self) -> usize;
    /// The rays from a multiple of eight on, and which of them are rays.
    fn packet(&self, first: usize) -> (Rayx8, Mask8);
    /// Takes an answer: [`Hit::MISS`], a hit, or for an occlusion query [`Hit::BLOCKED`].
    fn answer(&mut self, index: usize, hit: &Hit);
    /// Takes the answers of up to eight neighbours.
    #[inline]
    fn answer_packet(&mut self, first: usize, hits: &[Hit]) {
        hits.iter().enumerate().for_each(|(i, hit)| self.answer(first + i, hit));
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

/// How to go through the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Whatever suits the rays.
    Chosen,
    /// Tiles of sixty-four, as packets where they point into several octants.
    Tile,
    /// Packets of eight.
    Packet,
    /// Sixteen single rays in turn.
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
        while let Some(way) = runs.peek::<ANY, L, S, T>(self, leaves, stream, &mut traversal.tally) {
            match way {
                // Runs that follow each other are one wave, which is filled and drained once.
                Way::Wave => {
                    self.intersect_wave::<ANY, L, S, T>(leaves, stream, runs, wave, &mut traversal.tally);
                }
                Way::Packet => {
                    let cost = self.packets::<ANY, L, S, T>(leaves, stream, runs.take(), traversal);
                    runs.occluder.remember(traversal.blocker);
                    runs.learn_together::<ANY>(cost);
                }
                Way::Chosen | Way::Tile => {
                    let run = runs.take();
                    let cost = match self.tile::<ANY, L, S, T>(leaves, stream, run, traversal) {
                        Some(cost) => cost,
                        None => self.packets::<ANY, L, S, T>(leaves, stream, run, traversal),
                    };
                    runs.learn_together::<ANY>(cost);
                }
            }
        }
    }

    /// Traces a run as a tile if it is whole and points into one octant.
    fn tile<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &self,
        leaves: &L,
        stream: &mut S,
        run: &Run,
        traversal: &mut Traversal<T>,
    ) -> Option<Cost> {
        if !run.active.iter().all(|active| active.all()) {
            return None;
        }
        let mut hits = [Hitx8::nothing(f32x8::zero()); PACKETS];
        hits.iter_mut().zip(&run.rays).for_each(|(hit, ray)| hit.t = ray.t_far);
        let cost = self.intersect_tile::<ANY, L, T>(leaves, &run.rays, &mut hits, traversal)?;
        for (i, hit) in hits.iter().enumerate() {
            answer::<ANY, S>(stream, run.first + i * LANES, Mask8::splat(true), hit);
        }
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
        for (i, (ray, &active)) in run.rays.iter().zip(&run.active).enumerate().take(run.packets()) {
            let mut hit = Hitx8::nothing(ray.t_far);
            if let Some(start) = start {
                cost += self.intersect_packet_from::<ANY, L, T>(
                    start,
                    leaves,
                    (ray, active),
                    &mut hit,
                    traversal,
                );
            }
            if ANY {
                hit.t = f32x8::select(run.blocked[i], f32x8::splat(f32::NEG_INFINITY), hit.t);
            }
            answer::<ANY, S>(stream, run.first + i * LANES, active | run.blocked[i], &hit);
        }
        if self.is_far() { cost * Cost::FAR } else { cost }
    }
}

/// Hands a packet's hits to its rays.
#[inline]
fn answer<const ANY: bool, S: Stream>(stream: &mut S, first: usize, active: Mask8, hit: &Hitx8) {
    let lanes = (stream.len() - first).min(LANES);
    let hits: [Hit; LANES] = if ANY {
        let blocked = (hit.t.equal(f32x8::splat(f32::NEG_INFINITY)) & active).to_bitmask();
        std::array::from_fn(|lane| if blocked >> lane & 1 != 0 { Hit::BLOCKED } else { Hit::MISS })
    } else {
        hit.or_miss(active).to_hits()
    };
    stream.answer_packet(first, &hits[..lanes]);
}
