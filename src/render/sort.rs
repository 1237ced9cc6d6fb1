//! Hits sorted by material, so that each material is shaded eight or sixteen at a time.

use bumpalo::{Bump, collections::Vec as BumpVec};

use crate::simd::{LANES, MOST};

/// A stable counting sort of slots by a small key.
pub(super) struct Sorter<'a> {
    /// Slots, grouped by key, ascending within a group.
    order: BumpVec<'a, u32>,
    /// Where each key's run ends.
    ends: BumpVec<'a, u32>,
    keys: usize,
}

impl<'a> Sorter<'a> {
    /// For keys below `keys`.
    pub(super) fn new(arena: &'a Bump, keys: usize) -> Self {
        Self { order: BumpVec::new_in(arena), ends: BumpVec::new_in(arena), keys }
    }

    /// Groups the slots 0..`keys.len()` by their keys.
    pub(super) fn sort(&mut self, keys: &[u32]) {
        self.ends.clear();
        self.ends.resize(self.keys, 0);
        for &key in keys {
            self.ends[key as usize] += 1;
        }
        // Counts become starts, and starts become ends as slots are dealt out.
        let mut start = 0;
        for end in &mut self.ends {
            start += std::mem::replace(end, start);
        }
        self.order.resize(keys.len(), 0);
        for (slot, &key) in keys.iter().enumerate() {
            let place = &mut self.ends[key as usize];
            self.order[*place as usize] = slot as u32;
            *place += 1;
        }
    }

    /// Calls `group` with (key, at most [`MOST`] slots of that key) until every slot has been seen.
    pub(super) fn for_each_group(&self, mut group: impl FnMut(u32, &[u32])) {
        let mut start = 0;
        for (key, &end) in self.ends.iter().enumerate() {
            for slots in self.order[start..end as usize].chunks(MOST) {
                group(key as u32, slots);
            }
            start = end as usize;
        }
    }
}

/// The same eight by eight, without sorting: neighbours are shaded together only if they happen to have one key.
pub(super) fn for_each_unsorted_group(keys: &[u32], mut group: impl FnMut(u32, &[u32])) {
    for first in (0..keys.len()).step_by(LANES) {
        let mut left: u32 = (1 << (keys.len() - first).min(LANES)) - 1;
        while left != 0 {
            let key = keys[first + left.trailing_zeros() as usize];
            let mut slots = [0; LANES];
            let mut count = 0;
            for i in 0..LANES {
                if left >> i & 1 != 0 && keys[first + i] == key {
                    slots[count] = (first + i) as u32;
                    count += 1;
                    left &= !(1 << i);
                }
            }
            group(key, &slots[..count]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_hold_every_slot_once_and_one_key_each() {
        let arena = Bump::new();
        let keys: Vec<u32> = (0..203u32).map(|i| i.wrapping_mul(2_654_435_761) >> 29).collect();
        let mut sorted = Vec::new();
        let mut sorter = Sorter::new(&arena, 8);
        for _ in 0..2 {
            sorter.sort(&keys);
            sorted.clear();
            sorter.for_each_group(|key, slots| {
                assert!((1..=MOST).contains(&slots.len()));
                assert!(slots.iter().all(|&slot| keys[slot as usize] == key));
                sorted.extend_from_slice(slots);
            });
            let mut expected: Vec<u32> = (0..keys.len() as u32).collect();
            expected.sort_by_key(|&slot| keys[slot as usize]);
            assert_eq!(sorted, expected);
        }
        let mut unsorted = Vec::new();
        for_each_unsorted_group(&keys, |key, slots| {
            assert!(slots.iter().all(|&slot| keys[slot as usize] == key));
            unsorted.extend_from_slice(slots);
        });
        unsorted.sort_unstable();
        assert_eq!(unsorted, (0..keys.len() as u32).collect::<Vec<_>>());
    }
}
