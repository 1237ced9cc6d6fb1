//! What blocked a ray lately often blocks its neighbours.
//!
//! Before any of a run's occlusion rays enters the tree, all of them are tested, eight at a time, against the
//! leaf that blocked the last one. A ray that some surface blocks is blocked, whichever surface is found
//! first: the answers stay the same.

use super::{Child, Hitx16, Kind, Leaves, Tally, bundle::BUNDLE, run::Run};
use crate::simd::{Mask, Real, f32x16};

/// A leaf that spares fewer of the rays is not worth its tests.
const WORTH: f32 = 0.1;
/// One run in so many tries nevertheless.
const PROBE: u32 = 32;

/// The leaf that blocked last, and how often that has helped.
#[derive(Debug)]
pub(super) struct Occluder {
    leaf: Child,
    luck: f32,
    turn: u32,
}

impl Default for Occluder {
    fn default() -> Self {
        Self { leaf: Child::ABSENT, luck: WORTH, turn: 0 }
    }
}

impl Occluder {
    /// Nothing has been blocked: leaves belong to one tree, and streams may follow through another.
    pub(super) fn forget(&mut self) {
        self.leaf = Child::ABSENT;
    }

    #[inline]
    pub(super) fn remember(&mut self, leaf: Child) {
        self.leaf = leaf;
    }

    /// Takes those rays out of a run that the leaf blocks.
    pub(super) fn block<L: Leaves, T: Tally>(&mut self, run: &mut Run, leaves: &L, tally: &mut T) {
        self.turn = (self.turn + 1) % PROBE;
        let Kind::Leaf { first, count } = self.leaf.kind() else { return };
        if self.luck < WORTH && self.turn != 0 {
            return;
        }
        let (mut tried, mut blocked) = (0, 0);
        for i in 0..run.bundles() {
            let (ray, active) = run.bundle(i);
            tried += active.count();
            tally.leaf(count, active.count());
            let mut hit = Hitx16::nothing(ray.t_far);
            leaves.intersect_bundle::<true>(first, count, ray, active, &mut hit);
            let by_leaf = hit.t.equal(f32x16::splat(f32::NEG_INFINITY)) & active;
            blocked += by_leaf.count();
            run.blocked |= u64::from(by_leaf.to_bitmask()) << (i * BUNDLE);
        }
        run.active &= !run.blocked;
        self.luck = 0.75 * self.luck + 0.25 * (blocked as f32 / tried.max(1) as f32);
    }
}
