//! Rays of a wavefront through the tree.

use super::connections::Connections;
use super::rows::{Hits, Paths};
use super::statistics::LaneUse;
use crate::bvh::{Stream, Tally, Tracer, Way};
use crate::compile::Scene;
use crate::geometry::{Hit, Rayx8};
use crate::simd::{LANES, Mask, Mask8};

/// How rays of a wavefront go through the tree. Every way finds the same, to the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// As a stream, by one way or by whichever suits them.
    Stream(Way),
    /// One after the other, by the scalar kernels.
    Single,
}

impl Default for Route {
    fn default() -> Self {
        Self::Stream(Way::Chosen)
    }
}

/// Paths, and where what they hit is written.
struct Nearest<'c, 'a> {
    paths: &'c Paths<'a>,
    hits: &'c mut Hits<'a>,
}

impl Stream for Nearest<'_, '_> {
    fn len(&self) -> usize {
        self.paths.len
    }

    #[inline]
    fn packet(&self, first: usize) -> (Rayx8, Mask8) {
        (self.paths.rays(first), Mask8::first(self.paths.len - first))
    }

    #[inline]
    fn answer(&mut self, index: usize, hit: &Hit) {
        self.hits.set(index, hit);
    }
}

/// Connections that are blocked bring nothing.
struct Blocked<'c, 'a>(&'c mut Connections<'a>);

impl Stream for Blocked<'_, '_> {
    fn len(&self) -> usize {
        self.0.len
    }

    #[inline]
    fn packet(&self, first: usize) -> (Rayx8, Mask8) {
        (self.0.rays(first), Mask8::first(self.0.len - first))
    }

    #[inline]
    fn answer(&mut self, index: usize, hit: &Hit) {
        if *hit == Hit::BLOCKED {
            self.0.block(index);
        }
    }

    #[inline]
    fn answer_blocked(&mut self, first: usize, _: usize, mut blocked: u64) {
        while blocked != 0 {
            self.0.block(first + blocked.trailing_zeros() as usize);
            blocked &= blocked - 1;
        }
    }
}

/// Finds the nearest hits of paths.
pub(super) fn closest<'a, T: Tally>(
    scene: &Scene,
    paths: &Paths<'a>,
    hits: &mut Hits<'a>,
    route: Route,
    tracer: &mut Tracer<T>,
) -> LaneUse {
    hits.resize(paths.len);
    trace::<false, _>(scene, &mut Nearest { paths, hits }, route, tracer);
    LaneUse::of_packets(paths.len)
}

/// Takes the light from connections that anything blocks.
pub(super) fn occluded<T: Tally>(
    scene: &Scene,
    connections: &mut Connections,
    route: Route,
    tracer: &mut Tracer<T>,
) -> LaneUse {
    let len = connections.len;
    trace::<true, _>(scene, &mut Blocked(connections), route, tracer);
    LaneUse::of_packets(len)
}

fn trace<const ANY: bool, T: Tally>(
    scene: &Scene,
    stream: &mut impl Stream,
    route: Route,
    tracer: &mut Tracer<T>,
) {
    let way = match route {
        Route::Stream(Way::Chosen) => scene.way(),
        Route::Stream(way) => way,
        Route::Single => return one_by_one::<ANY, _>(scene, stream, tracer),
    };
    scene.trace::<ANY, _, _>(stream, way, tracer);
}

fn one_by_one<const ANY: bool, T: Tally>(scene: &Scene, stream: &mut impl Stream, tracer: &mut Tracer<T>) {
    let traversal = &mut tracer.traversal;
    for first in (0..stream.len()).step_by(LANES) {
        let (rays, active) = stream.packet(first);
        let active = active.to_bitmask();
        for lane in (0..LANES).filter(|lane| active >> lane & 1 != 0) {
            let ray = rays.lane(lane);
            let hit = match ANY {
                false => scene.closest_hit(&ray, traversal),
                true if scene.occluded(&ray, traversal) => Hit::BLOCKED,
                true => Hit::MISS,
            };
            stream.answer(first + lane, &hit);
        }
    }
}
