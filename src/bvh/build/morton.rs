//! A binary tree along the Morton curve \[LGS09\]: quick to build, dearer to trace.
//!
//! Centres are rounded to a grid of 4096³ cells and sorted along the curve through it; where the codes
//! of a run first differ in a bit, the run is split. The last sixteen references are split by SAH, as
//! in the better qualities ([`sweep`](super::sweep)).

use glam::Vec3A;
use rayon::prelude::*;

use super::{
    binary::{self, Binary, Packed},
    binned::{self, PARALLEL},
    bounds::Bounds,
    reference::Reference,
    sweep::{self, SMALL},
};

/// Bits of a cell's number along an axis.
const BITS: u32 = 12;
/// Bits of a key below the code: the reference's number.
const NUMBER: u32 = 64 - 3 * BITS;

/// Builds the tree and puts the references into leaf order. Not for an empty slice.
pub(super) fn build(references: &mut Vec<Reference>) -> Vec<Packed> {
    let [_, centres] = binned::extents(references);
    let size = (centres.max() - centres.min()).max(Vec3A::splat(f32::MIN_POSITIVE));
    // Below 1 whatever the rounding; divided, as the reciprocal of a small size overflows.
    let cell = |reference: &Reference| {
        let place = (reference.bounds().centre() - centres.min()) / size;
        (place * ((1 << BITS) - 1) as f32).to_array().map(|x| x as u64)
    };
    let key = |(i, reference): (usize, &Reference)| {
        let [x, y, z] = cell(reference).map(spread);
        (x << 2 | y << 1 | z) << NUMBER | i as u64
    };
    let mut keys: Vec<u64> = references.par_iter().enumerate().map(key).collect();
    keys.par_sort_unstable();
    let number = |key: u64| (key & ((1 << NUMBER) - 1)) as usize;
    *references = keys.par_iter().map(|&key| references[number(key)]).collect();
    let mut nodes = binary::places(references.len());
    subtree(&keys, references, 0, &mut nodes);
    nodes
}

/// Each bit followed by two zeros.
fn spread(x: u64) -> u64 {
    (0..BITS).fold(0, |spread, bit| spread | (x >> bit & 1) << (3 * bit))
}

/// Returns the bounds and how many places were taken, as [`build`](super::build) does.
fn subtree(keys: &[u64], references: &mut [Reference], first: u32, nodes: &mut [Packed]) -> (Bounds, usize) {
    let count = keys.len();
    if count <= SMALL {
        let bounds = references.iter().fold(Bounds::EMPTY, |a, reference| a.union(reference.bounds()));
        return (bounds, sweep::subtree(references, bounds, first, nodes));
    }
    let differing = (keys[0] ^ keys[count - 1]) >> NUMBER;
    let left_count = match differing.checked_ilog2() {
        Some(bit) => keys.partition_point(|key| key >> (NUMBER + bit) & 1 == 0),
        None => count / 2,
    };
    let (left_keys, right_keys) = keys.split_at(left_count);
    let (left_references, right_references) = references.split_at_mut(left_count);
    let middle = first + left_count as u32;
    if count < PARALLEL {
        let (left, taken) = subtree(left_keys, left_references, first, &mut nodes[1..]);
        let right_at = 1 + taken;
        let (right, taken) = subtree(right_keys, right_references, middle, &mut nodes[right_at..]);
        let bounds = left.union(right);
        nodes[0] = Binary::inner(bounds, first, right_at).pack();
        return (bounds, right_at + taken);
    }
    let (root, rest) = nodes.split_first_mut().expect("a node has a place");
    let (left_nodes, right_nodes) = rest.split_at_mut(2 * left_count - 1);
    let ((left, _), (right, _)) = rayon::join(
        || subtree(left_keys, left_references, first, left_nodes),
        || subtree(right_keys, right_references, middle, right_nodes),
    );
    let bounds = left.union(right);
    *root = Binary::inner(bounds, first, 2 * left_count).pack();
    (bounds, 2 * count - 1)
}
