//! Slots sorted by a small key: hits by material, so that each material is shaded eight or sixteen at a time, and
//! rays by octant, so that packets of them meet less of a scene.

use bumpalo::{Bump, collections::Vec as BumpVec};

use crate::simd::{Bits, LANES, MOST, Mask, compress, u32x8};

/// Up to so many keys, each has a pass over all slots.
const FEW: usize = 16;

/// A stable sort of slots by a small key.
pub(super) struct Sorter<'a> {
    /// Slots, grouped by key, ascending within a group; a packet behind them holds the last.
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
        // A packet is written whole, wherever it begins.
        let room = keys.len() + LANES;
        if self.order.len() < room {
            self.order.resize(room, 0);
        }
        if self.keys <= FEW {
            self.sort_by_passes(keys);
        } else {
            self.sort_by_counting(keys);
        }
        let last = keys.len().checked_sub(1).map_or(0, |last| self.order[last]);
        self.order[keys.len()..room].fill(last);
    }

    /// The slots of one key after the other: a slot waits for none before it, as it would for a counter.
    fn sort_by_passes(&mut self, keys: &[u32]) {
        let (whole, rest) = keys.as_chunks::<LANES>();
        let mut last = [u32::MAX; LANES];
        last[..rest.len()].copy_from_slice(rest);
        let mut end = 0;
        for key in 0..self.keys as u32 {
            let mut slots = u32x8::from_fn(|i| i as u32);
            for keys in whole.iter().chain([&last]) {
                let lanes = u32x8::new(*keys).equal(u32x8::splat(key)).to_bitmask();
                let chosen = compress(slots, lanes as u8);
                self.order[end..end + LANES].copy_from_slice(&chosen.to_array());
                end += lanes.count_ones() as usize;
                slots = slots.wrapping_add(u32x8::splat(LANES as u32));
            }
            self.ends.push(end as u32);
        }
    }

    fn sort_by_counting(&mut self, keys: &[u32]) {
        self.ends.resize(self.keys, 0);
        for &key in keys {
            self.ends[key as usize] += 1;
        }
        // Counts become starts, and starts become ends as slots are dealt out.
        let mut start = 0;
        for end in &mut self.ends {
            start += std::mem::replace(end, start);
        }
        for (slot, &key) in keys.iter().enumerate() {
            let place = &mut self.ends[key as usize];
            self.order[*place as usize] = slot as u32;
            *place += 1;
        }
    }

    /// The slots that were sorted last, a packet of the last of them, and perhaps more behind that.
    pub(super) fn order(&self) -> &[u32] {
        &self.order
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
        // By passes and by counting, whole packets and not, and more before than after.
        for (bits, most) in [(3, FEW), (4, FEW), (5, 32), (3, 32)] {
            let mut sorter = Sorter::new(&arena, most);
            for len in [203, 0, 64, 1, 7, 9] {
                groups(&mut sorter, bits, len);
            }
        }
    }

    fn groups(sorter: &mut Sorter, bits: u32, len: u32) {
        let keys: Vec<u32> = (0..len).map(|i| i.wrapping_mul(2_654_435_761) >> (32 - bits)).collect();
        let mut sorted = Vec::new();
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
