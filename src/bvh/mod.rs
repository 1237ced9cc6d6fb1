//! A tree of boxes, eight to a node.
//!
//! The tree never names a shape. It is built from boxes that carry a *class*, it puts primitives of one
//! class into *slots*, eight to a block, and it hands ranges of slots to whoever knows what is in them
//! ([`Leaves`]).
//!
//! `build` makes it, by one of three qualities ([`Quality`]). Traversal: tiles of up to 256 rays, packets of
//! eight and of sixteen, thirty-two single rays in turn, one ray that meets a tree within another, or one ray
//! and one box at a time, the reference for the others; closest hit and occlusion from one body each.

mod alone;
mod beam;
mod build;
mod bundle;
mod cost;
mod entry;
mod extent;
mod habit;
mod node;
mod occluder;
mod packet;
mod run;
mod single;
mod stream;
mod tile;
mod validate;
mod wave;

pub use build::{MAX_LEAF, Quality, Reference};
pub use node::{Child, Kind, Node};
pub use stream::{Stream, Tracer, Way};
pub use validate::{Defect, Shape};
use wave::Wave;

use std::hint::select_unpredictable;

use glam::Vec3;

use crate::geometry::{Hit, Pencils, PrimitiveId, Ray, RayLanes, Rayx8, Rayx16};
use crate::simd::{Bits, Groups, LANES, Mask8, Mask16, Real, f32x8, f32x16, prefetch, transpose, u32x8};

/// Slots in a block. A leaf never crosses from one block into the next.
pub const BLOCK: usize = 8;

/// Nodes that fit into a second-level cache with what else is there.
const CACHED: usize = 8192;

/// A tree over boxes.
#[derive(Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    slots: Vec<u32>,
    /// Greatest absolute coordinate along each axis.
    reach: Vec3,
}

/// Hits of a packet. `t` starts as the rays' `t_far`, `primitive` as [`PrimitiveId::NONE`]'s number.
#[derive(Clone, Copy, Debug)]
pub struct HitLanes<R: Real> {
    /// Distances; for an occlusion query −∞ where something was found.
    pub t: R,
    /// Barycentric weights of the second vertices, or as in [`Hit::u`].
    pub u: R,
    /// Barycentric weights of the third vertices.
    pub v: R,
    /// Primitive numbers.
    pub primitive: R::Bits,
}

/// Hits of a packet.
pub type Hitx8 = HitLanes<f32x8>;

/// Hits of two packets side by side.
pub type Hitx16 = HitLanes<f32x16>;

impl<R: Real> HitLanes<R> {
    /// Before anything is hit.
    #[inline]
    fn nothing(t_far: R) -> Self {
        Self { t: t_far, u: R::zero(), v: R::zero(), primitive: R::Bits::splat(PrimitiveId::NONE.0) }
    }
}

impl Hitx8 {
    /// The same, with [`Hit::MISS`] in the lanes that hit nothing or are not active.
    #[inline]
    fn or_miss(&self, active: Mask8) -> Self {
        let hit = active & !self.primitive.equal(u32x8::splat(PrimitiveId::NONE.0));
        let none = Self::nothing(f32x8::splat(f32::INFINITY));
        Self {
            t: f32x8::select(hit, self.t, none.t),
            u: f32x8::select(hit, self.u, none.u),
            v: f32x8::select(hit, self.v, none.v),
            primitive: u32x8::select(hit, self.primitive, none.primitive),
        }
    }

    /// The hits, one by one.
    #[inline]
    fn to_hits(self) -> [Hit; LANES] {
        let id = f32x8::from_bits(self.primitive);
        let rows = transpose([self.t, self.u, self.v, id, self.t, self.u, self.v, id]);
        let hit = |row: f32x8| Hit::of_row(row.half(0));
        // One by one: mapped as an array, the hits would be copied.
        let [a, b, c, d, e, f, g, h] = rows;
        [hit(a), hit(b), hit(c), hit(d), hit(e), hit(f), hit(g), hit(h)]
    }
}

/// What is in the slots: the tree asks it to intersect a leaf's range.
pub trait Leaves {
    /// Eight rays against `count` slots from `first` on: hits that are closer than those in `hit` (or
    /// equal with a lower id) replace them. For `ANY`, one hit within (t_near, `hit.t`] is enough, and
    /// its lanes get t = −∞.
    fn intersect_packet<const ANY: bool>(
        &self,
        first: u32,
        count: u32,
        ray: &Rayx8,
        active: Mask8,
        hit: &mut Hitx8,
    );

