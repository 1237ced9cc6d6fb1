//! Rays of a wavefront through the tree.

use super::connections::Connections;
use super::rows::{Hits, Paths};
use super::statistics::LaneUse;
use crate::bvh::{Stream, Tally, Tracer, Way};
use crate::compile::Scene;
use crate::geometry::{Hit, Rayx8};
use crate::simd::Mask8;

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
}

/// Finds the nearest hits of paths.
pub(super) fn closest<'a, T: Tally>(
    scene: &Scene,
    paths: &Paths<'a>,
    hits: &mut Hits<'a>,
    tracer: &mut Tracer<T>,
) -> LaneUse {
    hits.resize(paths.len);
    scene.trace::<false, _, _>(&mut Nearest { paths, hits }, Way::Chosen, tracer);
    LaneUse::of_packets(paths.len)
}

/// Takes the light from connections that anything blocks.
pub(super) fn occluded<T: Tally>(
    scene: &Scene,
    connections: &mut Connections,
    tracer: &mut Tracer<T>,
) -> LaneUse {
    let len = connections.len;
    scene.trace::<true, _, _>(&mut Blocked(connections), Way::Chosen, tracer);
    LaneUse::of_packets(len)
}
