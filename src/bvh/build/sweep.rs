//! Small subtrees: every plane between two centres, exactly.
//!
//! Sixteen references fit into the first cache. They are sorted along each axis once; each split keeps
//! the three orders sorted \[Wal07\], so that a subtree costs one pass a level and no bins.

use super::{
    MAX_LEAF,
    binary::{Binary, Packed},
    bounds::Bounds,
    reference::Reference,
    splits::{Cheapest, PLACES, ROW, Splits},
};
use crate::simd::{Mask, Real, f32x8};

/// References of the largest subtree that is built here.
pub(super) const SMALL: usize = ROW;

/// For rows of so many: how many lie left of each split.
const LEFT_COUNTS: [[f32; PLACES]; SMALL + 1] = {
    let mut all = [[0.0; PLACES]; SMALL + 1];
    let mut count = 2;
    while count <= SMALL {
        let mut place = 0;
        while place < 3 * (count - 1) {
            all[count][place] = (place % (count - 1) + 1) as f32;
            place += 1;
        }
        count += 1;
    }
    all
};

/// A few references, sorted along each axis.
struct Sweep {
    bounds: [Bounds; SMALL],
    classes: [u8; SMALL],
    orders: [[u8; SMALL]; 3],
    splits: Splits,
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
        Self { bounds, classes: all.each_ref().map(Reference::class), orders, splits: Splits::EMPTY }
    }

    fn bounds(&self, i: u8) -> Bounds {
        self.bounds[usize::from(i) % SMALL]
    }

    /// Splits what stands from `low` to `high` in each order.
    fn split(&mut self, low: usize, high: usize, bounds: Bounds, first: u32, nodes: &mut [Packed]) -> usize {
        let count = high - low;
        let best = if count > 1 { Some(self.cheapest(low, high)) } else { None };
        let mut chosen = best.map(|best| (best.row, best.at));
        if count <= MAX_LEAF {
            let area = bounds.half_area();
            let split_cost = best.map_or(f32::INFINITY, |best| best.cost);
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
        if count > 2 {
            self.keep_orders(low, middle, high, axis);
        }
        let union = |run: &[u8]| run.iter().fold(Bounds::EMPTY, |a, &i| a.union(self.bounds(i)));
        let (left, right) = (union(&self.orders[axis][low..middle]), union(&self.orders[axis][middle..high]));
        let right_at = 1 + self.split(low, middle, left, first, &mut nodes[1..]);
        nodes[0] = Binary::inner(bounds, first, right_at).pack();
        right_at + self.split(middle, high, right, first + left_count as u32, &mut nodes[right_at..])
    }

    /// The cheapest split of at least two.
    fn cheapest(&mut self, low: usize, high: usize) -> Cheapest {
        let count = high - low;
        if let [a, b] = self.orders[0][low..high] {
            // The same along each axis.
            let cost = self.bounds(a).half_area() + self.bounds(b).half_area();
            return Cheapest { cost, row: 0, at: 1 };
        }
        for (axis, order) in self.orders.iter().enumerate() {
            let order = &order[low..high];
            self.splits.fill(axis, count, |i| self.bounds[usize::from(order[i]) % SMALL]);
        }
        let sides = |eight: usize| {
            let left = f32x8::new(LEFT_COUNTS[count].as_chunks().0[eight]);
            let beyond = (8 * eight + 8).saturating_sub(3 * (count - 1));
            ([left, f32x8::splat(count as f32) - left], 0xff >> beyond)
        };
        let (best, costs) = self.splits.cheapest(count, sides);
        // Among equals the middle, so that equal boxes make a shallow tree.
        let at = count / 2;
        let middle = costs[(at - 1) / 8].lane((at - 1) % 8);
        match best {
            Some(best) if best.cost < middle => best,
            _ => Cheapest { cost: middle, row: 0, at },
        }
    }

    /// Lets the other orders follow a split of one at `middle`.
    fn keep_orders(&mut self, low: usize, middle: usize, high: usize, axis: usize) {
        // Of two the orders do not matter, but for the first, in which they stay.
        let others = if (middle - low).max(high - middle) > 2 { 3 } else { 1 };
        let mut is_left = 0u32;
        for &i in &self.orders[axis][low..middle] {
            is_left |= 1 << i;
        }
        for other in (0..others).filter(|&other| other != axis) {
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
    use crate::geometry::{Aabb, seeds::Random};

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
        let mut random = Random::new(7);
        for round in 0..2000 {
            let count = 2 + round % (SMALL - 1);
            let references: Vec<Reference> = (0..count as u32)
                .map(|index| {
                    let corner = random.vector();
                    let bounds = Aabb::of_points([corner, corner + random.vector() * [0.02, 0.9][round % 2]]);
                    Reference::new(bounds, index, 0)
                })
                .collect();
            let mut all = [references[0]; SMALL];
            all[..count].copy_from_slice(&references);
            let Cheapest { cost: told, row, at } = Sweep::new(&all, count).cheapest(0, count);
            let found = cost(&references, row, at);
            assert!((told - found).abs() <= 1e-4 * found, "{told} for what costs {found}");
            for (axis, left_count) in (0..3).flat_map(|axis| (1..count).map(move |left| (axis, left))) {
                assert!(found <= cost(&references, axis, left_count) * 1.0001);
            }
        }
    }
}