    /// The same for sixteen rays.
    fn intersect_bundle<const ANY: bool>(
        &self,
        first: u32,
        count: u32,
        ray: &Rayx16,
        active: Mask16,
        hit: &mut Hitx16,
    );

    /// Sixteen bundles of sixteen rays, of which those in `mask` may hit something, against a leaf's (first slot, count).
    /// `pencils` are around them, if they come from one origin. Returns how many tests of a bundle
    /// against a primitive that took, and which bundles may have found something.
    fn intersect_tile<const ANY: bool>(
        &self,
        leaf: (u32, u32),
        rays: &[&Rayx16; 16],
        pencils: Option<&Pencils>,
        mask: u32,
        hits: &mut [Hitx16; 16],
    ) -> (u32, u32);

    /// Where the data of a slot's block begin, to be asked for ahead of time.
    fn address(&self, slot: u32) -> *const u8;

    /// Rays that each have a group of lanes, and there the primitives of a leaf that begins at a slot: where a group has
    /// four lanes, a leaf of up to four. More than the leaf may be tested. The rays' `t_far` are those of `hits`. False, and nothing
    /// has been done, if a leaf is not of triangles or rounding might decide: then each is to be
    /// [asked for](Self::intersect_alone).
    fn intersect_blocks<const ANY: bool, const N: usize, R: Groups<N>>(
        &self,
        slots: [u32; N],
        rays: RayLanes<R>,
        hits: [&mut Hit; N],
    ) -> bool;

    /// One ray, in all lanes, against a leaf's (first slot, count). Returns how many blocks' time that took.
    fn intersect_alone<const ANY: bool>(&self, leaf: (u32, u32), ray: &Rayx8, hit: &mut Hit) -> u32;

    /// One ray, from the scalar kernels.
    fn intersect_single<const ANY: bool>(&self, first: u32, count: u32, ray: &Ray, hit: &mut Hit);
}

/// Counts what a traversal does; `()` counts nothing and costs nothing.
pub trait Tally {
    /// A node's children were tested by this many rays.
    fn node(&mut self, rays: u32);
    /// A leaf of this many primitives was tested by this many rays.
    fn leaf(&mut self, primitives: u32, rays: u32);
}

impl Tally for () {
    #[inline]
    fn node(&mut self, _: u32) {}
    #[inline]
    fn leaf(&mut self, _: u32, _: u32) {}
}

/// Deeper than any tree: splits are limited in depth (see `build`), and seven siblings wait at each
/// level.
const STACK: usize = 640;

/// What a traversal needs beside the tree, kept from ray to ray so that it is set up once.
#[derive(Debug)]
pub struct Traversal<T = ()> {
    stack: Box<[(Child, f32); STACK]>,
    /// The leaf that blocked a ray last.
    blocker: Child,
    /// What has been counted.
    pub tally: T,
}

impl<T> Traversal<T> {
    /// An empty stack.
    pub fn new(tally: T) -> Self {
        Self { stack: Box::new([(Child::ABSENT, 0.0); STACK]), blocker: Child::ABSENT, tally }
    }
}

impl Bvh {
    /// Do the nodes fill more than a second-level cache?
    #[inline]
    fn is_far(&self) -> bool {
        self.nodes.len() >= CACHED
    }

    /// Asks memory for what is behind a child, while there is something else to do. An address is chosen, not a
    /// branch.
    #[inline]
    fn ask_for<L: Leaves>(&self, child: Child, leaves: &L) {
        let node = self.nodes.as_ptr().wrapping_add(child.index()).cast();
        let address = select_unpredictable(child.is_leaf_or_absent(), leaves.address(child.slot()), node);
        prefetch::<5>(address);
    }

    /// The nodes; the root is the first. Empty if there is nothing to hit.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Greatest absolute coordinate of any box, along each axis.
    fn reach(&self) -> Vec3 {
        self.reach
    }

    /// For each slot the number of the reference in it, [`u32::MAX`] where it is padding. A whole number
    /// of blocks; blocks of one class stand together, classes in ascending order.
    pub fn slots(&self) -> &[u32] {
        &self.slots
    }

    /// Gives the slots away, as tracing needs no numbers of references: from then on there are none.
    pub(crate) fn take_slots(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.slots)
    }
}
