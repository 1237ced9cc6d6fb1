//! Small subtrees: every plane between two centres, exactly.
//!
//! Sixteen references fit into the first cache. They are sorted along each axis once; each split keeps
//! the three orders sorted \[Wal07\], so that a subtree costs one pass a level and no bins.

use super::{
    MAX_LEAF,
    binary::{Binary, Packed},
    reference::{Bounds, Reference},
};
use crate::simd::{Mask, Real, f32x8};

/// References of the largest subtree that is built here.
pub(super) const SMALL: usize = 16;

/// A few references, sorted along each axis.
struct Sweep {
    bounds: [Bounds; SMALL],
    classes: [u8; SMALL],
    orders: [[u8; SMALL]; 3],
}

/// Builds the subtree over at most [`SMALL`] references and puts them into leaf order. Returns how many
/// places it took.
pub(super) fn subtree(
    references: &mut [Reference],
    bounds: Bounds,
    first: u32,
    nodes: &mut [Packed],
) -> usize {
    let count = references.len();
    let mut all = [references[0]; SMALL];
    all[..count].copy_from_slice(references);
    let mut sweep = Sweep::new(&all, count);
    let taken = sweep.split(0, count, bounds, first, nodes);
    for (place, &i) in references.iter_mut().zip(&sweep.orders[0]) {
        *place = all[usize::from(i) % SMALL];
    }
    taken
}

impl Sweep {
    fn new(all: &[Reference; SMALL], count: usize) -> Self {
        let bounds = all.each_ref().map(Reference::bounds);
        let mut orders = [[0; SMALL]; 3];
        for (axis, order) in orders.iter_mut().enumerate() {
            // Places beyond the count hold what sorts last.
            let key = |i: usize| if i < count { all[i].centre(axis) } else { f32::INFINITY };
            let keys: [f32; SMALL] = std::array::from_fn(key);
            let eight = |part: usize| f32x8::from_fn(|i| keys[8 * part + i]);
            let lanes: [f32x8; SMALL / 8] = std::array::from_fn(eight);
            for (i, &key) in keys[..count].iter().enumerate() {
                // The rank: how many are less, or equal and before.
                let key = f32x8::splat(key);
                let (mut less, mut equal) = (0, 0);
                for (part, lanes) in lanes.iter().enumerate() {
                    less |= lanes.lt(key).to_bitmask() << (8 * part);
                    equal |= lanes.equal(key).to_bitmask() << (8 * part);
                }
                let rank = (less | equal & ((1 << i) - 1)).count_ones() as usize;
                order[rank % SMALL] = i as u8;
            }
        }
        Self { bounds, classes: all.each_ref().map(|reference| reference.class), orders }
    }

    fn bounds(&self, i: u8) -> Bounds {
        self.bounds[usize::from(i) % SMALL]
    }

    /// Splits what stands from `low` to `high` in each order.
    fn split(&mut self, low: usize, high: usize, bounds: Bounds, first: u32, nodes: &mut [Packed]) -> usize {
        let count = high - low;
        let best = if count > 1 { self.cheapest(low, high) } else { None };
        let mut chosen = best.map(|(_, axis, left_count)| (axis, left_count));
        if count <= MAX_LEAF {
            let area = bounds.half_area();
            let split_cost = best.map_or(f32::INFINITY, |(cost, ..)| cost);
            if self.sort_classes(low, high) {
                chosen = Some((0, self.first_class_count(low, high)));
            } else if count as f32 * area <= split_cost + area {
                // A leaf costs a test for each primitive; a split costs a node.
                nodes[0] = Binary::leaf(bounds, first, count).pack();
                return 1;
            }
        }
        let (axis, left_count) = chosen.unwrap_or((0, count / 2));
        let middle = low + left_count;
        self.keep_orders(low, middle, high, axis);
        let union = |run: &[u8]| run.iter().fold(Bounds::EMPTY, |a, &i| a.union(self.bounds(i)));
        let (left, right) = (union(&self.orders[axis][low..middle]), union(&self.orders[axis][middle..high]));
        let right_at = 1 + self.split(low, middle, left, first, &mut nodes[1..]);
        nodes[0] = Binary::inner(bounds, first, right_at).pack();
        right_at + self.split(middle, high, right, first + left_count as u32, &mut nodes[right_at..])
    }

