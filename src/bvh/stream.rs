//! Any rays, in order, each by the way that suits its neighbours.
//!
//! Every sixty-four rays are looked at before they are traced. Where they point into one octant and spread
//! little, they go as a tile; occlusion rays that spread more go as packets; the rest go as a wave. Nothing is known about where the rays come
//! from, and the answer does not depend on the way.

use std::ops::Range;

use super::{Bvh, Hitx8, Leaves, Tally, Traversal, Wave, tile::PACKETS};
use crate::geometry::{Hit, PrimitiveId, Ray, Rayx8};
use crate::simd::{LANES, Mask, Mask8, Real, Vec3x8, f32x8, u32x8};

/// Rays that are judged together.
const RUN: usize = PACKETS * LANES;
/// Runs up to this [`spread`] go as tiles.
const TILE_SPREAD: f32 = 0.35;
/// Occlusion rays up to this one go as packets: most are blocked after a few nodes, which a wave can't
/// make up for its setting up.
const PACKET_SPREAD: f32 = 1.2;

/// Rays to be traced, and where their answers go.
pub trait Stream {
    /// How many rays there are.
    fn len(&self) -> usize;
    /// The ray at a place; `None` for one that can't hit anything.
    fn ray(&self, index: usize) -> Option<Ray>;
    /// The rays from a multiple of eight on, and which of them are rays.
    fn packet(&self, first: usize) -> (Rayx8, Mask8);
    /// Takes an answer: [`Hit::MISS`], a hit, or for an occlusion query [`Hit::BLOCKED`].
    fn answer(&mut self, index: usize, hit: &Hit);

    /// Is there nothing to trace?
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// What tracing needs beside the tree, kept from stream to stream.
pub struct Tracer<T = ()> {
    /// For packets and single rays.
    pub traversal: Traversal<T>,
    wave: Wave,
}

impl<T> Tracer<T> {
    /// Nothing traced yet.
    pub fn new(tally: T) -> Self {
        Self { traversal: Traversal::new(tally), wave: Wave::default() }
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
        let len = stream.len();
        let way_of = |stream: &S, start: usize| match way {
            Way::Chosen => match spread(stream, start..(start + RUN).min(len)) {
                Some(spread) if spread <= TILE_SPREAD => Way::Tile,
                Some(spread) if ANY && spread <= PACKET_SPREAD => Way::Packet,
                _ => Way::Wave,
            },
            forced => forced,
        };
        // Runs that go the same way are traced as one, so that a wave is filled and drained once.
        let mut start = 0;
        while start < len {
            let way = way_of(stream, start);
            let mut end = (start + RUN).min(len);
            while end < len && way == way_of(stream, end) {
                end = (end + RUN).min(len);
            }
            match way {
                Way::Wave => {
                    let Tracer { traversal, wave } = tracer;
                    self.intersect_wave::<ANY, L, S, T>(
                        leaves,
                        stream,
                        start..end,
                        wave,
                        &mut traversal.tally,
                    );
                }
                Way::Packet => {
                    self.packets::<ANY, L, S, T>(leaves, stream, start..end, &mut tracer.traversal);
                }
                Way::Chosen | Way::Tile => {
                    for start in (start..end).step_by(RUN) {
                        let run = start..(start + RUN).min(end);
                        if !self.tile::<ANY, L, S, T>(leaves, stream, &run, &mut tracer.traversal) {
                            self.packets::<ANY, L, S, T>(leaves, stream, run, &mut tracer.traversal);
                        }
                    }
                }
            }
            start = end;
        }
    }

    /// Traces a run as a tile if it is whole and points into one octant.
    fn tile<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &self,
        leaves: &L,
        stream: &mut S,
        run: &Range<usize>,
        traversal: &mut Traversal<T>,
    ) -> bool {
        if run.len() != RUN {
            return false;
        }
        let loaded: [(Rayx8, Mask8); PACKETS] = std::array::from_fn(|i| stream.packet(run.start + i * LANES));
        let packets = loaded.map(|(ray, _)| ray);
        let mut hits = packets.each_ref().map(nothing_yet);
        let whole = loaded.iter().all(|(_, active)| active.all());
        if !whole || !self.intersect_tile::<ANY, L, T>(leaves, &packets, &mut hits, traversal) {
            return false;
        }
        for (i, hit) in hits.iter().enumerate() {
            answer::<ANY, S>(stream, run.start + i * LANES, Mask8::splat(true), hit);
        }
        true
    }

    fn packets<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &self,
        leaves: &L,
        stream: &mut S,
        range: Range<usize>,
        traversal: &mut Traversal<T>,
    ) {
        for first in range.step_by(LANES) {
            let (ray, active) = stream.packet(first);
            let mut hit = nothing_yet(&ray);
            self.intersect_packet::<ANY, L, T>(leaves, &ray, active, &mut hit, traversal);
            answer::<ANY, S>(stream, first, active, &hit);
        }
    }
}

/// Hits before anything is hit.
#[inline]
fn nothing_yet(ray: &Rayx8) -> Hitx8 {
    let none = u32x8::new([PrimitiveId::NONE.0; 8]);
    Hitx8 { t: ray.t_far, u: f32x8::zero(), v: f32x8::zero(), primitive: none }
}

/// Hands a packet's hits to its rays.
#[inline]
fn answer<const ANY: bool, S: Stream>(stream: &mut S, first: usize, active: Mask8, hit: &Hitx8) {
    let (t, u, v) = (hit.t.to_array(), hit.u.to_array(), hit.v.to_array());
    let primitive = hit.primitive.to_array();
    let active = active.to_bitmask();
    for lane in 0..(stream.len() - first).min(LANES) {
        let hit = Hit { t: t[lane], u: u[lane], v: v[lane], primitive: PrimitiveId(primitive[lane]) };
        stream.answer(first + lane, &if active >> lane & 1 != 0 { hit.settle::<ANY>() } else { Hit::MISS });
    }
}

/// The diagonal of the box around the directions of a run, in lengths of its middle; `None` if they point
/// into several octants.
fn spread<S: Stream>(stream: &S, range: Range<usize>) -> Option<f32> {
    let (lowest, highest) = (f32x8::splat(f32::INFINITY), f32x8::splat(f32::NEG_INFINITY));
    let mut low = Vec3x8 { x: lowest, y: lowest, z: lowest };
    let mut high = Vec3x8 { x: highest, y: highest, z: highest };
    for first in range.step_by(LANES) {
        let (ray, active) = stream.packet(first);
        low = Vec3x8::select(active, ray.dir.min(low), low);
        high = Vec3x8::select(active, ray.dir.max(high), high);
    }
    let axes = [(low.x, high.x), (low.y, high.y), (low.z, high.z)];
    let (mut diagonal, mut length) = (0.0, 0.0);
    for (low, high) in axes {
        let (low, high) = (low.reduce_min(), high.reduce_max());
        if low < 0.0 && high > 0.0 {
            return None;
        }
        diagonal += (high - low) * (high - low);
        length += (high + low) * (high + low) * 0.25;
    }
    Some((diagonal / length).sqrt())
}

impl Hit {
    /// What a traversal leaves behind, as an answer.
    #[inline]
    pub(super) fn settle<const ANY: bool>(self) -> Self {
        if ANY {
            if self.t == f32::NEG_INFINITY { Self::BLOCKED } else { Self::MISS }
        } else if self.primitive == PrimitiveId::NONE {
            Self::MISS
        } else {
            self
        }
    }
}
