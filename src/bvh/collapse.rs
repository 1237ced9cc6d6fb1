//! From two children to eight, by dynamic programming \[YKL17\].
//!
//! C(n, i) is the least SAH cost of the primitives below n as a forest of at most i eight-wide trees:
//!
//! ```text
//! C(n, 1) = min( leaf(n), area(n)·NODE_COST + D(n, 8) )
//! C(n, i) = min( D(n, i), C(n, i − 1) )          D(n, i) = min over k of C(left, k) + C(right, i − k)
//! ```
//!
//! Areas cancel where costs are compared, so they stay half areas and are never divided by the root's.

use super::{
    BLOCK, Bvh,
    build::{self, Binary, MAX_LEAF, Reference},
    node::{Child, Node},
};
use crate::geometry::Aabb;

/// Cost of testing a node's eight boxes, in tests of one primitive.
const NODE_COST: f32 = 2.0;
/// Subtrees of fewer primitives are weighed by one thread.
const PARALLEL: u32 = 4096;

/// How a forest of i trees is made of a node's children: the `i`-th nibble is k, 0 for "one tree less".
/// The first nibble is 1 where a single tree is a leaf.
#[derive(Clone, Copy, Debug, Default)]
struct Choice(u64);

impl Choice {
    fn set(&mut self, i: usize, k: usize) {
        self.0 = self.0 & !(15 << (4 * i)) | (k as u64) << (4 * i);
    }

    fn get(self, i: usize) -> usize {
        (self.0 >> (4 * i) & 15) as usize
    }
}

type Costs = [f32; 9];

impl Bvh {
    /// Builds a tree over the references, on the current rayon pool. The same references give the same
    /// tree for any number of threads.
    pub fn build(mut references: Vec<Reference>) -> Self {
        if references.is_empty() {
            return Self::default();
        }
        let binary = build::build(&mut references);
        let mut choices = vec![Choice::default(); binary.len()];
        weigh(&binary, &mut choices, &references);
        let mut emitter =
            Emitter { binary: &binary, choices: &choices, nodes: vec![Node::EMPTY], leaves: vec![] };
        emitter.root();
        let Emitter { mut nodes, leaves, .. } = emitter;
        let slots = assign_slots(&mut nodes, &leaves, &binary, &references);
        let Aabb { min, max } = binary[0].bounds;
        Self { nodes, slots, reach: min.abs().max(max.abs()) }
    }
}

/// Fills in the choices below `nodes[0]` and returns C(·, 1..=8).
fn weigh(nodes: &[Binary], choices: &mut [Choice], references: &[Reference]) -> Costs {
    let node = &nodes[0];
    let area = node.bounds.half_area();
    let mut costs = [f32::INFINITY; 9];
    if node.is_leaf() {
        costs[1..].fill(area * node.count as f32);
        choices[0].set(0, 1);
        return costs;
    }
    let right = node.right as usize;
    let (left_nodes, right_nodes) = (&nodes[1..right], &nodes[right..]);
    let (choice, rest) = choices.split_first_mut().expect("a node has a choice");
    let (left_choices, right_choices) = rest.split_at_mut(right - 1);
    let (left, right) = if node.count < PARALLEL {
        (weigh(left_nodes, left_choices, references), weigh(right_nodes, right_choices, references))
    } else {
        rayon::join(
            || weigh(left_nodes, left_choices, references),
            || weigh(right_nodes, right_choices, references),
        )
    };
    for i in 2..=8 {
        for k in 1..i {
            let cost = left[k] + right[i - k];
            if cost < costs[i] {
                costs[i] = cost;
                choice.set(i, k);
            }
        }
    }
    costs[1] = area * NODE_COST + costs[8];
    let leaf_cost = area * node.count as f32;
    if node.count as usize <= MAX_LEAF && leaf_cost <= costs[1] && is_uniform(node, references) {
        costs[1] = leaf_cost;
        choice.set(0, 1);
    }
    // The eighth choice stays: it is how the node itself is filled, and a node has all its places.
    for i in 2..8 {
        if costs[i - 1] <= costs[i] {
            costs[i] = costs[i - 1];
            choice.set(i, 0);
        }
    }
    costs
}

