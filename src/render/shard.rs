//! One of several equal parts of a render.

use std::{fmt, ops::Range};

use crate::film::sums::BLOCK;

/// How a render is cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShardBy {
    /// Every `count`-th tile, so that what is costly in one corner of a picture is spread over all.
    #[default]
    Tiles,
    /// Samples in a row, of the whole picture, in whole blocks.
    Samples,
}

/// Which of how many parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 0.
    pub index: u32,
    /// At least 1.
    pub count: u32,
    /// How the render is cut.
    pub by: ShardBy,
}

impl Default for Shard {
    fn default() -> Self {
        Self::WHOLE
    }
}

impl Shard {
    /// All of it.
    pub const WHOLE: Self = Self { index: 0, count: 1, by: ShardBy::Tiles };

    /// Does a tile, counted row by row, belong to it?
    pub fn has_tile(&self, number: u32) -> bool {
        self.by == ShardBy::Samples || number % self.count == self.index
    }

    /// Which of so many samples belong to it.
    pub fn samples(&self, count: u32) -> Range<u32> {
        if self.by == ShardBy::Tiles {
            return 0..count;
        }
        let blocks = u64::from(count.div_ceil(BLOCK));
        let edge = |index: u32| {
            let block = blocks * u64::from(index) / u64::from(self.count);
            (block * u64::from(BLOCK)).min(count.into()) as u32
        };
        edge(self.index)..edge(self.index + 1)
    }
}

/// As it is typed, counted from 1.
impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index + 1, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_cut_at_blocks_and_none_is_left() {
        for count in [1, 16, 17, 100, 4096] {
            for shards in 1..20 {
                let ranges: Vec<_> = (0..shards)
                    .map(|index| Shard { index, count: shards, by: ShardBy::Samples }.samples(count))
                    .collect();
                assert_eq!((ranges[0].start, ranges[ranges.len() - 1].end), (0, count));
                assert!(ranges.windows(2).all(|pair| pair[0].end == pair[1].start));
                assert!(ranges.iter().all(|range| range.start.is_multiple_of(BLOCK) || range.is_empty()));
            }
        }
    }

    #[test]
    fn tiles_are_dealt_out() {
        for number in 0..10 {
            let owners = (0..3).filter(|&index| Shard { index, count: 3, ..Shard::WHOLE }.has_tile(number));
            assert_eq!(owners.count(), 1);
        }
    }
}