    /// Cost, axis and how many go left.
    fn cheapest(&self, low: usize, high: usize) -> Option<(f32, usize, usize)> {
        let count = high - low;
        let mut best: Option<(f32, usize, usize)> = None;
        let mut middle = f32::INFINITY;
        for axis in 0..3 {
            let order = &self.orders[axis][low..high];
            let mut right_costs = [0.0; SMALL];
            let mut right = Bounds::EMPTY;
            for i in (1..count).rev() {
                right = right.union(self.bounds(order[i]));
                right_costs[i % SMALL] = right.half_area() * (count - i) as f32;
            }
            let mut left = Bounds::EMPTY;
            for i in 1..count {
                left = left.union(self.bounds(order[i - 1]));
                let cost = left.half_area() * i as f32 + right_costs[i % SMALL];
                if axis == 0 && i == count / 2 {
                    middle = cost;
                }
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, i));
                }
            }
        }
        // Among equals the middle, so that equal boxes make a shallow tree.
        best.map(|best| if middle <= best.0 { (middle, 0, count / 2) } else { best })
    }

    /// Lets the other orders follow a split of one at `middle`.
    fn keep_orders(&mut self, low: usize, middle: usize, high: usize, axis: usize) {
        let mut is_left = 0u32;
        for &i in &self.orders[axis][low..middle] {
            is_left |= 1 << i;
        }
        for other in (0..3).filter(|&other| other != axis) {
            let order = &mut self.orders[other];
            let (mut left, mut right) = (low, 0);
            let mut rights = [0; SMALL];
            for at in low..high {
                let i = order[at];
                let goes_left = (is_left >> i & 1) as usize;
                order[left] = i;
                rights[right] = i;
                left += goes_left;
                right += 1 - goes_left;
            }
            order[middle..high].copy_from_slice(&rights[..right]);
        }
    }

    fn class(&self, i: u8) -> u8 {
        self.classes[usize::from(i) % SMALL]
    }

    /// Are there several classes? If so the first order gets sorted by them.
    fn sort_classes(&mut self, low: usize, high: usize) -> bool {
        let class = self.class(self.orders[0][low]);
        let mixed = self.orders[0][low..high].iter().any(|&i| self.class(i) != class);
        if mixed {
            let classes = self.classes;
            self.orders[0][low..high].sort_by_key(|&i| classes[usize::from(i)]);
        }
        mixed
    }

    fn first_class_count(&self, low: usize, high: usize) -> usize {
        let run = &self.orders[0][low..high];
        run.iter().take_while(|&&i| self.class(i) == self.class(run[0])).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;

    /// Areas times numbers, where so many go left in the order of the centres along an axis.
    fn cost(references: &[Reference], axis: usize, left_count: usize) -> f32 {
        let mut ordered: Vec<&Reference> = references.iter().collect();
        ordered.sort_by(|a, b| a.centre(axis).total_cmp(&b.centre(axis)));
        let side = |references: &[&Reference]| {
            let bounds = references.iter().fold(Bounds::EMPTY, |a, reference| a.union(reference.bounds()));
            bounds.half_area() * references.len() as f32
        };
        let (left, right) = ordered.split_at(left_count);
        side(left) + side(right)
    }

    #[test]
    fn no_other_split_between_centres_is_cheaper() {
        let mut state = 7u32;
        let mut unit = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        let mut vector = || glam::Vec3::new(unit(), unit(), unit());
        for round in 0..2000 {
            let count = 2 + round % (SMALL - 1);
            let references: Vec<Reference> = (0..count as u32)
                .map(|index| {
                    let corner = vector();
                    let bounds = Aabb::of_points([corner, corner + vector() * [0.02, 0.9][round % 2]]);
                    Reference { bounds, index, class: 0 }
                })
                .collect();
            let mut all = [references[0]; SMALL];
            all[..count].copy_from_slice(&references);
            let (told, axis, left_count) = Sweep::new(&all, count).cheapest(0, count).expect("a split");
            let found = cost(&references, axis, left_count);
            assert!((told - found).abs() <= 1e-4 * found, "{told} for what costs {found}");
            for (axis, left_count) in (0..3).flat_map(|axis| (1..count).map(move |left| (axis, left))) {
                assert!(found <= cost(&references, axis, left_count) * 1.0001);
            }
        }
    }
}
