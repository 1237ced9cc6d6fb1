//! Rays in columns through the tree.

use bumpalo::{Bump, collections::Vec as BumpVec};

use super::columns::{Column, IntColumn, RayColumns};
use super::statistics::LaneUse;
use crate::bvh::{Stream, Tracer, Way};
use crate::compile::Scene;
use crate::geometry::{Hit, Rayx8};
use crate::simd::{LANES, Mask8};

/// Hits of a wavefront, by slot.
pub(super) struct HitColumns<'a> {
    pub(super) t: Column<'a>,
    pub(super) u: Column<'a>,
    pub(super) v: Column<'a>,
    pub(super) primitive: IntColumn<'a>,
}

impl<'a> HitColumns<'a> {
    pub(super) fn new(arena: &'a Bump) -> Self {
        let column = || BumpVec::new_in(arena);
        Self { t: column(), u: column(), v: column(), primitive: BumpVec::new_in(arena) }
    }

    fn resize(&mut self, len: usize) {
        [&mut self.t, &mut self.u, &mut self.v].into_iter().for_each(|column| column.resize(len, 0.0));
        self.primitive.resize(len, 0);
    }
}

/// The first `len` rays of the columns; `answer` takes what is found.
struct Columns<'c, 'a, F> {
    rays: &'c RayColumns<'a>,
    len: usize,
    answer: F,
}

impl<F: FnMut(usize, &Hit)> Stream for Columns<'_, '_, F> {
    fn len(&self) -> usize {
        self.len
    }

    #[inline]
    fn packet(&self, first: usize) -> (Rayx8, Mask8) {
        (self.rays.packet(first), Mask8::first(self.len - first))
    }

    #[inline]
    fn answer(&mut self, index: usize, hit: &Hit) {
        (self.answer)(index, hit);
    }
}

/// Finds the nearest hits of the first `len` rays.
pub(super) fn closest(
    scene: &Scene,
    rays: &RayColumns,
    len: usize,
    hits: &mut HitColumns,
    tracer: &mut Tracer,
) -> LaneUse {
    hits.resize(len.next_multiple_of(LANES));
    let answer = |slot: usize, hit: &Hit| {
        (hits.t[slot], hits.u[slot], hits.v[slot]) = (hit.t, hit.u, hit.v);
        hits.primitive[slot] = hit.primitive.0;
    };
    scene.trace::<false, _, _>(&mut Columns { rays, len, answer }, Way::Chosen, tracer);
    LaneUse::of_packets(len)
}

/// Calls `blocked` with the slot of each of the first `len` rays that meets anything.
pub(super) fn occluded(
    scene: &Scene,
    rays: &RayColumns,
    len: usize,
    tracer: &mut Tracer,
    mut blocked: impl FnMut(usize),
) -> LaneUse {
    let answer = |slot: usize, hit: &Hit| {
        if *hit == Hit::BLOCKED {
            blocked(slot);
        }
    };
    scene.trace::<true, _, _>(&mut Columns { rays, len, answer }, Way::Chosen, tracer);
    LaneUse::of_packets(len)
}