fn is_uniform(node: &Binary, references: &[Reference]) -> bool {
    let run = &references[node.first as usize..(node.first + node.count) as usize];
    run.iter().all(|r| r.class == run[0].class)
}

/// A leaf that waits for its slots: where it hangs, and which binary node it is.
struct Pending {
    node: u32,
    place: u32,
    binary: u32,
}

struct Emitter<'a> {
    binary: &'a [Binary],
    choices: &'a [Choice],
    nodes: Vec<Node>,
    leaves: Vec<Pending>,
}

impl Emitter<'_> {
    fn root(&mut self) {
        if self.choices[0].get(0) == 1 {
            self.attach(0, 0, 0);
        } else {
            self.expand(0, 0);
        }
    }

    /// Fills the eight-wide node `at` with the forest below the binary node `from`.
    fn expand(&mut self, at: usize, from: usize) {
        let mut roots = [0usize; 8];
        let mut count = 0;
        self.forest(from, 8, true, &mut roots, &mut count);
        for (place, &root) in roots[..count].iter().enumerate() {
            self.attach(at, place, root);
        }
    }

    /// Hangs the tree of a binary node into a place; inner nodes follow depth first.
    fn attach(&mut self, at: usize, place: usize, root: usize) {
        let bounds = self.binary[root].bounds;
        if self.choices[root].get(0) == 1 {
            self.leaves.push(Pending { node: at as u32, place: place as u32, binary: root as u32 });
            self.nodes[at].set(place, bounds, Child::ABSENT);
        } else {
            let index = self.nodes.len();
            self.nodes.push(Node::EMPTY);
            self.nodes[at].set(place, bounds, Child::inner(index as u32));
            self.expand(index, root);
        }
    }

    /// The roots of the forest of at most `i` trees below a binary node. `open` says that the node
    /// itself is being filled, so that it is never its own child.
    fn forest(&self, from: usize, i: usize, open: bool, roots: &mut [usize; 8], count: &mut usize) {
        let choice = self.choices[from];
        let mut i = i;
        while !open && i > 1 && choice.get(i) == 0 {
            i -= 1;
        }
        if i == 1 || self.binary[from].is_leaf() {
            roots[*count] = from;
            *count += 1;
            return;
        }
        let k = choice.get(i);
        self.forest(from + 1, k, false, roots, count);
        self.forest(from + self.binary[from].right as usize, i - k, false, roots, count);
    }
}

/// Gives each leaf its slots: classes ascending, depth first within a class, no leaf across blocks.
fn assign_slots(
    nodes: &mut [Node],
    leaves: &[Pending],
    binary: &[Binary],
    references: &[Reference],
) -> Vec<u32> {
    let mut classes: Vec<u8> =
        leaves.iter().map(|leaf| references[binary[leaf.binary as usize].first as usize].class).collect();
    let order = classes.clone();
    classes.sort_unstable();
    classes.dedup();
    let mut slots = Vec::with_capacity(references.len() + references.len() / 8 + BLOCK);
    for class in classes {
        for (leaf, _) in leaves.iter().zip(&order).filter(|&(_, &c)| c == class) {
            let node = &binary[leaf.binary as usize];
            let (first, count) = (node.first as usize, node.count as usize);
            if slots.len() % BLOCK + count > BLOCK {
                slots.resize(slots.len().next_multiple_of(BLOCK), u32::MAX);
            }
            let child = Child::leaf(slots.len() as u32, node.count);
            nodes[leaf.node as usize].children[leaf.place as usize] = child;
            slots.extend(references[first..first + count].iter().map(|r| r.index));
        }
        slots.resize(slots.len().next_multiple_of(BLOCK), u32::MAX);
    }
    slots
}
