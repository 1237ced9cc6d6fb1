//! Where the segments of neighbours enter the tree.
//!
//! Occlusion rays are short, or leave a common neighbourhood for a common light, and their first steps are
//! the same: down from the root, past everything that is elsewhere. These steps are taken once, by the box
//! around the segments. What is left, up to eight subtrees, becomes a node from which each ray starts.

use glam::Vec3;

use super::{Bvh, Child, Kind, Node};
use crate::geometry::{Aabb, Rayx16, aabb};
use crate::simd::{Mask, Mask8, Mask16, Real, Vec3x16, f32x8, f32x16};

/// Ulps of a coordinate by which the box around segments is wider than they are, against the rounding of
/// their ends and of the slab tests that decide.
const MARGIN: f32 = 16.0 * f32::EPSILON;
/// How much farther segments reach: distances may have so few bits that each operation is off by one of them.
const LEAST: f32 = 1e-43;

/// The box around segments, as it grows.
pub(super) struct Segments {
    low: Vec3x16,
    high: Vec3x16,
}

impl Segments {
    pub(super) fn none() -> Self {
        Self { low: Vec3x16::splat(Vec3::INFINITY), high: Vec3x16::splat(Vec3::NEG_INFINITY) }
    }

    #[inline]
    pub(super) fn add(&mut self, rays: &Rayx16, active: Mask16) {
        for t in [rays.t_near.min(f32x16::zero()), rays.t_far + f32x16::splat(LEAST)] {
            let end = rays.org + rays.dir.scale(t);
            self.low = Vec3x16::select(active, end.min(self.low), self.low);
            self.high = Vec3x16::select(active, end.max(self.high), self.high);
        }
    }

    /// The box, `None` if it has no end. `reach` bounds the coordinates of what can be hit.
    pub(super) fn bounds(&self, reach: Vec3) -> Option<Aabb> {
        let min = Vec3::new(self.low.x.reduce_min(), self.low.y.reduce_min(), self.low.z.reduce_min());
        let max = Vec3::new(self.high.x.reduce_max(), self.high.y.reduce_max(), self.high.z.reduce_max());
        let margin = (min.abs().max(max.abs()) + reach) * MARGIN;
        let bounds = Aabb { min: min - margin, max: max + margin };
        (bounds.min.is_finite() && bounds.max.is_finite()).then_some(bounds)
    }
}

/// Which of a node's children each of sixteen rays enters, as bits, and which rays enter any: sixteen rays a box, where a
/// ray on its own would take a step.
#[inline]
pub(super) fn children_entered(node: &Node, rays: &Rayx16) -> ([u8; 16], u32) {
    let of_child: [u32; 8] = std::array::from_fn(|place| match node.children[place] {
        Child::ABSENT => 0,
        _ => {
            let bounds = node.child_bounds(place);
            let corners = (Vec3x16::splat(bounds.min), Vec3x16::splat(bounds.max));
            let (low, high) = aabb::interval(corners, (rays.org, rays.rdir), (rays.t_near, rays.t_far));
            low.le(high).to_bitmask()
        }
    });
    let mut of_ray = [0; 16];
    for (half, of_ray) in of_ray.as_chunks_mut::<8>().0.iter_mut().enumerate() {
        *of_ray = turned(of_child.map(|rays| (rays >> (half * 8)) as u8));
    }
    (of_ray, of_child.into_iter().fold(0, |any, rays| any | rays))
}

/// A matrix of bits, turned over its diagonal: bit i of byte k is bit k of byte i. Squares of one, two and four bits change
/// places.
fn turned(rows: [u8; 8]) -> [u8; 8] {
    let mut bits = u64::from_le_bytes(rows);
    for (by, upper) in [(7, 0x00aa_00aa_00aa_00aa), (14, 0x0000_cccc_0000_cccc), (28, 0x0000_0000_f0f0_f0f0)]
    {
        let differ = (bits ^ bits >> by) & upper;
        bits ^= differ ^ differ << by;
    }
    bits.to_le_bytes()
}

impl Bvh {
    /// A node that holds all of the tree that a box meets, in up to eight subtrees.
    pub(super) fn entry(&self, bounds: Aabb) -> Node {
        let mut node = Node::EMPTY;
        let mut count = 0;
        if !self.nodes.is_empty() {
            node.set(0, bounds, Child::inner(0));
            count = 1;
        }
        let mut place = 0;
        while place < count {
            let Kind::Inner(index) = node.children[place].kind() else {
                place += 1;
                continue;
            };
            let below = &self.nodes[index as usize];
            let meets = below.overlaps(bounds);
            let more = meets.count_ones() as usize;
            if count - 1 + more > Node::EMPTY.children.len() {
                place += 1;
                continue;
            }
            // The last subtree takes the place of the one that is opened.
            count -= 1;
            let (last, child) = (node.child_bounds(count), node.children[count]);
            node.set(place, last, child);
            node.clear(count);
            for other in (0..8).filter(|other| meets >> other & 1 != 0) {
                node.set(count, below.child_bounds(other), below.children[other]);
                count += 1;
            }
        }
        node
    }
}

impl Node {
    /// The children whose boxes meet another: child i is bit i.
    fn overlaps(&self, bounds: Aabb) -> u32 {
        let mut meets = Mask8::splat(true);
        for axis in 0..3 {
            let [low, high] = self.bounds[axis].map(f32x8::new);
            meets = meets & low.le(f32x8::splat(bounds.max[axis])) & f32x8::splat(bounds.min[axis]).le(high);
        }
        meets.to_bitmask()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Ray, RayLanes, seeds::Random};
    use crate::simd::{Real, Vector3};

    #[test]
    fn bits_change_rows_for_columns() {
        for (row, column) in (0..64).map(|bit| (bit / 8, bit % 8)) {
            let (mut rows, mut expected) = ([0; 8], [0; 8]);
            (rows[row], expected[column]) = (1 << column, 1 << row);
            assert_eq!(turned(rows), expected, "row {row}, column {column}");
        }
    }

    #[test]
    fn rays_enter_the_children_whose_boxes_they_enter() {
        let mut random = Random::new(43);
        let mut entered = 0;
        for count in (0..=8).cycle().take(900) {
            let mut node = Node::EMPTY;
            for place in 0..count {
                let (centre, size) = (random.vector(), random.vector().abs());
                node.set(
                    place,
                    Aabb { min: centre - size, max: centre + size },
                    Child::leaf(place as u32, 1),
                );
            }
            let rays: [Ray; 16] = std::array::from_fn(|_| {
                Ray::new(random.vector(), random.vector(), 0.0, 1.0 + random.signed())
            });
            let lanes = RayLanes::new(
                Vector3::from_fn(|i| rays[i].org),
                Vector3::from_fn(|i| rays[i].dir),
                f32x16::from_fn(|i| rays[i].t_near),
                f32x16::from_fn(|i| rays[i].t_far),
            );
            let (children, any) = children_entered(&node, &lanes);
            for (i, ray) in rays.iter().enumerate() {
                let enters = |place: &usize| {
                    let (low, high) = node.child_bounds(*place).interval(ray);
                    low <= high
                };
                let expected = (0..count).filter(enters).fold(0, |set, place| set | 1 << place);
                assert_eq!(
                    (children[i], any >> i & 1 != 0),
                    (expected, expected != 0),
                    "ray {i} of {count} boxes"
                );
                entered += expected.count_ones();
            }
        }
        assert!(entered > 2000, "{entered}");
    }
}
