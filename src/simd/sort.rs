//! Sorting within a register.

use super::u32x8;

/// One layer of a network: lane i meets lane `partner[i]`; the lanes in `keeps_greater` keep the greater.
struct Layer {
    partner: u32x8,
    keeps_greater: u32x8,
}

const fn layer(partner: [u32; 8]) -> Layer {
    let mut greater = [0; 8];
    let mut i = 0;
    while i < 8 {
        // The lower lane of a pair keeps the greater value: descending order.
        greater[i] = if (i as u32) < partner[i] { u32::MAX } else { 0 };
        i += 1;
    }
    Layer { partner: u32x8::new(partner), keeps_greater: u32x8::new(greater) }
}

/// Six layers that sort any eight values (Batcher's odd–even merge sort).
const NETWORK: [Layer; 6] = [
    layer([1, 0, 3, 2, 5, 4, 7, 6]),
    layer([2, 3, 0, 1, 6, 7, 4, 5]),
    layer([0, 2, 1, 3, 4, 6, 5, 7]),
    layer([4, 5, 6, 7, 0, 1, 2, 3]),
    layer([0, 1, 4, 5, 2, 3, 6, 7]),
    layer([0, 2, 1, 4, 3, 6, 5, 7]),
];

#[inline]
fn through(layers: &[Layer], keys: u32x8) -> u32x8 {
    let mut keys = keys.0;
    for Layer { partner, keeps_greater } in layers {
        let other = u32x8(keys).shuffle(*partner).0;
        keys = keeps_greater.0.bitselect(keys.max(other), keys.min(other));
    }
    u32x8(keys)
}

/// The lanes, greatest first, where only the first `count` are not 0. Half the work for up to four, which
/// never leave their half of a register; beyond that no branch depends on the keys.
#[inline]
pub fn sort_descending(keys: u32x8, count: u32) -> u32x8 {
    let (halves, merge) = NETWORK.split_at(3);
    let keys = through(halves, keys);
    if count <= 4 { keys } else { through(merge, keys) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_network_sorts() {
        // A network that sorts all 256 inputs of zeros and ones sorts everything (Knuth's 0–1 principle).
        for bits in 0..256u32 {
            let keys = std::array::from_fn(|i| bits >> i & 1);
            let sorted = sort_descending(u32x8::new(keys), 8).to_array();
            assert!(sorted.is_sorted_by(|a, b| a >= b), "{keys:?} {sorted:?}");
            let count = 8 - keys.iter().rev().take_while(|key| **key == 0).count();
            assert_eq!(sort_descending(u32x8::new(keys), count as u32).to_array(), sorted);
        }
        let keys = [5, u32::MAX, 0, 7, 7, 1 << 31, 3, 2];
        let mut expected = keys;
        expected.sort_unstable_by(|a, b| b.cmp(a));
        assert_eq!(sort_descending(u32x8::new(keys), 8).to_array(), expected);
    }
}
