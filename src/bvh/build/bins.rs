//! Binned SAH: the best of a few planes along each axis \[Wal07\].

use glam::Vec3A;
use rayon::prelude::*;

use super::reference::{Bounds, Reference};

/// References that one thread puts into bins or partitions at a time, where several do.
pub(super) const CHUNK: usize = 16 * 1024;

/// Bins along each axis, a power of two.
const BINS: usize = 16;

/// A plane between bins along an axis.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    pub(super) axis: usize,
    origin: f32,
    scale: f32,
    end: f32,
    /// References to its left.
    pub(super) left_count: usize,
    pub(super) left: Bounds,
    pub(super) right: Bounds,
}

impl Plane {
    #[inline]
    pub(super) fn is_left(&self, reference: &Reference) -> bool {
        // As in `Grid::place`, operation by operation.
        (reference.centre(self.axis) - self.origin) * self.scale + 1.0 < self.end
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

/// What is in each bin along each axis.
#[derive(Clone)]
struct Bins {
    bounds: [[Bounds; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Bins {
    const EMPTY: Self = Self { bounds: [[Bounds::EMPTY; BINS]; 3], counts: [[0; BINS]; 3] };

    fn fill(grid: &Grid, references: &[Reference]) -> Self {
        let mut bins = Self::EMPTY;
        for reference in references {
            let bounds = reference.bounds();
            let places = grid.place(bounds.centre()).to_array();
            for (axis, place) in places.into_iter().enumerate() {
                let bin = (place.to_bits() >> (23 - BINS.ilog2())) as usize % BINS;
                bins.bounds[axis][bin] = bins.bounds[axis][bin].union(bounds);
                bins.counts[axis][bin] += 1;
            }
        }
        bins
    }

    fn merge(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.bounds[axis][bin] = self.bounds[axis][bin].union(other.bounds[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }

    /// The cheapest plane that has something on either side.
    fn cheapest(&self, grid: &Grid, count: usize) -> Option<Plane> {
        let mut best: Option<(f32, usize, usize)> = None;
        for axis in 0..3 {
            if grid.scale[axis] == 0.0 {
                continue;
            }
            let (bounds, counts) = (&self.bounds[axis], &self.counts[axis]);
            let mut right_costs = [0.0; BINS];
            let (mut right, mut right_count) = (Bounds::EMPTY, 0);
            for bin in (1..BINS).rev() {
                right = right.union(bounds[bin]);
                right_count += counts[bin];
                right_costs[bin] = right.half_area() * right_count as f32;
            }
            let (mut left, mut left_count) = (Bounds::EMPTY, 0);
            for bin in 1..BINS {
                left = left.union(bounds[bin - 1]);
                left_count += counts[bin - 1];
                let cost = left.half_area() * left_count as f32 + right_costs[bin];
                let separates = left_count != 0 && left_count as usize != count;
                if separates && best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, bin));
                }
            }
        }
        best.map(|(_, axis, bin)| {
            let union = |bins: &[Bounds]| bins.iter().fold(Bounds::EMPTY, |a, &b| a.union(b));
            let (left, right) = self.bounds[axis].split_at(bin);
            Plane {
                axis,
                origin: grid.origin[axis],
                scale: grid.scale[axis],
                end: 1.0 + bin as f32 / BINS as f32,
                left_count: self.counts[axis][..bin].iter().sum::<u32>() as usize,
                left: union(left),
                right: union(right),
            }
        })
    }
}

/// The plane of least cost, if any separates the references, whose centres lie in `centres`.
pub(super) fn cheapest_plane(references: &[Reference], centres: Bounds) -> Option<Plane> {
    let grid = Grid::new(centres);
    if references.len() <= CHUNK {
        return Bins::fill(&grid, references).cheapest(&grid, references.len());
    }
    // Unions in the order of the chunks: signs of zero do not depend on threads either.
    let chunks = references.par_chunks(CHUNK).map(|chunk| Bins::fill(&grid, chunk));
    let bins = chunks.reduce(|| Bins::EMPTY, |a, b| a.merge(&b));
    bins.cheapest(&grid, references.len())
}

#[cfg(test)]
mod tests {
    use super::super::binned::extents;
    use super::*;
    use crate::geometry::Aabb;

    /// Boxes of all sizes here and there.
    fn boxes(count: usize, seed: u32) -> Vec<Reference> {
        let mut state = seed;
        let mut unit = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        let mut vector = || glam::Vec3::new(unit(), unit(), unit());
        (0..count as u32)
            .map(|index| {
                let (corner, size) = (vector(), [0.0, 0.05, 0.6][index as usize % 3]);
                let bounds = Aabb::of_points([corner, corner + vector() * size]);
                Reference { bounds, index, class: 0 }
            })
            .collect()
    }

    /// Areas times numbers of what lies on either side, from the references themselves; `None` if all lie on one.
    fn cost(references: &[Reference], plane: &Plane) -> Option<f32> {
        let (left, right): (Vec<&Reference>, Vec<&Reference>) =
            references.iter().partition(|reference| plane.is_left(reference));
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
            let (grid, found) = (Grid::new(centres), cheapest_plane(&references, centres).expect("a plane"));
            let found_cost = cost(&references, &found).expect("something on either side");
            let left = references.iter().filter(|reference| found.is_left(reference)).count();
            assert_eq!(left, found.left_count);
            for (axis, bin) in (0..3).flat_map(|axis| (1..BINS).map(move |bin| (axis, bin))) {
                let end = 1.0 + bin as f32 / BINS as f32;
                let other = Plane { axis, origin: grid.origin[axis], scale: grid.scale[axis], end, ..found };
                if let Some(cost) = cost(&references, &other) {
                    assert!(found_cost <= cost * 1.0001, "{found_cost}, at bin {bin} of axis {axis} {cost}");
                }
            }
        }
    }
}
