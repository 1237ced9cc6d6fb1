//! Binned SAH: references to a binary tree \[Wal07\].
//!
//! A node with n references owns a run of 2n − 1 places in the array of nodes, its own first, then its
//! left child's run, then its right child's. Threads so write to disjoint slices, and the tree does not
//! depend on how many there are.

use glam::Vec3A;
use rayon::prelude::*;

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

/// Builds the tree and puts the references into leaf order. Not for an empty slice.
pub(super) fn build(references: &mut Vec<Reference>) -> Vec<Binary> {
    let mut entries: Vec<Entry> = references.par_iter().map(Entry::new).collect();
    let mut nodes = vec![Binary::NONE; 2 * entries.len() - 1];
    subtree(&mut entries, 0, &mut nodes, 0);
    entries.par_iter().map(Entry::reference).collect_into_vec(references);
    nodes
}

/// A box whose corners are registers: a union is two instructions.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    min: Vec3A,
    max: Vec3A,
}

impl Bounds {
    const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    #[inline]
    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    #[inline]
    fn half_area(self) -> f32 {
        let d = (self.max - self.min).max(Vec3A::ZERO);
        d.x * (d.y + d.z) + d.y * d.z
    }

    #[inline]
    fn centre(self) -> Vec3A {
        self.min * 0.5 + self.max * 0.5
    }

    fn aabb(self) -> Aabb {
        Aabb { min: self.min.into(), max: self.max.into() }
    }
}

/// A reference on its way through the build.
#[derive(Clone, Copy, Debug)]
struct Entry {
    bounds: Bounds,
    index: u32,
    class: u8,
}

impl Entry {
    fn new(reference: &Reference) -> Self {
        let Aabb { min, max } = reference.bounds;
        let bounds = Bounds { min: min.into(), max: max.into() };
        Self { bounds, index: reference.index, class: reference.class }
    }

    fn reference(&self) -> Reference {
        Reference { bounds: self.bounds.aabb(), index: self.index, class: self.class }
    }
}

fn subtree(entries: &mut [Entry], first: u32, nodes: &mut [Binary], depth: u32) {
    let count = entries.len();
    let extent = Extent::of(entries);
    nodes[0] = Binary { bounds: extent.bounds.aabb(), first, count: count as u32, right: 0 };
    let Some(left_count) = split(entries, &extent, depth) else {
        return;
    };
    let right = 2 * left_count;
    nodes[0].right = right as u32;
    let (left_nodes, right_nodes) = nodes[1..].split_at_mut(right - 1);
    let (left, rest) = entries.split_at_mut(left_count);
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
    bounds: Bounds,
    centres: Bounds,
    mixed: bool,
}

impl Extent {
    fn of(entries: &[Entry]) -> Self {
        let class = entries[0].class;
        let mut extent = Self { bounds: Bounds::EMPTY, centres: Bounds::EMPTY, mixed: false };
        for entry in entries {
            let centre = entry.bounds.centre();
            extent.bounds = extent.bounds.union(entry.bounds);
            extent.centres = extent.centres.union(Bounds { min: centre, max: centre });
            extent.mixed |= entry.class != class;
        }
        extent
    }
}

/// Partitions the entries and returns how many go left; `None` for a leaf.
fn split(entries: &mut [Entry], extent: &Extent, depth: u32) -> Option<usize> {
    let count = entries.len();
    if count <= MAX_LEAF && extent.mixed {
        let class = entries[0].class;
        return Some(partition(entries, |entry| entry.class == class));
    }
    let best = if depth < SAH_DEPTH { best_plane(entries, extent) } else { None };
    if count <= MAX_LEAF {
        // A leaf costs a test for each primitive; a split costs a node.
        let leaf_cost = count as f32 * extent.bounds.half_area();
        let split_cost = best.as_ref().map_or(f32::INFINITY, |plane| plane.cost);
        if count == 1 || leaf_cost <= split_cost + extent.bounds.half_area() {
            return None;
        }
    }
    let left = best.map(|plane| partition(entries, |entry| plane.is_left(entry)));
    // Equal centres, or planes that separate nothing: halves in the given order.
    Some(left.filter(|&left| left != 0 && left != count).unwrap_or(count / 2))
}

/// A plane between bins along an axis.
struct Plane {
    axis: usize,
    bins: Bins,
    bin: usize,
    /// Half area × count, left plus right.
    cost: f32,
}

impl Plane {
    fn is_left(&self, entry: &Entry) -> bool {
        self.bins.of(entry)[self.axis] <= self.bin
    }
}

/// Where bins lie: from `origin` on, `scale` to a unit, along each axis.
#[derive(Clone, Copy)]
struct Bins {
    origin: Vec3A,
    scale: Vec3A,
}

impl Bins {
    #[inline]
    fn of(&self, entry: &Entry) -> [usize; 3] {
        let place = (entry.bounds.centre() - self.origin) * self.scale;
        place.to_array().map(|x| (x as usize).min(BINS - 1))
    }
}

fn best_plane(entries: &[Entry], extent: &Extent) -> Option<Plane> {
    let origin = extent.centres.min;
    let size = extent.centres.max - origin;
    let scale = Vec3A::splat(BINS as f32) / size;
    // A size of zero, or so small that its reciprocal overflows, separates nothing: all in the first bin.
    let usable = [0, 1, 2].map(|axis| size[axis] > 0.0 && scale[axis].is_finite());
    let scale = Vec3A::from_array(std::array::from_fn(|axis| if usable[axis] { scale[axis] } else { 0.0 }));
    let bins = Bins { origin, scale };
    let mut filled = [[(Bounds::EMPTY, 0u32); BINS]; 3];
    for entry in entries {
        let places = bins.of(entry);
        for axis in 0..3 {
            let place = &mut filled[axis][places[axis]];
            place.0 = place.0.union(entry.bounds);
            place.1 += 1;
        }
    }
    let mut best: Option<Plane> = None;
    for axis in (0..3).filter(|&axis| usable[axis]) {
        let mut right_cost = [0.0; BINS];
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for (i, place) in filled[axis].iter().enumerate().skip(1).rev() {
            (bounds, count) = (bounds.union(place.0), count + place.1);
            right_cost[i - 1] = bounds.half_area() * count as f32;
        }
        (bounds, count) = (Bounds::EMPTY, 0);
        for (i, place) in filled[axis].iter().enumerate().take(BINS - 1) {
            (bounds, count) = (bounds.union(place.0), count + place.1);
            let cost = bounds.half_area() * count as f32 + right_cost[i];
            let separates = count > 0 && (count as usize) < entries.len();
            if separates && best.as_ref().is_none_or(|plane| cost < plane.cost) {
                best = Some(Plane { axis, bins, bin: i, cost });
            }
        }
    }
    best
}

/// Moves the entries that satisfy `left` to the front, in place; returns how many.
fn partition(entries: &mut [Entry], left: impl Fn(&Entry) -> bool) -> usize {
    let (mut low, mut high) = (0, entries.len());
    loop {
        while low < high && left(&entries[low]) {
            low += 1;
        }
        while low < high && !left(&entries[high - 1]) {
            high -= 1;
        }
        if low >= high {
            return low;
        }
        entries.swap(low, high - 1);
    }
}
