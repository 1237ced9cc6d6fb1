//! From two children to eight: nodes and slots laid out as [`weigh`](super::weigh) chose.
//!
//! The tree is cut into segments: subtrees of up to [`SEGMENT`] places, and between the root and
//! them one segment a node. Threads walk through each segment twice, by the same steps: first they count its nodes and
//! slots; then, as it is known where each begins, they fill them in. So nothing is there twice. Segments follow each
//! other depth first, and where they are cut depends on the tree alone.

use rayon::prelude::*;

use super::{
    binary::{Binary, Packed, Run},
    bounds::Bounds,
    reference::Names,
    weigh::Choices,
};
use crate::bvh::{BLOCK, Child, Node};

/// Places of a segment, at most.
const SEGMENT: u32 = 4096;

/// The binary tree, weighed.
#[derive(Clone, Copy)]
pub(super) struct Weighed<'a> {
    pub(super) nodes: &'a [Packed],
    pub(super) choices: &'a Choices,
    pub(super) names: &'a Names,
}

/// Up to eight subtrees.
#[derive(Default)]
struct Forest {
    runs: [Run; 8],
    count: usize,
}

impl Forest {
    fn push(&mut self, run: Run) {
        self.runs[self.count] = run;
        self.count += 1;
    }

    fn places(&self) -> impl Iterator<Item = (usize, Run)> {
        self.runs.into_iter().take(self.count).enumerate()
    }
}

/// A part of the tree.
struct Segment {
    /// The binary subtree that it begins with.
    run: Run,
    /// Of one node between the root and the rest: at the places of its inner children, the numbers of their segments.
    top: Option<[u32; 8]>,
}

/// Where a walk puts what it meets.
trait Target {
    /// A node; returns its index.
    fn node(&mut self) -> u32;
    /// What a node holds: binary nodes, and what has become of each.
    fn fill(&mut self, node: u32, forest: &Forest, children: [Child; 8]);
    /// The primitives of a leaf; returns the first slot.
    fn leaf(&mut self, class: usize, indices: &[u32]) -> u32;
    /// The first node of another segment.
    fn first_of(&self, segment: u32) -> u32;
}

/// What has been laid out: nodes, and slots of each class up to the last that is filled.
#[derive(Default)]
struct Extent {
    nodes: u32,
    filled: Vec<u32>,
}

impl Extent {
    /// Slots of a class, in whole blocks.
    fn slots(&self, class: usize) -> usize {
        self.filled.get(class).map_or(0, |&filled| (filled as usize).next_multiple_of(BLOCK))
    }
}

/// Counts.
impl Target for Extent {
    fn node(&mut self) -> u32 {
        self.nodes += 1;
        self.nodes - 1
    }

    fn fill(&mut self, _: u32, _: &Forest, _: [Child; 8]) {}

    /// No leaf crosses from one block into the next.
    fn leaf(&mut self, class: usize, indices: &[u32]) -> u32 {
        if self.filled.len() <= class {
            self.filled.resize(class + 1, 0);
        }
        let (block, count) = (BLOCK as u32, indices.len() as u32);
        let filled = self.filled[class];
        let begin = if filled % block + count > block { filled.next_multiple_of(block) } else { filled };
        self.filled[class] = begin + count;
        begin
    }

    fn first_of(&self, _: u32) -> u32 {
        0
    }
}

/// A segment's nodes and its slots of each class, and where they begin.
#[derive(Default)]
struct Part<'a> {
    first: u32,
    nodes: &'a mut [Node],
    slots: Vec<(u32, &'a mut [u32])>,
}

/// Fills a part in.
struct Filling<'a> {
    tree: Weighed<'a>,
    /// First nodes of all segments.
    firsts: &'a [u32],
    part: Part<'a>,
    filled: Extent,
}

impl Target for Filling<'_> {
    fn node(&mut self) -> u32 {
        self.part.first + self.filled.node()
    }

    fn fill(&mut self, node: u32, forest: &Forest, children: [Child; 8]) {
        let mut boxes = [Bounds::EMPTY; 8];
        for (place, run) in forest.places() {
            boxes[place] = self.tree.node(run.root).bounds;
        }
        self.part.nodes[(node - self.part.first) as usize] =
            Node { bounds: Bounds::columns(boxes), children };
    }

    fn leaf(&mut self, class: usize, indices: &[u32]) -> u32 {
        let begin = self.filled.leaf(class, indices);
        let (first, slots) = &mut self.part.slots[class];
        slots[begin as usize..][..indices.len()].copy_from_slice(indices);
        *first + begin
    }

    fn first_of(&self, segment: u32) -> u32 {
        self.firsts[segment as usize]
    }
}

