//! From two children to eight: nodes and slots laid out as [`weigh`](super::weigh) chose.
//!
//! The tree is cut into segments: subtrees of up to [`SEGMENT`] places, and between the root and
//! them one segment a node. Threads outline segments by themselves; once it is known how long they are, each node
//! has its place, and threads fill nodes in. Segments follow each other depth first, and where they are
//! cut depends on the tree alone.

use rayon::prelude::*;

use super::{
    binary::{Binary, Packed, Run},
    reference::Reference,
    weigh::Choices,
};
use crate::bvh::{BLOCK, Child, Kind, Node};

/// Places of a segment, at most.
const SEGMENT: u32 = 4096;

/// The binary tree, weighed.
#[derive(Clone, Copy)]
pub(super) struct Weighed<'a> {
    pub(super) nodes: &'a [Packed],
    pub(super) choices: &'a Choices,
    pub(super) references: &'a [Reference],
}

/// A node of eight before it has a place: which binary nodes its children are, and what is behind them,
/// counted from the start of the segment.
#[derive(Clone, Copy)]
struct Outline {
    roots: [u32; 8],
    children: [Child; 8],
}

impl Outline {
    const EMPTY: Self = Self { roots: [0; 8], children: [Child::ABSENT; 8] };

    fn set(&mut self, place: usize, run: Run, child: Child) {
        self.roots[place] = run.root;
        self.children[place] = child;
    }
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
    /// One node between the root and the rest: its inner children are the numbers of segments.
    is_top: bool,
    outlines: Vec<Outline>,
    /// What is in its slots, a list of whole blocks for each class.
    slots: Vec<Vec<u32>>,
}

/// Where a segment's nodes and its slots of each class begin.
#[derive(Clone)]
struct Start {
    node: u32,
    slots: Vec<u32>,
}

/// Lays out nodes and slots.
pub(super) fn collapse(tree: Weighed<'_>) -> (Vec<Node>, Vec<u32>) {
    let mut segments = vec![];
    tree.cut(Run::all(tree.nodes), &mut segments);
    segments.par_iter_mut().with_max_len(1).for_each(|segment| tree.outline(segment));

    let mut owners = vec![];
    for (i, segment) in segments.iter().enumerate() {
        owners.resize(owners.len() + segment.outlines.len(), i as u32);
    }
    let (starts, slots) = place(&segments);
    let fill = |(at, &owner): (usize, &u32)| {
        let (segment, start) = (&segments[owner as usize], &starts[owner as usize]);
        let outline = &segment.outlines[at - start.node as usize];
        let mut node = Node::EMPTY;
        for place in 0..8 {
            let root = outline.roots[place];
            let child = match outline.children[place].kind() {
                Kind::Absent => continue,
                Kind::Inner(number) if segment.is_top => Child::inner(starts[number as usize].node),
                Kind::Inner(index) => Child::inner(start.node + index),
                Kind::Leaf { first, count } => Child::leaf(start.slots[tree.class(root)] + first, count),
            };
            node.set(place, tree.node(root).bounds, child);
        }
        node
    };
    (owners.par_iter().enumerate().map(fill).collect(), slots)
}

/// Segments one after the other; slots class by class.
fn place(segments: &[Segment]) -> (Vec<Start>, Vec<u32>) {
    let classes = segments.iter().map(|segment| segment.slots.len()).max().unwrap_or(0);
    let mut node = 0;
    let mut starts = vec![];
    for segment in segments {
        starts.push(Start { node, slots: vec![0; classes] });
        node += segment.outlines.len() as u32;
    }
    let mut slots =
        Vec::with_capacity(segments.iter().flat_map(|segment| &segment.slots).map(Vec::len).sum());
    for class in 0..classes {
        for (segment, start) in segments.iter().zip(&mut starts) {
            start.slots[class] = slots.len() as u32;
            slots.extend_from_slice(segment.slots.get(class).map_or(&[], Vec::as_slice));
        }
    }
    (starts, slots)
}

impl Weighed<'_> {
    /// The class of the references below a leaf.
    fn class(&self, root: u32) -> usize {
        usize::from(self.references[self.node(root).first as usize].class)
    }

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
        segments.push(Segment { run, is_top, outlines: vec![], slots: vec![] });
        if is_top {
            segments[number].outlines.push(Outline::EMPTY);
            for (place, child) in self.forest(run).places() {
                let what = if self.is_leaf(child) {
                    self.leaf(child, &mut segments[number].slots)
                } else {
                    Child::inner(self.cut(child, segments))
                };
                segments[number].outlines[0].set(place, child, what);
            }
        }
        number as u32
    }

    /// Outlines a segment that is not of the top.
    fn outline(&self, segment: &mut Segment) {
        if segment.is_top {
            return;
        }
        if self.is_leaf(segment.run) {
            let mut lone = Outline::EMPTY;
            lone.set(0, segment.run, self.leaf(segment.run, &mut segment.slots));
            segment.outlines.push(lone);
        } else {
            self.expand(segment.run, segment);
        }
    }

    /// Outlines a node and what is below it, depth first; returns its index.
    fn expand(&self, run: Run, segment: &mut Segment) -> u32 {
        let index = segment.outlines.len();
        segment.outlines.push(Outline::EMPTY);
        for (place, child) in self.forest(run).places() {
            let what = if self.is_leaf(child) {
                self.leaf(child, &mut segment.slots)
            } else {
                Child::inner(self.expand(child, segment))
            };
            segment.outlines[index].set(place, child, what);
        }
        index as u32
    }

    /// Puts a leaf's references into slots, none across blocks.
    fn leaf(&self, run: Run, slots: &mut Vec<Vec<u32>>) -> Child {
        let first = self.node(run.root).first as usize;
        let references = &self.references[first..][..self.choices.of(run.root).leaf_count()];
        let class = usize::from(references[0].class);
        if slots.len() <= class {
            slots.resize(class + 1, vec![]);
        }
        let slots = &mut slots[class];
        let filled = slots.iter().rposition(|&slot| slot != u32::MAX).map_or(0, |last| last + 1);
        let begin =
            if filled % BLOCK + references.len() > BLOCK { filled.next_multiple_of(BLOCK) } else { filled };
        slots.resize((begin + references.len()).next_multiple_of(BLOCK), u32::MAX);
        for (slot, reference) in slots[begin..].iter_mut().zip(references) {
            *slot = reference.index;
        }
        Child::leaf(begin as u32, references.len() as u32)
    }

    /// The roots of the forest that fills a node of eight.
    fn forest(&self, run: Run) -> Forest {
        let mut forest = Forest::default();
        // The node itself is being filled, so it is not its own child.
        let from_left = self.choices.of(run.root).left_trees(8);
        let [left, right] = run.children(self.nodes);
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
        let [left, right] = run.children(self.nodes);
        self.trees(left, from_left, forest);
        self.trees(right, i - from_left, forest);
    }
}
