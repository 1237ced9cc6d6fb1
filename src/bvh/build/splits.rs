//! What it costs to split rows of boxes, for all places where that can be done at once.

use super::bounds::Bounds;
use crate::simd::{Mask, Real, f32x8};

/// Boxes in a row, at most.
pub(super) const ROW: usize = 16;
/// Places of three rows, in whole registers.
pub(super) const PLACES: usize = 3 * ROW;

/// Three rows of as many boxes, each split at each place between two: one row after the other, places in their order.
pub(super) struct Splits {
    left: [Bounds; PLACES],
    right: [Bounds; PLACES],
}

/// The cheapest of all splits.
#[derive(Clone, Copy)]
pub(super) struct Cheapest {
    pub(super) cost: f32,
    pub(super) row: usize,
    /// Boxes to the left.
    pub(super) at: usize,
}

impl Splits {
    pub(super) const EMPTY: Self = Self { left: [Bounds::EMPTY; PLACES], right: [Bounds::EMPTY; PLACES] };

    /// Puts in a row of `count` boxes.
    #[inline]
    pub(super) fn fill(&mut self, row: usize, count: usize, of: impl Fn(usize) -> Bounds) {
        let first = row * (count - 1);
        let (mut left, mut right) = (Bounds::EMPTY, Bounds::EMPTY);
        let lefts = &mut self.left[first..][..count - 1];
        let rights = &mut self.right[first..][..count - 1];
        for i in 1..count {
            left = left.union(of(i - 1));
            lefts[i - 1] = left;
            right = right.union(of(count - i));
            rights[count - 1 - i] = right;
        }
    }

    /// What is left of a split.
    #[inline]
    pub(super) fn left(&self, row: usize, at: usize, count: usize) -> Bounds {
        self.left[row * (count - 1) + at - 1]
    }

    /// Costs of eight splits: half areas times numbers of what lies on either side.
    #[inline]
    fn costs(&self, eight: usize, [left_counts, right_counts]: [f32x8; 2]) -> f32x8 {
        let of = |sides: &[Bounds; PLACES]| Bounds::half_areas(&sides.as_chunks().0[eight]);
        of(&self.left) * left_counts + of(&self.right) * right_counts
    }

    /// The first of the cheapest splits of rows of `count` boxes, and what each costs. Eight places at a time, `sides`
    /// says how many references lie left and right, and for which places (bits) the split is one.
    #[inline]
    pub(super) fn cheapest(
        &self,
        count: usize,
        sides: impl Fn(usize) -> ([f32x8; 2], u32),
    ) -> (Option<Cheapest>, [f32x8; PLACES / 8]) {
        let splits = count - 1;
        let mut costs = [f32x8::splat(f32::INFINITY); PLACES / 8];
        let mut least = costs[0];
        let mut separating = 0u64;
        for (eight, place) in costs.iter_mut().enumerate().take((3 * splits).div_ceil(8)) {
            let (counts, separates) = sides(eight);
            *place = f32x8::select(Mask::from_bitmask(separates), self.costs(eight, counts), *place);
            least = place.min(least);
            separating |= u64::from(separates) << (8 * eight);
        }
        let least = f32x8::splat(least.reduce_min());
        let mut found = 0u64;
        for (eight, place) in costs.iter().enumerate() {
            found |= u64::from(place.equal(least).to_bitmask()) << (8 * eight);
        }
        let place = (found & separating).trailing_zeros() as usize;
        let row = usize::from(place >= splits) + usize::from(place >= 2 * splits);
        let cheapest = Cheapest { cost: least.lane(0), row, at: place - row * splits + 1 };
        ((found & separating != 0).then_some(cheapest), costs)
    }
}
