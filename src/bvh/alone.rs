//! One ray through the tree, eight boxes at a time: for a ray that comes to a tree in a leaf of another, where
//! no other ray waits that could take its turn.

use super::{Bvh, Child, Kind, Leaves, Node, Tally, Traversal, packet::insert};
use crate::geometry::{Hit, Ray, RayLanes, Rayx8, aabb};
use crate::simd::{Mask, Mask8, Real, f32x8};

impl Bvh {
    /// What [`Bvh::intersect_single`] finds, to the bit, by the kernels of eight lanes.
    pub fn intersect_alone<const ANY: bool, L: Leaves, T: Tally>(
        &self,
        leaves: &L,
        ray: &Ray,
        hit: &mut Hit,
        traversal: &mut Traversal<T>,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let lanes = RayLanes::splat(ray);
        let negative = [0, 1, 2].map(|axis| ray.rdir[axis] < 0.0);
        let Traversal { stack, tally, .. } = traversal;
        stack[0] = (Child::inner(0), f32::NEG_INFINITY);
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (child, enter) = stack[top];
            if enter > hit.t {
                continue;
            }
            match child.kind() {
                Kind::Absent => {}
                Kind::Inner(index) => {
                    tally.node(1);
                    let node = &self.nodes[index as usize];
                    let (entered, low) = enter_boxes(node, &lanes, negative, hit.t);
                    let (mut entered, low) = (entered.to_bitmask(), low.to_array());
                    let below = &mut stack[top..];
                    let mut count = 0;
                    while entered != 0 {
                        let place = entered.trailing_zeros() as usize % 8;
                        entered &= entered - 1;
                        insert(below, count, (node.children[place], low[place]));
                        count += 1;
                    }
                    top += count;
                }
                Kind::Leaf { first, count } => {
                    tally.leaf(count, 1);
                    let limited = RayLanes { t_far: f32x8::splat(hit.t), ..lanes };
                    if !leaves.intersect_blocks::<ANY, 1, f32x8>([first], limited, [&mut *hit]) {
                        leaves.intersect_alone::<ANY>((first, count), &limited, hit);
                    }
                    if ANY && hit.t == f32::NEG_INFINITY {
                        return;
                    }
                }
            }
        }
    }
}

/// Which boxes of a node the ray in all lanes enters before `t_far`, and where: the exact test, lane by box.
#[inline]
fn enter_boxes(node: &Node, ray: &Rayx8, negative: [bool; 3], t_far: f32) -> (Mask8, f32x8) {
    let (mut low, mut high) = (ray.t_near, f32x8::splat(t_far));
    let (org, rdir) = ([ray.org.x, ray.org.y, ray.org.z], [ray.rdir.x, ray.rdir.y, ray.rdir.z]);
    for axis in 0..3 {
        let (near, far) = node.slabs(axis, negative[axis]);
        // NaN stands on the left, where it loses: a ray in the plane itself is not constrained.
        low = ((f32x8::from(*near) - org[axis]) * rdir[axis]).max(low);
        high = ((f32x8::from(*far) - org[axis]) * rdir[axis] * f32x8::splat(aabb::WIDEN)).min(high);
    }
    (low.le(high), low)
}
