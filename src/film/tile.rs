//! A rectangle of pixels, and what its samples have brought so far.

use std::{borrow::Cow, ops::Range};

use super::samples::Samples;
use super::spread::Spread;
use super::sums::{self, BLOCK, Node, Sums};

/// A rectangle of pixels that one thread fills at a time.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tile {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Tile {
    /// Pixels.
    pub fn len(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Does it have none?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Covers a film with tiles of at most `size` × `size` pixels, row by row.
pub fn tiles(width: u32, height: u32, size: u32) -> Vec<Tile> {
    let starts = |length: u32| (0..length).step_by(size as usize);
    let tile = |x, y| Tile { x, y, width: size.min(width - x), height: size.min(height - y) };
    starts(height).flat_map(|y| starts(width).map(move |x| tile(x, y))).collect()
}

/// The samples of a tile so far: all of them from a first one on, summed as [`sums`](super::sums) says.
///
/// It is whole between two samples, whichever they are, and can then be kept and continued.
#[derive(Clone, Debug, PartialEq)]
pub struct TileFilm {
    /// Numbers of the samples that are in it; the first is a multiple of [`BLOCK`].
    pub samples: Range<u32>,
    /// Sums of finished blocks.
    pub nodes: Vec<Node>,
    /// Sums of the block that is not finished; `None` where one ends.
    pub open: Option<Sums>,
    /// How much the blocks differ, where somebody asks.
    pub spread: Option<Spread>,
    /// Samples kept out.
    pub invalid: u64,
    /// Pixel of the tile and sample number of the first one kept out, by pixel, then sample.
    pub first_invalid: Option<(u32, u32)>,
    pixels: usize,
    channels: usize,
}

impl TileFilm {
    /// An empty film of this many pixels and channels, before the sample `first`.
    pub fn new(pixels: usize, channels: usize, first: u32) -> Self {
        Self {
            samples: first..first,
            nodes: Vec::new(),
            open: None,
            spread: None,
            invalid: 0,
            first_invalid: None,
            pixels,
            channels,
        }
    }

    /// Pixels.
    pub fn pixels(&self) -> usize {
        self.pixels
    }

    /// Channels.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Adds the next samples of every pixel, so many of one block. `add` is to give each of them to each pixel.
    ///
    /// A block begins in `spare` memory, if there is any: what a tile before has just used is still near. What is not
    /// needed any more becomes spare.
    pub fn add_samples(&mut self, count: u32, spare: &mut Vec<Sums>, add: impl FnOnce(&mut Samples<'_>)) {
        let Range { end: first, .. } = self.samples;
        let fits = |sums: &Sums| (sums.pixels(), sums.channels()) == (self.pixels, self.channels);
        let begun = self.open.take().or_else(|| spare.pop().filter(fits));
        let mut sums = begun.unwrap_or_else(|| Sums::new(self.pixels, self.channels));
        let mut samples = Samples::new(&mut sums, first);
        add(&mut samples);
        self.invalid += samples.invalid;
        self.first_invalid = self.first_invalid.into_iter().chain(samples.first_invalid).min();
        self.samples.end += count;
        if self.samples.end.is_multiple_of(BLOCK) {
            if let Some(spread) = &mut self.spread {
                spread.add(&sums);
            }
            let index = self.samples.end / BLOCK - 1;
            sums::push(&mut self.nodes, Node { level: 0, index, sums }, spare);
        } else {
            self.open = Some(sums);
        }
    }

    /// Takes over what is kept of the block that is not finished: where one ends, nothing.
    pub fn reopen(&mut self, open: Sums) {
        let ends = self.samples.end.is_multiple_of(BLOCK) && open.counts().iter().all(|&count| count == 0);
        self.open = (!ends).then_some(open);
    }

    /// Has every sample of a number that is asked for been taken, or has the error become as small as it
    /// was to be? The answer depends on whole blocks only, and so on nothing but their samples.
    pub fn is_done(&self, samples: u32, target_error: Option<f32>) -> bool {
        self.samples.end >= samples
            || target_error.is_some_and(|target| {
                self.samples.end.is_multiple_of(BLOCK)
                    && self.spread.as_ref().is_some_and(|spread| spread.relative_error() <= f64::from(target))
            })
    }

    /// Puts later samples of the same tile behind these. Both keep to blocks where they meet.
    pub fn append(&mut self, later: Self) {
        debug_assert_eq!(self.samples.end, later.samples.start);
        self.samples.end = later.samples.end;
        later.nodes.into_iter().for_each(|node| sums::push(&mut self.nodes, node, &mut Vec::new()));
        self.open = later.open;
        self.invalid += later.invalid;
        self.first_invalid = self.first_invalid.into_iter().chain(later.first_invalid).min();
    }

    /// All samples together.
    pub fn total(&self) -> Cow<'_, Sums> {
        let mut parts = self.nodes.iter().map(|node| &node.sums).chain(&self.open);
        let first =
            parts.next().map_or_else(|| Cow::Owned(Sums::new(self.pixels, self.channels)), Cow::Borrowed);
        parts.fold(first, |mut total, part| {
            total.to_mut().absorb(part);
            total
        })
    }

    /// What contradicts itself in a film that was not made here, if anything does.
    pub fn defect(&self) -> Option<&'static str> {
        let Range { start, end } = self.samples;
        let (pixels, channels) = (self.pixels(), self.channels());
        let fits = |sums: &Sums| (sums.pixels(), sums.channels()) == (pixels, channels);
        if pixels == 0 || channels == 0 {
            return Some("a tile has no pixels");
        }
        if start > end || !start.is_multiple_of(BLOCK) {
            return Some("a tile's samples don't begin with a block");
        }
        if !self.nodes.iter().map(|node| &node.sums).chain(&self.open).all(fits) {
            return Some("sums are of different sizes");
        }
        let mut next = u64::from(start / BLOCK);
        for node in &self.nodes {
            if node.level >= 32 || node.blocks().0 != next {
                return Some("blocks don't follow each other");
            }
            next = node.blocks().1;
        }
        if end.is_multiple_of(BLOCK) && self.open.is_some() {
            return Some("a block holds samples before its first one");
        }
        let open = !end.is_multiple_of(BLOCK);
        (next != u64::from(end / BLOCK) || open != self.open.is_some()).then_some("blocks are missing")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(first: u32, values: impl IntoIterator<Item = f32>) -> TileFilm {
        let mut film = TileFilm::new(1, 1, first);
        values.into_iter().for_each(|value| one(&mut film, &[(1.0, value)], &mut Vec::new()));
        film
    }

    /// One sample of each pixel: what it counts, and its value in every channel.
    fn one(film: &mut TileFilm, sample: &[(f32, f32)], spare: &mut Vec<Sums>) {
        film.add_samples(1, spare, |samples| {
            for (pixel, &(weight, value)) in sample.iter().enumerate() {
                samples.add(pixel, 0, weight, |_| value);
            }
        });
    }

    #[test]
    fn what_would_overflow_a_sum_is_kept_out() {
        let film = filled(0, [1.0, 3e38, 3.0, -1e29, 2e28]);
        assert_eq!((film.invalid, film.first_invalid), (2, Some((0, 1))));
        assert_eq!(film.total().counts(), [3]);
    }

    fn noise(sample: u32) -> f32 {
        (sample.wrapping_mul(2_654_435_761) >> 8) as f32 * 1e-3
    }

    #[test]
    fn tiles_cover_each_pixel_once() {
        for (width, height, size) in [(1, 1, 8), (17, 5, 8), (64, 64, 32), (33, 7, 5)] {
            let mut seen = vec![0; (width * height) as usize];
            for tile in tiles(width, height, size) {
                for y in tile.y..tile.y + tile.height {
                    for x in tile.x..tile.x + tile.width {
                        seen[(y * width + x) as usize] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|&n| n == 1));
        }
    }

    #[test]
    fn invalid_samples_are_counted_and_kept_out() {
        let mut film = TileFilm::new(2, 1, 0);
        let mut both = |left: f32, right: f32| one(&mut film, &[(1.0, left), (1.0, right)], &mut Vec::new());
        both(1.0, 2.0);
        both(1.0, f32::NAN);
        both(f32::INFINITY, 4.0);
        let total = film.total();
        assert_eq!((total.mean(1, 0), total.mean(0, 0)), (3.0, 1.0));
        assert_eq!((film.invalid, film.first_invalid), (2, Some((0, 2))));
    }

    #[test]
    fn weights_of_both_signs_keep_what_is_the_same_everywhere() {
        let mut film = TileFilm::new(1, 1, 0);
        for weight in [1.0, -1.0, 1.0, 1.0] {
            one(&mut film, &[(weight, 0.75)], &mut Vec::new());
        }
        assert_eq!(film.total().mean(0, 0), 0.75);
        let mut none = TileFilm::new(1, 1, 0);
        one(&mut none, &[(1.0, 3.0)], &mut Vec::new());
        one(&mut none, &[(-1.0, 1.0)], &mut Vec::new());
        assert_eq!(none.total().mean(0, 0), 1.0);
    }

    #[test]
    fn up_to_a_block_samples_are_added_one_after_the_other() {
        let sum = (0..BLOCK).map(noise).fold(0.0, |sum, x| sum + x);
        assert!(filled(0, (0..BLOCK).map(noise)).total().plane(0).eq([sum]));
    }

    #[test]
    fn a_million_samples_have_the_mean_of_one() {
        let mean = filled(0, (0..1 << 20).map(|_| 0.1)).total().mean(0, 0);
        assert!((mean - 0.1).abs() < 1e-7, "{mean}");
    }

    #[test]
    fn samples_in_pieces_are_the_same_to_the_bit() {
        for samples in [16, 50, 64, 170] {
            let whole = filled(0, (0..samples).map(noise));
            assert_eq!(whole.defect(), None);
            for cut in (0..=samples).step_by(BLOCK as usize) {
                let mut joined = filled(0, (0..cut).map(noise));
                let later = filled(cut, (cut..samples).map(noise));
                assert_eq!(later.defect(), None);
                joined.append(later);
                assert_eq!(joined, whole, "{cut} of {samples}");
            }
        }
    }

    #[test]
    fn memory_of_other_tiles_shows_nowhere() {
        let values = |from: u32| (from..from + 50).map(noise).chain([f32::NAN]).chain((0..20).map(noise));
        let (mut spare, mut kept) = (Vec::new(), 0);
        for tile in 0..4 {
            let mut film = TileFilm::new(1, 1, 0);
            for value in values(tile) {
                one(&mut film, &[(1.0, value)], &mut spare);
            }
            assert_eq!(film, filled(0, values(tile)));
            kept = spare.len();
        }
        assert!(kept > 0);
        // Another size has no use for it.
        let mut film = TileFilm::new(2, 3, 0);
        one(&mut film, &[(1.0, 0.0); 2], &mut spare);
        assert_eq!(film.defect(), None);
    }

    #[test]
    fn films_that_contradict_themselves_are_told() {
        let good = filled(0, (0..40).map(noise));
        let wrong = |change: fn(&mut TileFilm)| {
            let mut film = good.clone();
            change(&mut film);
            film.defect()
        };
        assert_eq!(good.defect(), None);
        assert!(wrong(|film| film.samples.start = 3).is_some());
        assert!(wrong(|film| film.samples.end = 70).is_some());
        assert!(wrong(|film| film.nodes.clear()).is_some());
        assert!(wrong(|film| film.nodes[0].index = 1).is_some());
        assert!(wrong(|film| film.nodes[0].level = 40).is_some());
        assert!(wrong(|film| film.samples.end = 32).is_some());
        assert!(wrong(|film| film.open = None).is_some());
        assert!(wrong(|film| film.open = Some(Sums::new(2, 1))).is_some());
        assert!(wrong(|film| film.open = Some(Sums::new(1, 2))).is_some());
        assert!(wrong(|film| *film = TileFilm::new(0, 1, 0)).is_some());
        assert!(wrong(|film| *film = TileFilm::new(1, 0, 0)).is_some());
    }
}
