//! Many single rays in turn: for rays that have nothing in common.
//!
//! One ray through a tree is a chain of dependent steps, each of which waits for the last: the load of a
//! node, eight slab tests, the choice of a child. Sixteen rays that take the same step in turn, without a
//! branch that depends on data, keep the processor busy with one while another waits.
//!
//! ```text
//! node pass   each slot at an inner node: 1 ray × 8 boxes, hit children sorted onto the slot's stack,
//!             the nearest popped; by arithmetic the slot goes to the list of nodes or of leaves
//! leaf pass   each slot at a leaf: 1 ray × a block of 8 primitives; pop what is still near enough;
//!             an empty stack writes the answer and takes the next ray
//! ```
//!
//! Boxes are tested as bound·rdir − org·rdir, one fused operation where there is one. Its rounding errs by
//! ulps of |org·rdir| and not of the result, so the interval is widened by a bound on that
//! ([`MARGIN`]): it holds the interval of [`aabb`](crate::geometry::aabb), and nothing that the kernels
//! would hit is culled. A direction component below 10⁻¹⁸ counts as that; the margin then covers every t.

use std::ops::Range;

use super::{Bvh, Child, Kind, Leaves, Node, STACK, Stream, Tally};
use crate::geometry::{Hit, Ray};
use crate::simd::{Bits, Mask, Real, f32x8, prefetch, sort_descending, u32x8};

/// Rays in turn: fewer leave latency open, more leave the first-level cache.
const SLOTS: usize = 16;
/// Ulps of |rdir|·(|org| + |bound|) by which slabs are widened: 3 for the fused form and its constant, 12
/// for the widening and the rounding of the kernels' own test.
const MARGIN: f32 = 8.0 * f32::EPSILON;
/// Greatest magnitude of a reciprocal direction in box tests.
const STEEPEST: f32 = 1e18;

/// A ray on its way.
struct Slot {
    /// 1/dir, within [`STEEPEST`].
    inv: [f32; 3],
    /// What is added to near and far bounds times `inv`.
    near_shift: [f32; 3],
    far_shift: [f32; 3],
    /// Rows of [`Node::bounds`] that the ray meets first.
    near_rows: [usize; 3],
    child: Child,
    top: usize,
    hit: Hit,
    ray: Ray,
    index: usize,
    /// Distances and children that wait, nearest last. The lowest entry is the end of the ray.
    keys: [u32; STACK + 8],
    children: [u32; STACK + 8],
}

/// Slots and lists of a wave, kept from stream to stream.
pub(super) struct Wave {
    slots: Vec<Slot>,
}

impl Default for Wave {
    fn default() -> Self {
        Self { slots: (0..SLOTS).map(|_| Slot::new()).collect() }
    }
}

impl Slot {
    fn new() -> Self {
        Self {
            inv: [0.0; 3],
            near_shift: [0.0; 3],
            far_shift: [0.0; 3],
            near_rows: [0; 3],
            child: Child::ABSENT,
            top: 0,
            hit: Hit::MISS,
            ray: Ray::new(glam::Vec3::ZERO, glam::Vec3::ONE, 0.0, 0.0),
            index: 0,
            keys: [0; STACK + 8],
            children: [Child::ABSENT.word(); STACK + 8],
        }
    }

    fn start(&mut self, ray: &Ray, index: usize, reach: glam::Vec3) {
        for axis in 0..3 {
            let inv = ray.rdir[axis].clamp(-STEEPEST, STEEPEST);
            let margin = MARGIN * inv.abs() * (ray.org[axis].abs() + reach[axis]);
            let shift = -(ray.org[axis] * inv);
            self.inv[axis] = inv;
            self.near_shift[axis] = shift - margin;
            self.far_shift[axis] = shift + margin;
            self.near_rows[axis] = if inv < 0.0 { axis + 3 } else { axis };
        }
        self.ray = *ray;
        self.hit = Hit { t: ray.t_far, ..Hit::MISS };
        self.index = index;
        self.child = Child::inner(0);
        self.top = 1;
    }

