//! The tree in numbers, for people.

use super::Scene;
use crate::bvh::Kind;

/// The upper tree: groups that instances place have trees of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TreeShape {
    /// Nodes from the root to the deepest leaf.
    pub depth: u32,
    /// Leaves.
    pub leaves: u64,
    /// Nodes that a random line through the scene is expected to enter: areas of their boxes, in that of the
    /// root (the surface area heuristic).
    pub node_cost: f64,
    /// Primitives that it is expected to be tested against, likewise.
    pub primitive_cost: f64,
}

impl Scene {
    /// Walks through the tree.
    pub fn tree_shape(&self) -> TreeShape {
        let mut shape = TreeShape::default();
        let nodes = self.bvh.nodes();
        let mut stack = vec![(0, 1.0, 1)];
        let mut root_area = None;
        while let Some((index, cost, depth)) = stack.pop() {
            let Some(node) = nodes.get(index as usize) else { continue };
            shape.node_cost += cost;
            shape.depth = shape.depth.max(depth);
            let there = (0..8).filter(|&place| node.children[place].kind() != Kind::Absent);
            let area = *root_area.get_or_insert_with(|| f64::from(node.bounds().half_area()));
            for place in there {
                let share = f64::from(node.child_bounds(place).half_area()) / area.max(f64::MIN_POSITIVE);
                match node.children[place].kind() {
                    Kind::Inner(child) => stack.push((child, share, depth + 1)),
                    Kind::Leaf { count, .. } => {
                        shape.leaves += 1;
                        shape.primitive_cost += share * f64::from(count);
                    }
                    Kind::Absent => {}
                }
            }
        }
        shape
    }
}
