//! Which binary nodes become nodes of eight, by dynamic programming \[YKL17\].
//!
//! C(n, i) is the least SAH cost of the primitives below n as a forest of at most i eight-wide trees:
//!
//! ```text
//! C(n, 1) = min( leaf(n), area(n)·NODE_COST + D(n, 8) )
//! C(n, i) = min( D(n, i), C(n, 1) )          D(n, i) = min over k of C(left, k) + C(right, i − k)
//! ```
//!
//! The paper has C(n, i − 1) in place of C(n, 1): the same, since D does not grow with i, in floats
//! either. Areas cancel where costs are compared, so they stay half areas and are never divided by the
//! root's.

use super::{
    MAX_LEAF,
    binary::{Binary, Packed, Run},
    reference::Names,
};
use crate::simd::{Bits, Mask, Real, f32x8, u32x8};

/// Cost of testing a node's eight boxes, of going to a leaf and testing its block, and what each primitive there
/// adds: nothing in a wave, whose lanes are the block's, and all of it in a packet. Found by trying: with a leaf
/// that cost one for each primitive, scattered rays took 1.01 to 1.06 of the time; with nodes at 2 and leaves at 1,
/// 1.0 to 1.06.
const NODE_COST: f32 = 2.5;
const LEAF_COST: f32 = 2.0;
const PRIMITIVE_COST: f32 = 0.3;
/// Subtrees of fewer places are weighed by one thread.
const PARALLEL: usize = 8192;

/// How forests of i = 2 to 8 trees are made of a node's children: k, or 0 for one tree. The first four bits are the count
/// of references where that tree is a leaf, the last eleven the distance to the right child, or 0 where it is more.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice(u32);

/// The bits of k for forests of up to i trees: how far from the first, and which of those from there on.
const FIELDS: [(u32, u32); 9] = [(0, 0), (0, 0), (4, 1), (5, 3), (7, 3), (9, 7), (12, 7), (15, 7), (18, 7)];
/// The first bit of the distance to the right child.
const RIGHT: u32 = 21;

impl Choice {
    /// References of the node as a leaf; 0 if it is none.
    #[inline]
    pub(super) fn leaf_count(self) -> usize {
        (self.0 & 15) as usize
    }

    /// The trees of a forest of `i` that are made of the left child; 0 for the node as one tree.
    #[inline]
    pub(super) fn left_trees(self, i: usize) -> usize {
        let (first, bits) = FIELDS[i % 9];
        (self.0 >> first & bits) as usize
    }
}

/// The choices of all nodes.
pub(super) struct Choices(Vec<u32>);

impl Choices {
    pub(super) fn new(nodes: &[Packed], names: &Names) -> Self {
        let mut choices = vec![0; nodes.len()];
        weigh(nodes, &mut choices, names);
        Self(choices)
    }

    /// The choice of a node.
    #[inline]
    pub(super) fn of(&self, node: u32) -> Choice {
        Choice(self.0[node as usize])
    }

    /// The runs of an inner node's children. Nodes are hardly ever looked at: choices are closer together.
    #[inline]
    pub(super) fn children(&self, run: Run, nodes: &[Packed]) -> [Run; 2] {
        match self.of(run.root).0 >> RIGHT {
            0 => run.children(Binary::unpack(&nodes[run.root as usize]).right() as u32),
            near => run.children(near),
        }
    }
}

/// C(·, 1..=8), a lane each.
type Costs = f32x8;

fn leaf_cost(count: usize) -> f32 {
    LEAF_COST + PRIMITIVE_COST * count as f32
}

/// Fills in the choices for the run of `nodes[0]`. Returns the costs and the number of references.
fn weigh(nodes: &[Packed], choices: &mut [u32], names: &Names) -> (Costs, usize) {
    let node = Binary::unpack(&nodes[0]);
    let area = node.bounds.aabb().half_area();
    if node.is_leaf() {
        let count = node.leaf_count();
        choices[0] = count as u32;
        return (Costs::splat(area * leaf_cost(count)), count);
    }
    let (left_nodes, right_nodes) = nodes[1..].split_at(node.right() - 1);
    let (choice, rest) = choices.split_first_mut().expect("a node has a choice");
    let (left_choices, right_choices) = rest.split_at_mut(node.right() - 1);
    let mut left = || weigh(left_nodes, left_choices, names);
    let mut right = || weigh(right_nodes, right_choices, names);
    let ((left, left_count), (right, right_count)) =
        if nodes.len() < PARALLEL { (left(), right()) } else { rayon::join(left, right) };
    let (distributed, from_left) = distribute(left, right);
    let count = left_count + right_count;
    let mut single = area * NODE_COST + distributed.lane(7);
    let mut leaf_count = 0;
    if count <= MAX_LEAF {
        let leaf = area * leaf_cost(count);
        if leaf <= single && names.are_of_one_class(node.first as usize, count) {
            (single, leaf_count) = (leaf, count);
        }
    }
    let single = Costs::splat(single);
    let lone = single.le(distributed);
    let ks = u32x8::select(lone, u32x8::splat(0), from_left).to_array();
    // The eighth stays: it is how the node itself is filled, and a node has all its places.
    let eighth = from_left.lane(7) << FIELDS[8].0;
    let right = node.right() as u32;
    let near = if right >> (32 - RIGHT) == 0 { right << RIGHT } else { 0 };
    *choice = (2..8).fold(leaf_count as u32 | eighth | near, |bits, i| bits | ks[i - 1] << FIELDS[i].0);
    (Costs::min(single, distributed), count)
}

/// D(·, 1..=8), infinite for 1, and the k of each.
#[inline]
fn distribute(left: Costs, right: Costs) -> (Costs, u32x8) {
    // Where more trees don't make the left any cheaper, it is one: C does not grow with i.
    let trees = if left.equal(Costs::splat(left.lane(0))).all() { 1 } else { 7 };
    // Right costs, i − k lanes further on.
    let mut shifted = [f32::INFINITY; 16];
    shifted[8..].copy_from_slice(&right.to_array());
    let left = left.to_array();
    let mut least = Costs::splat(f32::INFINITY);
    // One where none is less: costs that overflow are no reason to leave a side without a tree.
    let mut from_left = u32x8::splat(1);
    for k in 1..=trees {
        let right = Costs::from_fn(|lane| shifted[8 - k + lane]);
        let cost = Costs::splat(left[k - 1]) + right;
        let less = cost.lt(least);
        least = Costs::select(less, cost, least);
        from_left = u32x8::select(less, u32x8::splat(k as u32), from_left);
    }
    (least, from_left)
}
