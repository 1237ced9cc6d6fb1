//! The tree of two that is built before the tree of eight.

use super::bounds::Bounds;
use crate::simd::u32x8;

/// A node of the binary tree.
///
/// A subtree owns a run of places in the array of nodes: the node itself first, then its left child's
/// run, then its right child's. Threads so write to disjoint slices, and the tree does not depend on how
/// many there are. A run may be longer than it needs to be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binary {
    pub(super) bounds: Bounds,
    /// First of its references.
    pub(super) first: u32,
    /// An inner node's distance to its right child's place; the left child stands next. A leaf's count of
    /// references, negated.
    word: u32,
}

/// A [`Binary`] in memory. Pages of zeros come from the system for nothing and only when they are
/// touched, by the thread that fills them.
pub(super) type Packed = [u32; 8];

/// Places for the nodes of a tree over `count` references.
pub(super) fn places(count: usize) -> Vec<Packed> {
    vec![[0; 8]; 2 * count - 1]
}

impl Binary {
    /// `count` references from `first` on.
    #[inline]
    pub(super) fn leaf(bounds: Bounds, first: u32, count: usize) -> Self {
        Self { bounds, first, word: (count as u32).wrapping_neg() }
    }

    /// A node whose right child stands `right` places on.
    #[inline]
    pub(super) fn inner(bounds: Bounds, first: u32, right: usize) -> Self {
        Self { bounds, first, word: right as u32 }
    }

    #[inline]
    pub(super) fn pack(self) -> Packed {
        self.bounds.row([self.first, self.word])
    }

    #[inline]
    pub(super) fn unpack(packed: &Packed) -> Self {
        let &[.., first, _, _, _, word] = packed;
        Self { bounds: Bounds::of_row(u32x8::new(*packed)), first, word }
    }

    #[inline]
    pub(super) fn is_leaf(&self) -> bool {
        self.word.cast_signed() < 0
    }

    /// Distance to the right child; of an inner node.
    #[inline]
    pub(super) fn right(&self) -> usize {
        debug_assert!(!self.is_leaf());
        self.word as usize
    }

    /// References of a leaf.
    #[inline]
    pub(super) fn leaf_count(&self) -> usize {
        debug_assert!(self.is_leaf());
        self.word.wrapping_neg() as usize
    }
}

/// A node and the places of its subtree.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Run {
    pub(super) root: u32,
    pub(super) places: u32,
}

impl Run {
    /// The whole tree.
    pub(super) fn all(nodes: &[Packed]) -> Self {
        Self { root: 0, places: nodes.len() as u32 }
    }

    /// The runs of an inner node's children, of which the right one stands so far on.
    #[inline]
    pub(super) fn children(self, right: u32) -> [Self; 2] {
        [
            Self { root: self.root + 1, places: right - 1 },
            Self { root: self.root + right, places: self.places - right },
        ]
    }
}
