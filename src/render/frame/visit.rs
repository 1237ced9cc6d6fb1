//! A thread at a tile: which samples it takes next, and how they are added.

use std::{
    cell::RefCell,
    ops::Range,
    sync::atomic::{AtomicU64, Ordering},
    time::Instant,
};

use super::{Cell, Frame, Watch, lock};
use crate::{
    film::{Samples, Tile, sums::Sums},
    render::{
        Progress,
        statistics::{Stage, Statistics},
    },
};

/// Samples of a pixel that are taken at once, at most: neighbours in the order of paths, as their rays are in the scene,
/// they meet the same boxes and the same triangles. Sixteen render 1.02 times as fast at best, and then a picture of
/// sixteen samples, which never takes as many, has 5 % less memory than one of a thousand.
const TOGETHER: u32 = 8;

/// How many samples are taken at once, from `first` on and before `end`.
fn together(first: u32, end: u32) -> u32 {
    let aligned = first.trailing_zeros().min(TOGETHER.ilog2());
    1 << (end - first).ilog2().min(aligned)
}

/// Samples of a pixel that a render of so many takes at once, at most.
pub(in crate::render) fn most_together(samples: u32) -> u32 {
    (samples / 2).checked_ilog2().map_or(1, |power| 1 << power.min(TOGETHER.ilog2()))
}

/// A thread at a tile, for one pass.
pub(in crate::render) struct Visit<'a> {
    pub(super) cell: &'a Cell,
    pub(super) frame: &'a Frame,
    /// Where the pass ends.
    pub(super) until: u32,
    /// Samples of all pixels that are asked for, and those that are there.
    pub(super) total: u64,
    pub(super) done: &'a AtomicU64,
    pub(super) watch: &'a Watch<'a>,
    pub(super) spare: &'a RefCell<&'a mut Vec<Sums>>,
}

impl Visit<'_> {
    /// The next samples that the tile needs, if this pass has some for it: a power of two of them, from a multiple of
    /// it on, so that they are of one block.
    pub(in crate::render) fn next(&self) -> Option<Range<u32>> {
        let film = &lock(&self.cell.state).film;
        let done = film.is_done(self.until, self.frame.plan.target_error);
        let first = film.samples.end;
        (!done && !(self.watch.stop)()).then(|| first..first + together(first, self.until))
    }

    /// Adds samples of every pixel, as [`TileFilm::add_samples`](crate::film::TileFilm::add_samples) asks for them, and what they took.
    pub(in crate::render) fn finish(
        &self,
        samples: Range<u32>,
        mut statistics: Statistics,
        add: impl FnOnce(&mut Samples<'_>),
    ) {
        let start = Instant::now();
        let count = samples.len() as u32;
        let pixels = self.cell.tile.len() as u64 * u64::from(count);
        let mut state = lock(&self.cell.state);
        let spare = &mut *self.spare.borrow_mut();
        state.film.add_samples(count, spare, add);
        // One is what the next block needs; more would grow with the number of samples.
        spare.truncate(1);
        statistics.spend(Stage::Add, start);
        state.statistics.merge(&statistics);
        state.statistics.samples += pixels;
        state.statistics.invalid_samples = state.film.invalid;
        let Tile { x, y, width, .. } = self.cell.tile;
        state.statistics.first_invalid =
            state.film.first_invalid.map(|(pixel, sample)| (x + pixel % width, y + pixel / width, sample));
        drop(state);
        let done = self.done.fetch_add(pixels, Ordering::Relaxed) + pixels;
        (self.watch.progress)(Progress { done, total: self.total });
    }
}

#[cfg(test)]
mod tests {
    use super::super::passes;
    use super::*;
    use crate::film::sums::BLOCK;

    #[test]
    fn passes_take_no_more_together_than_is_said_before() {
        for samples in 1..100 {
            let (mut first, mut most) = (0, 0);
            for end in passes(samples) {
                while first < end {
                    most = most.max(together(first, end));
                    first += together(first, end);
                }
            }
            assert_eq!(most_together(samples), most, "{samples}");
        }
    }

    #[test]
    fn samples_that_are_taken_at_once_are_of_one_block() {
        for first in 0..70 {
            for end in first + 1..100 {
                let count = together(first, end);
                assert!(count.is_power_of_two() && count <= end - first, "{first} {end}");
                assert_eq!(first / BLOCK, (first + count - 1) / BLOCK, "{first} {end}");
            }
        }
        assert_eq!(
            [(0, 1), (1, 2), (2, 4), (4, 8), (8, 16), (16, 64)].map(|(a, b)| together(a, b)),
            [1, 1, 2, 4, 8, 8]
        );
    }
}
