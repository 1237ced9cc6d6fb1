//! One ray through the tree, one box at a time: the reference for every other way.

use super::{Bvh, Child, Kind, Leaves, Tally, Traversal, packet::insert};
use crate::geometry::{Hit, Ray};

impl Bvh {
    /// Traces a ray; `hit` holds its limit in `t` and receives what is found. For `ANY`, t = −∞ means
    /// that the ray is blocked.
    pub fn intersect_single<const ANY: bool, L: Leaves, T: Tally>(
        &self,
        leaves: &L,
        ray: &Ray,
        hit: &mut Hit,
        traversal: &mut Traversal<T>,
    ) {
        if self.nodes.is_empty() {
            return;
        }
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
                    let below = &mut stack[top..];
                    let limited = Ray { t_far: hit.t, ..*ray };
                    let mut count = 0;
                    for (place, &child) in node.children.iter().enumerate() {
                        let (low, high) = node.child_bounds(place).interval(&limited);
                        if low <= high {
                            insert(below, count, (child, low));
                            count += 1;
                        }
                    }
                    top += count;
                }
                Kind::Leaf { first, count } => {
                    tally.leaf(count, 1);
                    leaves.intersect_single::<ANY>(first, count, ray, hit);
                    if ANY && hit.t == f32::NEG_INFINITY {
                        return;
                    }
                }
            }
        }
    }
}