/// Lays out nodes and slots.
pub(super) fn collapse(tree: Weighed<'_>) -> (Vec<Node>, Vec<u32>) {
    let mut segments = vec![];
    tree.cut(Run::all(tree.nodes), &mut segments);
    let count = |segment: &Segment| {
        let mut extent = Extent::default();
        tree.walk(segment, &mut extent);
        extent
    };
    let extents: Vec<Extent> = segments.par_iter().with_max_len(1).map(count).collect();

    let classes = extents.iter().map(|extent| extent.filled.len()).max().unwrap_or(0);
    let node_count = extents.iter().map(|extent| extent.nodes as usize).sum();
    let slot_count =
        (0..classes).flat_map(|class| extents.iter().map(move |extent| extent.slots(class))).sum();
    let mut nodes: Vec<Node> = rayon::iter::repeat_n(Node::EMPTY, node_count).collect();
    let mut slots: Vec<u32> = rayon::iter::repeat_n(u32::MAX, slot_count).collect();
    let parts = divide(&extents, classes, &mut nodes, &mut slots);
    let firsts: Vec<u32> = parts.iter().map(|part| part.first).collect();
    segments.par_iter().zip(parts).with_max_len(1).for_each(|(segment, part)| {
        let mut filling = Filling { tree, firsts: &firsts, part, filled: Extent::default() };
        tree.walk(segment, &mut filling);
    });
    (nodes, slots)
}

/// Segments one after the other; slots class by class.
fn divide<'a>(
    extents: &[Extent],
    classes: usize,
    mut nodes: &'a mut [Node],
    mut slots: &'a mut [u32],
) -> Vec<Part<'a>> {
    let mut parts = Vec::with_capacity(extents.len());
    let mut first = 0;
    for extent in extents {
        let (own, others) = nodes.split_at_mut(extent.nodes as usize);
        nodes = others;
        parts.push(Part { first, nodes: own, slots: Vec::with_capacity(classes) });
        first += extent.nodes;
    }
    let mut first = 0;
    for class in 0..classes {
        for (extent, part) in extents.iter().zip(&mut parts) {
            let (own, others) = slots.split_at_mut(extent.slots(class));
            slots = others;
            part.slots.push((first, own));
            first += extent.slots(class) as u32;
        }
    }
    parts
}

impl Weighed<'_> {
    fn node(&self, root: u32) -> Binary {
        Binary::unpack(&self.nodes[root as usize])
    }

    fn is_leaf(&self, run: Run) -> bool {
        self.choices.of(run.root).leaf_count() != 0
    }

    /// Cuts a subtree into segments and returns the number of the first.
    fn cut(&self, run: Run, segments: &mut Vec<Segment>) -> u32 {
        let number = segments.len();
        let is_top = run.places > SEGMENT && !self.is_leaf(run);
        segments.push(Segment { run, top: None });
        if is_top {
            let mut numbers = [0; 8];
            for (place, child) in self.forest(run).places().filter(|&(_, child)| !self.is_leaf(child)) {
                numbers[place] = self.cut(child, segments);
            }
            segments[number].top = Some(numbers);
        }
        number as u32
    }

    /// Lays a segment out.
    fn walk(&self, segment: &Segment, target: &mut impl Target) {
        let Segment { run, top } = *segment;
        if self.is_leaf(run) {
            let (lone, leaf) = (target.node(), self.leaf(run, target));
            let mut forest = Forest::default();
            forest.push(run);
            let mut children = [Child::ABSENT; 8];
            children[0] = leaf;
            target.fill(lone, &forest, children);
        } else if let Some(numbers) = top {
            self.expand(run, target, &|_, place, target| target.first_of(numbers[place]));
        } else {
            self.expand(run, target, &|child, _, target| self.subtree(child, target));
        }
    }

    /// Lays out a node and what is below it, depth first; returns its index.
    fn subtree(&self, run: Run, target: &mut impl Target) -> u32 {
        self.expand(run, target, &|child, _, target| self.subtree(child, target))
    }

    /// Lays out a node; `inner` has the index of a child that is no leaf, by its place.
    fn expand<T: Target>(&self, run: Run, target: &mut T, inner: &impl Fn(Run, usize, &mut T) -> u32) -> u32 {
        let index = target.node();
        let forest = self.forest(run);
        let mut children = [Child::ABSENT; 8];
        for (place, child) in forest.places() {
            children[place] = if self.is_leaf(child) {
                self.leaf(child, target)
            } else {
                Child::inner(inner(child, place, target))
            };
        }
        target.fill(index, &forest, children);
        index
    }

    /// Puts a leaf's primitives into slots.
    fn leaf(&self, run: Run, target: &mut impl Target) -> Child {
        let first = self.node(run.root).first as usize;
        let count = self.choices.of(run.root).leaf_count();
        let class = usize::from(self.names.class(first));
        let begin = target.leaf(class, &self.names.indices[first..][..count]);
        Child::leaf(begin, count as u32)
    }

    /// The roots of the forest that fills a node of eight.
    fn forest(&self, run: Run) -> Forest {
        let mut forest = Forest::default();
        // The node itself is being filled, so it is not its own child.
        let from_left = self.choices.of(run.root).left_trees(8);
        let [left, right] = self.choices.children(run, self.nodes);
        self.trees(left, from_left, &mut forest);
        self.trees(right, 8 - from_left, &mut forest);
        forest
    }

    /// The roots of a forest of at most `i` trees below a node.
    fn trees(&self, run: Run, i: usize, forest: &mut Forest) {
        let from_left = self.choices.of(run.root).left_trees(i);
        if from_left == 0 {
            forest.push(run);
            return;
        }
        let [left, right] = self.choices.children(run, self.nodes);
        self.trees(left, from_left, forest);
        self.trees(right, i - from_left, forest);
    }
}
