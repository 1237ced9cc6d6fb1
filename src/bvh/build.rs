//! Binned SAH: references to a binary tree \[Wal07\].
//!
//! A node with n references owns a run of 2n − 1 places in the array of nodes, its own first, then its
//! left child's run, then its right child's. Threads so write to disjoint slices, and the tree does not
//! depend on how many there are.

use glam::Vec3;

use crate::geometry::Aabb;

/// References in a leaf, at most.
pub const MAX_LEAF: usize = 4;
const BINS: usize = 16;
/// Subtrees of fewer references are built by one thread.
const PARALLEL: usize = 4096;
/// Beyond this depth splits are by count alone, so that no input can make a deep tree.
const SAH_DEPTH: u32 = 48;

/// A primitive, as the builder sees it.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// Its box; finite.
    pub bounds: Aabb,
    /// Its number, handed back in [`Bvh::slots`](super::Bvh::slots).
    pub index: u32,
    /// Leaves hold references of one class.
    pub class: u8,
}

/// A node of the binary tree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    pub(super) bounds: Aabb,
    /// First of its references.
    pub(super) first: u32,
    /// References below it.
    pub(super) count: u32,
    /// Distance to the right child's place, 0 for a leaf; the left child stands next.
    pub(super) right: u32,
}

impl Binary {
    const NONE: Self = Self { bounds: Aabb::EMPTY, first: 0, count: 0, right: 0 };

    pub(super) fn is_leaf(&self) -> bool {
        self.right == 0
    }
}

/// Builds the tree and reorders the references into leaf order. Not for an empty slice.
pub(super) fn build(references: &mut [Reference]) -> Vec<Binary> {
    let mut nodes = vec![Binary::NONE; 2 * references.len() - 1];
    subtree(references, 0, &mut nodes, 0);
    nodes
}

fn subtree(references: &mut [Reference], first: u32, nodes: &mut [Binary], depth: u32) {
    let count = references.len();
    let extent = Extent::of(references);
    nodes[0] = Binary { bounds: extent.bounds, first, count: count as u32, right: 0 };
    let Some(left_count) = split(references, &extent, depth) else {
        return;
    };
    let right = 2 * left_count;
    nodes[0].right = right as u32;
    let (left_nodes, right_nodes) = nodes[1..].split_at_mut(right - 1);
    let (left, rest) = references.split_at_mut(left_count);
    let mut left_build = || subtree(left, first, left_nodes, depth + 1);
    let middle = first + left_count as u32;
    if count < PARALLEL {
        left_build();
        subtree(rest, middle, right_nodes, depth + 1);
    } else {
        rayon::join(left_build, || subtree(rest, middle, right_nodes, depth + 1));
    }
}

/// Bounds of the boxes and of their centres.
struct Extent {
    bounds: Aabb,
    centres: Aabb,
}

impl Extent {
    fn of(references: &[Reference]) -> Self {
        let mut extent = Self { bounds: Aabb::EMPTY, centres: Aabb::EMPTY };
        for reference in references {
            extent.bounds = extent.bounds.union(reference.bounds);
            let centre = reference.bounds.centre();
            extent.centres = extent.centres.union(Aabb { min: centre, max: centre });
        }
        extent
    }
}

/// Partitions the references and returns how many go left; `None` for a leaf.
fn split(references: &mut [Reference], extent: &Extent, depth: u32) -> Option<usize> {
    let count = references.len();
    let mixed = references.iter().any(|r| r.class != references[0].class);
    if count <= MAX_LEAF && mixed {
        let class = references[0].class;
        return Some(partition(references, |r| r.class == class));
    }
    let best = if depth < SAH_DEPTH { best_plane(references, extent) } else { None };
    if count <= MAX_LEAF {
        // A leaf costs a test for each primitive; a split costs a node.
        let leaf_cost = count as f32 * extent.bounds.half_area();
        let split_cost = best.as_ref().map_or(f32::INFINITY, |plane| plane.cost);
        if count == 1 || leaf_cost <= split_cost + extent.bounds.half_area() {
            return None;
        }
    }
    let left = best.map(|plane| partition(references, |r| plane.is_left(r)));
    // Equal centres, or planes that separate nothing: halves in the given order.
    Some(left.filter(|&left| left != 0 && left != count).unwrap_or(count / 2))
}

/// A plane between bins along an axis.
struct Plane {
    axis: usize,
    origin: f32,
    scale: f32,
    bin: usize,
    /// Half area × count, left plus right.
    cost: f32,
}

impl Plane {
    fn is_left(&self, reference: &Reference) -> bool {
        bin(reference.bounds.centre()[self.axis], self.origin, self.scale) <= self.bin
    }
}

#[inline]
fn bin(centre: f32, origin: f32, scale: f32) -> usize {
    (((centre - origin) * scale) as usize).min(BINS - 1)
}

fn best_plane(references: &[Reference], extent: &Extent) -> Option<Plane> {
    let origin = extent.centres.min;
    let size = extent.centres.max - origin;
    let scale = Vec3::splat(BINS as f32) / size;
    // A size of zero, or so small that its reciprocal overflows, separates nothing.
    let usable = [0, 1, 2].map(|axis| size[axis] > 0.0 && scale[axis].is_finite());
    let mut bins = [[(Aabb::EMPTY, 0u32); BINS]; 3];
    for reference in references {
        let centre = reference.bounds.centre();
        for axis in 0..3 {
            if usable[axis] {
                let entry = &mut bins[axis][bin(centre[axis], origin[axis], scale[axis])];
                entry.0 = entry.0.union(reference.bounds);
                entry.1 += 1;
            }
        }
    }
    let mut best: Option<Plane> = None;
    for axis in (0..3).filter(|&axis| usable[axis]) {
        let mut right_cost = [0.0; BINS];
        let (mut bounds, mut count) = (Aabb::EMPTY, 0);
        for (i, bin) in bins[axis].iter().enumerate().skip(1).rev() {
            (bounds, count) = (bounds.union(bin.0), count + bin.1);
            right_cost[i - 1] = bounds.half_area() * count as f32;
        }
        (bounds, count) = (Aabb::EMPTY, 0);
        for (i, entry) in bins[axis].iter().enumerate().take(BINS - 1) {
            (bounds, count) = (bounds.union(entry.0), count + entry.1);
            let cost = bounds.half_area() * count as f32 + right_cost[i];
            let separates = count > 0 && (count as usize) < references.len();
            if separates && best.as_ref().is_none_or(|plane| cost < plane.cost) {
                best = Some(Plane { axis, origin: origin[axis], scale: scale[axis], bin: i, cost });
            }
        }
    }
    best
}

/// Moves the references that satisfy `left` to the front, in place; returns how many.
fn partition(references: &mut [Reference], left: impl Fn(&Reference) -> bool) -> usize {
    let (mut low, mut high) = (0, references.len());
    loop {
        while low < high && left(&references[low]) {
            low += 1;
        }
        while low < high && !left(&references[high - 1]) {
            high -= 1;
        }
        if low >= high {
            return low;
        }
        references.swap(low, high - 1);
    }
}
