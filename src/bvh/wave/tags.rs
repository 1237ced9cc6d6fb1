//! Which of a wave's slots are at nodes, at leaves, and at their ends: sets of slots.

use crate::bvh::Child;

/// Rays in turn: with fewer, passes are short, and the end of each is a branch that is guessed wrong; more leave the
/// first-level cache.
pub(super) const SLOTS: usize = 32;

/// A set of slots: of two bits for each the first.
pub(super) type Slots = u64;

/// All slots.
const ALL: Slots = u64::MAX / 3;

/// What each slot is at, two bits for each: the [tag](Child::tag) of its child.
///
/// Which sets a slot goes on to is a shift and an or, in one register: a list in memory would make each slot's turn
/// wait for the last one's, and a branch would be wrong half of the time.
#[derive(Clone, Copy)]
pub(super) struct Tags(u64);

impl Tags {
    /// All are at their ends.
    pub(super) const DONE: Self = Self(u64::MAX);

    /// Says what a slot is at about which nothing is said.
    #[inline]
    pub(super) fn insert(&mut self, slot: usize, child: Child) {
        self.0 |= u64::from(child.tag()) << (2 * slot);
    }

    /// Says nothing of some slots any longer.
    pub(super) fn remove(&mut self, slots: Slots) {
        self.0 &= !(slots * 3);
    }

    /// Is no slot at a leaf or at its end?
    pub(super) fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Those of some slots that are at nodes.
    pub(super) fn nodes(self, among: Slots) -> Slots {
        among & !(self.0 | self.0 >> 1)
    }

    /// Those at leaves.
    pub(super) fn leaves(self) -> Slots {
        (self.0 ^ self.0 >> 1) & ALL
    }

    /// Those at leaves of up to four.
    pub(super) fn small_leaves(self) -> Slots {
        self.0 & !(self.0 >> 1) & ALL
    }

    /// Those at their ends.
    pub(super) fn done(self) -> Slots {
        self.0 & self.0 >> 1 & ALL
    }
}

/// A set of one slot.
#[inline]
pub(super) fn only(slot: usize) -> Slots {
    1 << (2 * slot)
}

/// Takes the lowest slot out of a set.
#[inline]
pub(super) fn take(set: &mut Slots) -> Option<usize> {
    let slot = set.trailing_zeros() as usize / 2;
    (*set != 0).then(|| {
        *set &= *set - 1;
        slot % SLOTS
    })
}

/// The slots of a set, lowest first.
#[inline]
pub(super) fn each(set: Slots) -> impl Iterator<Item = usize> {
    let mut left = set;
    std::iter::from_fn(move || take(&mut left))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slot_is_in_the_set_of_its_child() {
        let children = [
            Child::inner(0),
            Child::leaf(3, 1),
            Child::leaf(0, 4),
            Child::leaf(0, 5),
            Child::leaf(Child::LIMIT - 1, 8),
            Child::ABSENT,
            Child::inner(Child::LIMIT - 1),
        ];
        let child = |slot: usize| children[slot % children.len()];
        let mut tags = Tags::DONE;
        assert_eq!(each(tags.done()).collect::<Vec<_>>(), (0..SLOTS).collect::<Vec<_>>());
        tags.remove(ALL);
        assert!(tags.is_empty());
        (0..SLOTS).for_each(|slot| tags.insert(slot, child(slot)));
        let slots = |is: &dyn Fn(Child) -> bool| {
            (0..SLOTS).filter(|&slot| is(child(slot))).map(only).fold(0, |set, slot| set | slot)
        };
        assert_eq!(tags.nodes(ALL), slots(&|child| !child.is_leaf_or_absent()));
        assert_eq!(tags.nodes(only(6)), only(6));
        assert_eq!(tags.leaves(), slots(&Child::is_leaf));
        assert_eq!(tags.small_leaves(), slots(&|child| child.is_leaf() && child.slots().1 <= 4));
        assert_eq!(tags.done(), slots(&|child| child == Child::ABSENT));
        tags.remove(tags.leaves());
        assert_eq!((tags.leaves(), tags.is_empty()), (0, false));
        tags.remove(tags.done());
        assert!(tags.is_empty());
    }
}
