//! References to a binary tree by binned SAH \[Wal07\], top down.

use rayon::prelude::*;

use super::{
    binary::{self, Binary, Packed},
    bins::{self, CHUNK, Plane},
    bounds::Bounds,
    partition::{self, Centres},
    reference::Reference,
    sweep::{self, SMALL},
};

/// References in a leaf, at most: those of a block.
pub const MAX_LEAF: usize = 8;
/// Subtrees of fewer references are built by one thread.
pub(super) const PARALLEL: usize = 2048;
/// Beyond this depth splits are by count alone, so that no input can make a deep tree.
pub(super) const SAH_DEPTH: u32 = 48;

/// Builds the tree and puts the references into leaf order. Not for an empty slice.
pub(super) fn build(references: &mut [Reference]) -> Vec<Packed> {
    let mut nodes = binary::places(references.len());
    let [bounds, centres] = extents(references);
    subtree(references, Extent { bounds, centres, first: 0, depth: 0 }, &mut nodes);
    nodes
}

/// Builds a subtree by count alone, as shallow as there is, and returns how many places it took.
pub(super) fn halves(references: &mut [Reference], first: u32, nodes: &mut [Packed]) -> usize {
    let [bounds, centres] = extents(references);
    subtree(references, Extent { bounds, centres, first, depth: SAH_DEPTH }, nodes)
}

/// Bounds of the boxes and of their centres.
pub(super) fn extents(references: &[Reference]) -> [Bounds; 2] {
    let both = |a: [Bounds; 2], b: [Bounds; 2]| [a[0].union(b[0]), a[1].union(b[1])];
    let chunks = references.par_chunks(CHUNK).map(|chunk| {
        chunk.iter().fold([Bounds::EMPTY; 2], |all, reference| {
            reference.ask_for_later();
            let bounds = reference.bounds();
            both(all, [bounds, bounds.shrunk()])
        })
    });
    chunks.reduce(|| [Bounds::EMPTY; 2], both)
}

/// What is known of a subtree's references before it is built.
#[derive(Clone, Copy)]
struct Extent {
    bounds: Bounds,
    centres: Bounds,
    first: u32,
    depth: u32,
}

/// Builds the subtree over some references and returns how many places it took: all of them, the last
/// of which may be unused, or where one thread builds, no more than it has nodes.
fn subtree(references: &mut [Reference], extent: Extent, nodes: &mut [Packed]) -> usize {
    let count = references.len();
    let Extent { bounds, first, depth, .. } = extent;
    if count <= SMALL && depth < SAH_DEPTH {
        return sweep::subtree(references, bounds, first, nodes);
    }
    let Some((left, right, left_count)) = split(references, &extent) else {
        nodes[0] = Binary::leaf(bounds, first, count).pack();
        return 1;
    };
    let (left_references, right_references) = references.split_at_mut(left_count);
    if count < PARALLEL {
        let right_at = 1 + subtree(left_references, left, &mut nodes[1..]);
        nodes[0] = Binary::inner(bounds, first, right_at).pack();
        return right_at + subtree(right_references, right, &mut nodes[right_at..]);
    }
    let right_at = 2 * left_count;
    nodes[0] = Binary::inner(bounds, first, right_at).pack();
    let (left_nodes, right_nodes) = nodes[1..].split_at_mut(right_at - 1);
    rayon::join(
        || subtree(left_references, left, left_nodes),
        || subtree(right_references, right, right_nodes),
    );
    2 * count - 1
}

/// Partitions the references; `None` for a leaf.
fn split(references: &mut [Reference], extent: &Extent) -> Option<(Extent, Extent, usize)> {
    let count = references.len();
    let shallow = extent.depth < SAH_DEPTH;
    if let Some(plane) = shallow.then(|| bins::cheapest_plane(references, extent.centres)).flatten() {
        let centres = partition::partition(references, &plane);
        return Some(children(extent, &plane, centres));
    }
    // Equal centres, or too deep: halves in the given order, classes apart in the end.
    let mut left_count = count / 2;
    if count <= MAX_LEAF {
        references.sort_by_key(Reference::class);
        left_count = references.partition_point(|reference| reference.class() == references[0].class());
        if left_count == count {
            return None;
        }
    }
    let (left, right) = references.split_at(left_count);
    let child = |references: &[Reference], first: u32| {
        let [bounds, centres] = extents(references);
        Extent { bounds, centres, first, depth: extent.depth + 1 }
    };
    Some((child(left, extent.first), child(right, extent.first + left_count as u32), left_count))
}

fn children(extent: &Extent, plane: &Plane, centres: Centres) -> (Extent, Extent, usize) {
    let child = |bounds, centres, first| Extent { bounds, centres, first, depth: extent.depth + 1 };
    let left_count = plane.left_count;
    (
        child(plane.left, centres[0], extent.first),
        child(plane.right, centres[1], extent.first + left_count as u32),
        left_count,
    )
}
