//! Is the tree what it claims to be?

use super::{BLOCK, Bvh, Kind};
use crate::geometry::Aabb;

/// Measures of a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    /// Inner nodes.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Primitives in leaves.
    pub primitives: usize,
    /// Nodes on the longest way from the root to a leaf.
    pub depth: usize,
    /// Expected node tests of a random ray that meets the root: Σ area(node)/area(root).
    pub node_cost: f64,
    /// Expected leaves that such a ray comes to: Σ area(leaf)/area(root).
    pub leaf_cost: f64,
    /// Expected primitive tests of such a ray: Σ area(leaf)·count/area(root).
    pub primitive_cost: f64,
}

/// Why a tree is not sound.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Defect {
    /// A box does not contain what is below it.
    #[error("child {place} of node {node} holds something that sticks out of its box")]
    SticksOut {
        /// Node.
        node: usize,
        /// Child.
        place: usize,
    },
    /// A leaf names slots outside its block or none at all.
    #[error("child {place} of node {node} is a leaf across blocks or with padding in it")]
    BadLeaf {
        /// Node.
        node: usize,
        /// Child.
        place: usize,
    },
    /// A node is reached twice or never, or a primitive is in no leaf or in several.
    #[error("{what} {index} is reached {times} times")]
    Reached {
        /// "node" or "primitive".
        what: &'static str,
        /// Which.
        index: usize,
        /// How often.
        times: u32,
    },
}

impl Bvh {
    /// Checks that every primitive is in exactly one leaf and every box holds what is below it.
    ///
    /// # Errors
    /// The first [`Defect`] found.
    pub fn validate(&self, boxes: &[Aabb]) -> Result<Shape, Defect> {
        let mut shape = Shape::default();
        let mut seen_nodes = vec![0u32; self.nodes.len()];
        let mut seen_primitives = vec![0u32; boxes.len()];
        let root_area = f64::from(Aabb::half_area(boxes.iter().fold(Aabb::EMPTY, |a, &b| a.union(b))));
        let mut stack = vec![(0usize, Aabb::EMPTY, 1usize)];
        if self.nodes.is_empty() {
            stack.clear();
        }
        while let Some((index, within, depth)) = stack.pop() {
            let node = &self.nodes[index];
            seen_nodes[index] += 1;
            if seen_nodes[index] > 1 {
                return Err(Defect::Reached { what: "node", index, times: seen_nodes[index] });
            }
            shape.nodes += 1;
            shape.depth = shape.depth.max(depth);
            let mut union = Aabb::EMPTY;
            for place in 0..8 {
                let bounds = node.child_bounds(place);
                let contains = |b: Aabb| bounds.contains(b);
                match node.children[place].kind() {
                    Kind::Absent => continue,
                    Kind::Inner(child) => stack.push((child as usize, bounds, depth + 1)),
                    Kind::Leaf { first, count } => {
                        let (first, count) = (first as usize, count as usize);
                        if first / BLOCK != (first + count - 1) / BLOCK || first + count > self.slots.len() {
                            return Err(Defect::BadLeaf { node: index, place });
                        }
                        for &slot in &self.slots[first..first + count] {
                            let Some(&primitive) = boxes.get(slot as usize) else {
                                return Err(Defect::BadLeaf { node: index, place });
                            };
                            seen_primitives[slot as usize] += 1;
                            if !contains(primitive) {
                                return Err(Defect::SticksOut { node: index, place });
                            }
                        }
                        shape.leaves += 1;
                        shape.primitives += count;
                        let chance = f64::from(bounds.half_area()) / root_area;
                        shape.leaf_cost += chance;
                        shape.primitive_cost += chance * count as f64;
                    }
                }
                union = union.union(bounds);
            }
            if index != 0 && !within.contains(union) {
                return Err(Defect::SticksOut { node: index, place: 0 });
            }
            shape.node_cost += f64::from(union.half_area()) / root_area;
        }
        let once = |what, seen: &[u32]| match seen.iter().position(|&times| times != 1) {
            Some(index) => Err(Defect::Reached { what, index, times: seen[index] }),
            None => Ok(()),
        };
        once("node", &seen_nodes)?;
        once("primitive", &seen_primitives)?;
        Ok(shape)
    }
}

#[cfg(test)]
mod tests;
