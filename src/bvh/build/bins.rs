//! Binned SAH: the best of a few planes along each axis \[Wal07\].

use glam::Vec3A;
use rayon::prelude::*;

use super::{
    bounds::Bounds,
    reference::Reference,
    splits::{Cheapest, PLACES, ROW, Splits},
};
use crate::simd::{Bits, Mask, Real, f32x8, u32x8};

/// References that one thread puts into bins or partitions at a time, where several do.
pub(super) const CHUNK: usize = 16 * 1024;

/// Bins along each axis, a power of two.
const BINS: usize = ROW;

/// A plane between bins along an axis.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    axis: usize,
    grid: Grid,
    end: f32,
    /// References to its left.
    pub(super) left_count: usize,
    pub(super) left: Bounds,
    pub(super) right: Bounds,
}

impl Plane {
    /// Is a reference left of it, whose [`Bounds::centre`] this is?
    #[inline]
    pub(super) fn is_left(&self, centre: Vec3A) -> bool {
        let left = self.grid.place(centre).cmplt(Vec3A::splat(self.end));
        left.bitmask() >> self.axis & 1 != 0
    }
}

/// Equal bins along each axis over the bounds of the centres.
#[derive(Clone, Copy, Debug)]
struct Grid {
    origin: Vec3A,
    scale: Vec3A,
}

impl Grid {
    /// Places stay below 1, whatever the rounding.
    const REACH: f32 = 1.0 - 1.0 / (1 << 20) as f32;

    fn new(centres: Bounds) -> Self {
        let size = centres.max() - centres.min();
        let scale = Vec3A::splat(Self::REACH) / size;
        // A size of zero, or so small that its reciprocal overflows, separates nothing: all in one bin.
        let usable = size.cmpgt(Vec3A::ZERO) & scale.cmplt(Vec3A::INFINITY);
        Self { origin: centres.min(), scale: Vec3A::select(usable, scale, Vec3A::ZERO) }
    }

    /// The place along each axis as 1 + [0, 1): the bin is in the first bits of the mantissa.
    #[inline]
    fn place(&self, centre: Vec3A) -> Vec3A {
        (centre - self.origin) * self.scale + Vec3A::ONE
    }
}

/// A box, and in a lane that it spares how many references are in it.
#[derive(Clone, Copy)]
struct Bin(f32x8);

impl Bin {
    /// The bits of 1: a number that no box has more of in that lane, and with which arithmetic is quick.
    const NONE: u32 = 1f32.to_bits();
    const EMPTY: Self = {
        let mut lanes = [f32::NEG_INFINITY; 8];
        lanes[3] = f32::from_bits(Self::NONE);
        Self(f32x8::new(lanes))
    };

    /// Adds references to the number.
    #[inline]
    fn count(lanes: f32x8, references: u32) -> Self {
        let more = u32x8::new([0, 0, 0, references, 0, 0, 0, 0]);
        Self(f32x8::from_bits(lanes.to_bits().wrapping_add(more)))
    }

    /// With the box of one more. Of a reference, whose lanes to spare are -∞.
    #[inline]
    fn with(self, bounds: Bounds) -> Self {
        Self::count(self.0.max(bounds.0), 1)
    }

    #[inline]
    fn merge(self, other: Self) -> Self {
        Self::count(self.0.max(other.bounds().0), other.references())
    }

    #[inline]
    fn bounds(self) -> Bounds {
        Bounds::of_row(self.0.to_bits())
    }

    #[inline]
    fn references(self) -> u32 {
        self.0.to_bits().to_array()[3] - Self::NONE
    }
}

/// What is in each bin along each axis.
#[derive(Clone)]
struct Bins([[Bin; BINS]; 3]);

impl Bins {
    const EMPTY: Self = Self([[Bin::EMPTY; BINS]; 3]);

    /// `FAR`: they are among so many that not all are in a cache.
    fn fill<const FAR: bool>(grid: &Grid, references: &[Reference]) -> Self {
        let mut bins = Self::EMPTY;
        for reference in references {
            if FAR {
                reference.ask_for_later();
            }
            let bounds = reference.bounds();
            let places = grid.place(bounds.centre()).to_array();
            for (bins, place) in bins.0.iter_mut().zip(places) {
                let bin = &mut bins[(place.to_bits() >> (23 - BINS.ilog2())) as usize % BINS];
                *bin = bin.with(bounds);
            }
        }
        bins
    }

