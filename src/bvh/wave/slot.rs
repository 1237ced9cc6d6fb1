//! A ray on its way.

use super::feed::Ready;
use crate::bvh::{Child, Leaves, Node, STACK};
use crate::geometry::{Hit, PrimitiveId};
use crate::simd::{Bits, Groups, Mask, Real, compress, f32x8, sort_descending, u32x8};

/// The ray, what it has found, and what waits for it. All but what waits fills two cache lines.
#[repr(C, align(64))]
pub(super) struct Slot {
    ray: Ready,
    /// The nearest hit so far; its t starts as the end of the ray.
    pub(super) hit: Hit,
    pub(super) child: Child,
    top: u32,
    /// Distances of the children that wait, rounded down, nearest last, from the eighth on; not kept for
    /// occlusion.
    keys: [u32; STACK + 16],
    /// The children. The lowest entry is the end of the ray.
    children: [u32; STACK + 8],
}

/// Which of a node's boxes a ray enters, and where.
#[derive(Clone, Copy)]
pub(super) struct Met {
    low: f32x8,
    enters: u32,
}

/// Bits of a key that say which of a node's children it belongs to.
const PLACE: u32 = 7;

impl Slot {
    pub(super) fn new() -> Self {
        Self {
            ray: Ready::NOTHING,
            hit: Hit::MISS,
            child: Child::ABSENT,
            top: 0,
            keys: [0; STACK + 16],
            children: [Child::ABSENT.word(); STACK + 8],
        }
    }

    /// Place of the ray in its stream.
    #[inline]
    pub(super) fn index(&self) -> usize {
        self.ray.index()
    }

    /// Takes a ray to the root.
    #[inline]
    pub(super) fn start(&mut self, ray: &Ready) {
        self.ray = *ray;
        self.hit = Hit { t: ray.t_far(), ..Hit::MISS };
        self.child = Child::inner(0);
        self.top = 1;
    }

    /// Takes an occlusion ray to those of a node's children that are in a set, which is not empty.
    #[inline]
    pub(super) fn start_below(&mut self, ray: &Ready, node: &Node, entered: u8) {
        self.start(ray);
        self.children[1..9].copy_from_slice(&compress(node.words(), entered).to_array());
        self.top = entered.count_ones();
        self.child = Child::from_word(self.children[self.top as usize]);
    }

    /// Tests the boxes of a node.
    #[inline(always)]
    pub(super) fn meet(&self, node: &Node) -> Met {
        let mut low = f32x8::splat(self.ray.t_near());
        let mut high = f32x8::splat(self.hit.t);
        for axis in 0..3 {
            // The lesser and the greater of both products need no sign, but minima and maxima are for the busiest units.
            let slab = self.ray.slab(axis);
            let inv = f32x8::splat(slab.inv);
            let near = node.plane(axis, slab.near).fused(inv, f32x8::splat(slab.near_shift));
            let far = node.plane(axis, slab.far).fused(inv, f32x8::splat(slab.far_shift));
            // In this order: NaN, where there is no child and the margin leaves all the room, has to stay.
            low = low.max(near);
            high = high.min(far);
        }
        Met { low, enters: low.le(high).to_bitmask() }
    }

    /// Moves to the nearest of the node's children that the ray enters, or to what waits.
    #[inline(always)]
    pub(super) fn enter<const ANY: bool>(&mut self, node: &Node, Met { low, enters }: Met) {
        let count = enters.count_ones();
        let top = self.top as usize;
        let children = if ANY {
            compress(node.words(), enters as u8)
        } else {
            let keys = (low.to_bits() & u32x8::splat(!PLACE)) | u32x8::new([0, 1, 2, 3, 4, 5, 6, 7]);
            let keys = sort_descending(compress(keys, enters as u8), count);
            self.keys[top + 8..top + 16].copy_from_slice(&keys.to_array());
            node.words().shuffle(keys & u32x8::splat(PLACE))
        };
        self.children[top..top + 8].copy_from_slice(&children.to_array());
        self.top = self.top + count - 1;
        self.child = Child::from_word(self.children[self.top as usize]);
    }

    /// Tests leaves, each by the slot that is at it; false, and nothing has been done, if that takes
    /// [more](Self::test_with_care).
    // Left to itself the compiler calls it, and a call between rays costs them their overlap.
    #[inline(always)]
    pub(super) fn test<const ANY: bool, const N: usize, R: Groups<N>, L: Leaves>(
        slots: &mut [&mut Self; N],
        leaves: &L,
    ) -> bool {
        let at = slots.each_ref().map(|slot| slot.child.slot());
        let ends = slots.each_ref().map(|slot| slot.hit.t);
        let rays = Ready::lanes::<N, R>(slots.each_ref().map(|slot| &slot.ray), ends);
        leaves.intersect_blocks::<ANY, N, R>(at, rays, slots.each_mut().map(|slot| &mut slot.hit))
    }

    /// Tests a leaf, whatever is in it. Returns how many blocks' time that took.
    #[cold]
    #[inline(never)]
    pub(super) fn test_with_care<const ANY: bool, L: Leaves>(&mut self, leaves: &L) -> u32 {
        let ray = Ready::lanes::<1, f32x8>([&self.ray], [self.hit.t]);
        leaves.intersect_alone::<ANY>(self.child.slots(), &ray, &mut self.hit)
    }

    /// Moves to the nearest child that waits and is near enough.
    #[inline(always)]
    pub(super) fn pop<const ANY: bool>(&mut self) {
        let mut top = self.top as usize;
        if ANY {
            top -= 1;
        } else {
            // Eight at a time. The end of the ray has key 0, and is always near enough.
            loop {
                let keys = <[u32; 8]>::try_from(&self.keys[top..top + 8]).unwrap_or_default();
                let distances = f32x8::from_bits(u32x8::new(keys) & u32x8::splat(!PLACE));
                let near = distances.le(f32x8::splat(self.hit.t)).to_bitmask();
                if near != 0 {
                    top = top + (31 - near.leading_zeros()) as usize - 8;
                    break;
                }
                top -= 8;
            }
        }
        self.top = top as u32;
        self.child = Child::from_word(self.children[top]);
    }
}

impl Hit {
    /// What a traversal leaves behind, as an answer.
    #[inline]
    pub(super) fn settle<const ANY: bool>(self) -> Self {
        if ANY {
            if self.t == f32::NEG_INFINITY { Self::BLOCKED } else { Self::MISS }
        } else if self.primitive == PrimitiveId::NONE {
            Self::MISS
        } else {
            self
        }
    }
}
