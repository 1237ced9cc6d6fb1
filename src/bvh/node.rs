//! Eight boxes and what is behind them.

use crate::geometry::Aabb;
use crate::simd::{f32x8, u32x8};

/// Eight children: 256 bytes, four cache lines.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// For each axis the lower bounds, then the upper ones. No ray enters the box of an absent child.
    pub bounds: [[[f32; 8]; 2]; 3],
    /// What is behind each box.
    pub children: [Child; 8],
}

/// A 32-bit word: an inner node's index, or a leaf's first slot and count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(u32);

/// One of a slab's two planes, as what is added to an address: where its bounds begin among an axis's, in eights of bytes.
#[derive(Clone, Copy, Debug)]
#[repr(u8)]
pub(super) enum Side {
    Lower = 0,
    Upper = 4,
}

/// What a [`Child`] means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Nothing.
    Absent,
    /// The node at this index.
    Inner(u32),
    /// `count` slots from `first` on, all in one block.
    Leaf {
        /// Slot.
        first: u32,
        /// 1 to 8.
        count: u32,
    },
}

impl Child {
    /// No child.
    pub const ABSENT: Self = Self(u32::MAX);
    /// Slots and inner nodes are fewer than this.
    pub const LIMIT: u32 = (1 << 28) - 1;
    /// Where the [tag](Self::tag) is, what is behind a child, and where how many there are less one, of four.
    const TAG: u32 = 30;
    const COUNT: u32 = 28;
    const SMALL: u32 = 1;
    const LARGE: u32 = 2;

    /// The node at `index`, below [`Child::LIMIT`].
    #[inline]
    pub fn inner(index: u32) -> Self {
        debug_assert!(index < Self::LIMIT);
        Self(index)
    }

    /// `count` in 1..=8 slots from `first`, below [`Child::LIMIT`].
    #[inline]
    pub fn leaf(first: u32, count: u32) -> Self {
        debug_assert!(first < Self::LIMIT && (1..=8).contains(&count));
        let tag = if count <= 4 { Self::SMALL } else { Self::LARGE };
        Self(tag << Self::TAG | ((count - 1) % 4) << Self::COUNT | first)
    }

    /// Is it a leaf? False for an absent child, too.
    #[inline]
    pub fn is_leaf(self) -> bool {
        self.is_leaf_or_absent() && self != Self::ABSENT
    }

    /// Is it anything but an inner node?
    #[inline]
    pub(super) fn is_leaf_or_absent(self) -> bool {
        self.0 >= Self::SMALL << Self::TAG
    }

    /// 0 for an inner node, 1 for a leaf of up to four slots, 2 for a larger one, and 3 for an absent child.
    #[inline]
    pub(super) fn tag(self) -> u32 {
        self.0 >> Self::TAG
    }

    /// The index of an inner node.
    #[inline]
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }

    /// The first slot of a leaf.
    #[inline]
    pub(super) fn slot(self) -> u32 {
        self.0 & Self::LIMIT
    }

    /// The first slot of a leaf and how many there are.
    #[inline]
    pub(super) fn slots(self) -> (u32, u32) {
        let count = (self.0 >> Self::COUNT & 3) + 1;
        (self.slot(), if self.tag() == Self::SMALL { count } else { count + 4 })
    }

    #[inline]
    pub(super) fn word(self) -> u32 {
        self.0
    }

    #[inline]
    pub(super) fn from_word(word: u32) -> Self {
        Self(word)
    }

    /// The word, taken apart.
    #[inline]
    pub fn kind(self) -> Kind {
        if self == Self::ABSENT {
            Kind::Absent
        } else if !self.is_leaf_or_absent() {
            Kind::Inner(self.0)
        } else {
            let (first, count) = self.slots();
            Kind::Leaf { first, count }
        }
    }
}

impl Node {
    /// Where an absent child is along each axis: the planes are the wrong way round.
    const NOWHERE: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];

    /// No children.
    pub const EMPTY: Self = {
        let [lower, upper] = Self::NOWHERE;
        Self { bounds: [[[lower; 8], [upper; 8]]; 3], children: [Child::ABSENT; 8] }
    };

    /// Takes the child out of its place.
    pub fn clear(&mut self, place: usize) {
        for [lower, upper] in &mut self.bounds {
            [lower[place], upper[place]] = Self::NOWHERE;
        }
        self.children[place] = Child::ABSENT;
    }

    /// Puts a child in its place.
    pub fn set(&mut self, place: usize, bounds: Aabb, child: Child) {
        for axis in 0..3 {
            self.bounds[axis][0][place] = bounds.min[axis];
            self.bounds[axis][1][place] = bounds.max[axis];
        }
        self.children[place] = child;
    }

    /// The box around all children.
    pub fn bounds(&self) -> Aabb {
        let there = (0..8).filter(|&place| self.children[place] != Child::ABSENT);
        there.fold(Aabb::EMPTY, |bounds, place| bounds.union(self.child_bounds(place)))
    }

    /// The box of a child that is there.
    #[inline]
    pub fn child_bounds(&self, place: usize) -> Aabb {
        let corner = |side: usize| glam::Vec3::from_array(self.bounds.map(|axis| axis[side][place]));
        Aabb { min: corner(0), max: corner(1) }
    }

    /// The bounds along an axis: (met first, met last) by rays into its negative direction or not.
    #[inline]
    pub(super) fn slabs(&self, axis: usize, negative: bool) -> (&[f32; 8], &[f32; 8]) {
        let sides = &self.bounds[axis];
        (&sides[usize::from(negative)], &sides[usize::from(!negative)])
    }

    /// The bounds along an axis on one side.
    #[inline(always)]
    pub(super) fn plane(&self, axis: usize, side: Side) -> f32x8 {
        let (pairs, _) = self.bounds[axis].as_flattened().as_chunks::<2>();
        let first = side as usize;
        let mut plane = [0.0; 8];
        plane.copy_from_slice(pairs[first..first + 4].as_flattened());
        f32x8::new(plane)
    }

    /// What is behind the boxes, as words.
    #[inline]
    pub(super) fn words(&self) -> u32x8 {
        u32x8::new(self.children.map(Child::word))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_keep_what_is_put_in() {
        assert_eq!(size_of::<Node>(), 256);
        for first in [0, 1, 77, Child::LIMIT - 1] {
            assert_eq!(Child::inner(first).kind(), Kind::Inner(first));
            for count in 1..=8 {
                assert_eq!(Child::leaf(first, count).kind(), Kind::Leaf { first, count });
                assert!(Child::leaf(first, count).is_leaf());
            }
        }
        assert_eq!(Child::ABSENT.kind(), Kind::Absent);
        assert!(!Child::ABSENT.is_leaf() && !Child::inner(3).is_leaf());
    }
}