    fn merge(mut self, other: &Self) -> Self {
        for (own, others) in self.0.as_flattened_mut().iter_mut().zip(other.0.as_flattened()) {
            *own = own.merge(*others);
        }
        self
    }

    /// The cheapest plane that has something on either side.
    fn cheapest(&self, grid: &Grid, count: usize) -> Option<Plane> {
        let mut splits = Splits::EMPTY;
        let mut left_counts = [0; PLACES];
        for (axis, bins) in self.0.iter().enumerate() {
            splits.fill(axis, BINS, |bin| bins[bin].bounds());
            let mut left_count = 0;
            for (bin, place) in bins.iter().zip(&mut left_counts[axis * (BINS - 1)..][..BINS - 1]) {
                left_count += bin.references();
                *place = left_count;
            }
        }
        let count = u32x8::splat(count as u32);
        let sides = |eight: usize| {
            let left = u32x8::new(left_counts.as_chunks().0[eight]);
            let right = count.wrapping_add(!left).wrapping_add(u32x8::splat(1));
            let none = left.equal(u32x8::splat(0)) | left.equal(count);
            ([left, right].map(f32x8::from_int), (!none).to_bitmask())
        };
        let Cheapest { row: axis, at: bin, .. } = splits.cheapest(BINS, sides).0?;
        let (left, right) = self.0[axis].split_at(bin);
        Some(Plane {
            axis,
            grid: *grid,
            end: 1.0 + bin as f32 / BINS as f32,
            left_count: left.iter().map(|bin| bin.references()).sum::<u32>() as usize,
            left: splits.left(axis, bin, BINS),
            right: right.iter().fold(Bounds::EMPTY, |all, bin| all.union(bin.bounds())),
        })
    }
}

/// The plane of least cost, if any separates the references, whose centres lie in `centres`.
pub(super) fn cheapest_plane(references: &[Reference], centres: Bounds) -> Option<Plane> {
    let grid = Grid::new(centres);
    if references.len() <= CHUNK {
        return Bins::fill::<false>(&grid, references).cheapest(&grid, references.len());
    }
    // Unions in the order of the chunks: signs of zero do not depend on threads either.
    let chunks = references.par_chunks(CHUNK).map(|chunk| Bins::fill::<true>(&grid, chunk));
    let bins = chunks.reduce(|| Bins::EMPTY, |a, b| a.merge(&b));
    bins.cheapest(&grid, references.len())
}

#[cfg(test)]
mod tests {
    use super::super::binned::extents;
    use super::*;
    use crate::geometry::{Aabb, seeds::Random};

    /// Boxes of all sizes here and there.
    fn boxes(count: usize, seed: u64) -> Vec<Reference> {
        let mut random = Random::new(seed);
        (0..count as u32)
            .map(|index| {
                let (corner, size) = (random.vector(), [0.0, 0.05, 0.6][index as usize % 3]);
                let bounds = Aabb::of_points([corner, corner + random.vector() * size]);
                Reference::new(bounds, index, 0)
            })
            .collect()
    }

    /// Areas times numbers of what lies on either side, from the references themselves; `None` if all lie on one.
    fn cost(references: &[Reference], plane: &Plane) -> Option<f32> {
        let (left, right): (Vec<&Reference>, Vec<&Reference>) =
            references.iter().partition(|reference| plane.is_left(reference.bounds().centre()));
        let side = |references: &[&Reference]| {
            let bounds = references.iter().fold(Bounds::EMPTY, |a, reference| a.union(reference.bounds()));
            bounds.half_area() * references.len() as f32
        };
        (!left.is_empty() && !right.is_empty()).then(|| side(&left) + side(&right))
    }

    #[test]
    fn no_other_plane_between_bins_is_cheaper() {
        for seed in 0..200 {
            let references = boxes([2, 3, 17, 100, 700][seed as usize % 5], seed);
            let [_, centres] = extents(&references);
            let found = cheapest_plane(&references, centres).expect("a plane");
            let found_cost = cost(&references, &found).expect("something on either side");
            let left =
                references.iter().filter(|reference| found.is_left(reference.bounds().centre())).count();
            assert_eq!(left, found.left_count);
            for (axis, bin) in (0..3).flat_map(|axis| (1..BINS).map(move |bin| (axis, bin))) {
                let end = 1.0 + bin as f32 / BINS as f32;
                let other = Plane { axis, end, ..found };
                if let Some(cost) = cost(&references, &other) {
                    assert!(found_cost <= cost * 1.0001, "{found_cost}, at bin {bin} of axis {axis} {cost}");
                }
            }
        }
    }
}