    /// Tests the boxes of a node and moves to the nearest child, or to what waits.
    #[inline]
    fn step(&mut self, node: &Node) {
        let mut low = f32x8::splat(self.ray.t_near.max(0.0));
        let mut high = f32x8::splat(self.hit.t);
        for axis in 0..3 {
            let near = self.near_rows[axis];
            let far = if near < 3 { near + 3 } else { near - 3 };
            let inv = f32x8::splat(self.inv[axis]);
            let near = f32x8::from(node.bounds[near]).fused(inv, f32x8::splat(self.near_shift[axis]));
            let far = f32x8::from(node.bounds[far]).fused(inv, f32x8::splat(self.far_shift[axis]));
            low = near.max(low);
            high = far.min(high);
        }
        let enters = low.le(high);
        // A key is a distance, rounded down, and the child it belongs to; 8 keeps it apart from a miss.
        let keys = (low.to_bits() & u32x8::splat(!7)) | u32x8::new([8, 9, 10, 11, 12, 13, 14, 15]);
        let keys = sort_descending(u32x8::select(enters, keys, u32x8::splat(0)));
        let children = u32x8::new(node.children.map(Child::word)).shuffle(keys & u32x8::splat(7));
        let top = self.top;
        self.keys[top..top + 8].copy_from_slice(&keys.to_array());
        self.children[top..top + 8].copy_from_slice(&children.to_array());
        self.top = top + enters.to_bitmask().count_ones() as usize - 1;
        self.child = Child::from_word(self.children[self.top]);
    }

    /// Moves to the nearest child that waits and is near enough.
    #[inline]
    fn pop(&mut self) {
        loop {
            self.top -= 1;
            // The end of the ray has key 0.
            if f32::from_bits(self.keys[self.top] & !15) <= self.hit.t || self.top == 0 {
                self.child = Child::from_word(self.children[self.top]);
                return;
            }
        }
    }
}

impl Bvh {
    /// Traces some rays of a stream, in turn.
    pub(super) fn intersect_wave<const ANY: bool, L: Leaves, S: Stream, T: Tally>(
        &self,
        leaves: &L,
        stream: &mut S,
        range: Range<usize>,
        wave: &mut Wave,
        tally: &mut T,
    ) {
        let reach = self.reach();
        let mut next = range.start;
        let mut refill = |slot: &mut Slot, stream: &mut S| -> bool {
            while next < range.end {
                let index = next;
                next += 1;
                match stream.ray(index).filter(|_| !self.nodes.is_empty()) {
                    Some(ray) => {
                        slot.start(&ray, index, reach);
                        return true;
                    }
                    None => stream.answer(index, &Hit::MISS),
                }
            }
            false
        };
        let (mut at_node, mut at_leaf) = ([0usize; SLOTS], [0usize; SLOTS]);
        let mut nodes = 0;
        for slot in 0..SLOTS {
            if refill(&mut wave.slots[slot], stream) {
                at_node[nodes] = slot;
                nodes += 1;
            }
        }
        let mut leaves_waiting = 0;
        while nodes + leaves_waiting > 0 {
            let mut still = 0;
            for i in 0..nodes {
                let which = at_node[i];
                let slot = &mut wave.slots[which];
                tally.node(1);
                slot.step(&self.nodes[slot.child.index()]);
                let leaf = usize::from(slot.child.is_leaf_or_absent());
                ask_for(slot.child, &self.nodes, leaves);
                at_node[still] = which;
                at_leaf[leaves_waiting] = which;
                still += 1 - leaf;
                leaves_waiting += leaf;
            }
            nodes = still;
            let mut waiting = 0;
            for i in 0..leaves_waiting {
                let which = at_leaf[i];
                let slot = &mut wave.slots[which];
                let mut done = slot.child == Child::ABSENT;
                if let Kind::Leaf { first, count } = slot.child.kind() {
                    tally.leaf(count, 1);
                    leaves.intersect_block::<ANY>(first, count, &slot.ray, &mut slot.hit);
                    done = ANY && slot.hit.t == f32::NEG_INFINITY;
                    if !done {
                        slot.pop();
                    }
                }
                if done || slot.child == Child::ABSENT {
                    stream.answer(slot.index, &slot.hit.settle::<ANY>());
                    if !refill(slot, stream) {
                        continue;
                    }
                }
                ask_for(slot.child, &self.nodes, leaves);
                let leaf = usize::from(slot.child.is_leaf_or_absent());
                at_node[nodes] = which;
                at_leaf[waiting] = which;
                nodes += 1 - leaf;
                waiting += leaf;
            }
            leaves_waiting = waiting;
        }
    }
}

/// Asks for a node or a block while other slots take their turn. An address is chosen, not a branch.
#[inline]
fn ask_for<L: Leaves>(child: Child, nodes: &[Node], leaves: &L) {
    let node = nodes.as_ptr().wrapping_add(child.index()).cast();
    let address = if child.is_leaf_or_absent() { leaves.address(child.slot()) } else { node };
    prefetch::<5>(address);
}
