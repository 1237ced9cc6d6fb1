//! Samples of a tile, on their way to its sums.
//!
//! Several samples of a pixel come together, and are added one after the other, so the order is that of single ones; but
//! the pixel's sums are fetched and put back once.

use super::sums::{BLOCK, Quad, Sums, WEIGHT, place};
use crate::simd::{Eights, LANES, Mask, Mask8, Real, f32x8, f32x16};

/// The greatest value of a sample: no sum of as many as can be counted overflows. Whether a sample is kept
/// must not depend on those before it, which may be on another machine.
pub const GREATEST: f32 = f32::MAX / 4_294_967_296.0;

/// The next samples of a tile's pixels, all of one block.
#[derive(Debug)]
pub struct Samples<'f> {
    sums: &'f mut Sums,
    /// The number of the first.
    first: u32,
    /// Kept out.
    pub(super) invalid: u64,
    /// Pixel of the tile and number of the first one kept out, by pixel, then sample.
    pub(super) first_invalid: Option<(u32, u32)>,
}

impl<'f> Samples<'f> {
    /// For these sums of the samples of their block before `first`; where one begins, of whatever.
    pub(super) fn new(sums: &'f mut Sums, first: u32) -> Self {
        Self { sums, first, invalid: 0, first_invalid: None }
    }

    /// Are there none of the block before?
    ///
    /// Sums are 0 then, and are not read. To a system that gives memory out when it is touched, reading it and then
    /// writing it is touching it twice, and telling all threads in between.
    #[inline]
    fn begin(&self) -> bool {
        self.first.is_multiple_of(BLOCK)
    }

    /// Adds to a pixel the `index`-th of the samples, of a weight: `value(c)` for each channel c.
    pub fn add(&mut self, pixel: usize, index: u32, weight: f32, value: impl Fn(usize) -> f32) {
        if self.begin() && index == 0 {
            let (row, count) = self.sums.row(pixel);
            row.fill([0.0; 4]);
            *count = 0;
        }
        let channels = self.sums.channels();
        if !(0..channels).all(|c| (value(c) * weight).abs() <= GREATEST) {
            self.keep_out(pixel as u32, index);
            return;
        }
        for c in 0..channels {
            *self.sums.number(pixel, place(c)) += value(c) * weight;
        }
        *self.sums.number(pixel, WEIGHT) += weight;
        *self.sums.row(pixel).1 += 1;
    }

    /// Adds all of the samples to a pixel, one for each of the weights.
    ///
    /// A sample is a row of so many [`quads`](super::sums::quads): each channel at its [`place`], 1 at that of the
    /// [`WEIGHT`], then zeros. Its first quads are in `fronts`, row after row, and what is behind them in `backs`, filled up to
    /// whole eights.
    #[inline]
    pub fn add_rows(&mut self, pixel: usize, weights: &[f32], fronts: &[Quad], backs: &[f32x8]) {
        let begin = self.begin();
        let (row, count) = self.sums.row(pixel);
        // Three colours, and layers besides.
        let all = match row.len() {
            _ if fronts.len() != weights.len() => false,
            1 => add_colours(begin, row, weights, fronts),
            3 => add_layers::<f32x8>(begin, row, weights, fronts, backs),
            5 => add_layers::<f32x16>(begin, row, weights, fronts, backs),
            _ => false,
        };
        let kept = match all {
            true => (1 << weights.len()) - 1,
            false => {
                let quads = fronts.len() / weights.len().max(1);
                add_good(begin, row.split_at_mut(quads), weights, fronts, backs)
            }
        };
        *count = kept.count_ones() + if begin { 0 } else { *count };
        if kept.count_ones() as usize != weights.len() {
            let out = (0..weights.len() as u32).filter(|index| kept >> index & 1 == 0);
            out.for_each(|index| self.keep_out(pixel as u32, index));
        }
    }

    #[cold]
    fn keep_out(&mut self, pixel: u32, index: u32) {
        self.invalid += 1;
        let place = (pixel, self.first + index);
        self.first_invalid = Some(self.first_invalid.map_or(place, |first| first.min(place)));
    }
}

/// Adds rows of one quad, in registers, if no number of any is too great. Are they there now?
#[inline(always)]
fn add_colours(begin: bool, row: &mut [Quad], weights: &[f32], fronts: &[Quad]) -> bool {
    let Some(row) = row.first_mut() else { return false };
    let mut sums = if begin { f32x8::zero() } else { f32x8::of_halves(*row, [0.0; 4]) };
    let greatest = f32x8::splat(GREATEST);
    let mut fits = Mask8::splat(true);
    for (&weight, &front) in weights.iter().zip(fronts) {
        let more = f32x8::of_halves(front, [0.0; 4]) * f32x8::splat(weight);
        fits = fits & more.abs().le(greatest);
        sums = sums + more;
    }
    if fits.all() {
        *row = sums.half(0);
    }
    fits.all()
}

/// Adds rows of one quad and a register behind it, the same way.
#[inline(always)]
fn add_layers<R: Eights>(
    begin: bool,
    row: &mut [Quad],
    weights: &[f32],
    fronts: &[Quad],
    backs: &[f32x8],
) -> bool {
    let Some((front, back)) = row.split_first_mut() else { return false };
    let (mut sums, greatest) = (R::zero(), R::splat(GREATEST));
    if !begin {
        sums = R::of_eights(|i| f32x8::of_halves(back[2 * i], back[2 * i + 1]));
    }
    let mut fits = R::Mask::splat(true);
    for (&weight, row) in weights.iter().zip(backs.chunks_exact(R::LANES / LANES)) {
        let more = R::of_eights(|i| row[i]) * R::splat(weight);
        fits = fits & more.abs().le(greatest);
        sums = sums + more;
    }
    let fits = fits.all() && add_colours(begin, std::slice::from_mut(front), weights, fronts);
    if fits {
        for (i, pair) in back.as_chunks_mut::<2>().0.iter_mut().enumerate() {
            let eight = sums.eight(i);
            *pair = [eight.half(0), eight.half(1)];
        }
    }
    fits
}

/// Adds rows of which no number is too great. Those are bits of the result: the first is bit 0.
#[inline(never)]
fn add_good(
    begin: bool,
    (front, back): (&mut [Quad], &mut [Quad]),
    weights: &[f32],
    fronts: &[Quad],
    backs: &[f32x8],
) -> u32 {
    let (quads, eights) = (front.len(), back.len().div_ceil(2));
    let more_front = |i: usize, k: usize| fronts[i * quads + k].map(|number| number * weights[i]);
    let more_back = |i: usize, k: usize| backs[i * eights + k] * f32x8::splat(weights[i]);
    let mut kept = 0;
    for i in 0..weights.len() {
        let mut fits = true;
        (0..quads)
            .for_each(|k| fits &= more_front(i, k).iter().fold(true, |fits, x| fits & (x.abs() <= GREATEST)));
        (0..eights).for_each(|k| fits &= more_back(i, k).abs().le(f32x8::splat(GREATEST)).all());
        kept |= u32::from(fits) << i;
    }
    let those = || (0..weights.len()).filter(|i| kept >> i & 1 != 0);
    for (k, front) in front.iter_mut().enumerate() {
        let before = if begin { [0.0; 4] } else { *front };
        *front = those().fold(before, |sums, i| {
            let more = more_front(i, k);
            std::array::from_fn(|c| sums[c] + more[c])
        });
    }
    let (pairs, last) = back.as_chunks_mut::<2>();
    for (k, pair) in pairs.iter_mut().enumerate() {
        let before = if begin { f32x8::zero() } else { f32x8::of_halves(pair[0], pair[1]) };
        let sums = those().fold(before, |sums, i| sums + more_back(i, k));
        *pair = [sums.half(0), sums.half(1)];
    }
    for half in last {
        let before = if begin { f32x8::zero() } else { f32x8::of_halves(*half, [0.0; 4]) };
        *half = those().fold(before, |sums, i| sums + more_back(i, eights - 1)).half(0);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::super::{TileFilm, sums};
    use super::*;
    fn noise(number: usize) -> f32 {
        ((number as u32).wrapping_mul(2_654_435_761) >> 8) as f32 * 1e-3
    }

    fn value((sample, pixel, channel): (usize, usize, usize), channels: usize) -> f32 {
        match (sample, pixel, channel) {
            (3, 8, 2) => f32::NAN,
            (7, 2, 0) => f32::MAX,
            _ => noise((sample * 9 + pixel) * channels + channel),
        }
    }

    fn weight(pixel: usize) -> f32 {
        if pixel == 5 { -0.5 } else { 0.75 + pixel as f32 }
    }

    /// A row in two parts, the first of so many quads.
    fn row(at: (usize, usize), channels: usize, front: usize) -> (Vec<Quad>, Vec<f32x8>) {
        let all = sums::quads(channels);
        let mut row = vec![0.0; 4 * all.max(front).next_multiple_of(2) + 8];
        (0..channels).for_each(|c| row[place(c)] = value((at.0, at.1, c), channels));
        row[WEIGHT] = 1.0;
        let (quads, back) = row.split_at(4 * front);
        let eights = (all - front).div_ceil(2);
        let back = back.as_chunks::<LANES>().0.iter().take(eights).map(|&eight| f32x8::new(eight));
        (quads.as_chunks::<4>().0.to_vec(), back.collect())
    }

    #[test]
    fn rows_are_channels_one_by_one_however_many_samples_come_together() {
        // One quad, pairs that are filled or not, and quads without a partner; in one part or two.
        for channels in [1, 3, 4, 7, 8, 13, 16, 18, 19, 24] {
            for front in [1, 2, sums::quads(channels)].map(|front| front.min(sums::quads(channels))) {
                let (mut rows, mut ones) = (TileFilm::new(9, channels, 0), TileFilm::new(9, channels, 0));
                // Memory of others does not show.
                let mut spare = [rows.clone(), ones.clone()].map(|mut film| {
                    film.add_samples(16, &mut Vec::new(), |samples| {
                        (0..9).for_each(|pixel| samples.add(pixel, 0, 7.0, |_| 5.0));
                    });
                    film.nodes.pop().map(|node| node.sums).into_iter().collect::<Vec<_>>()
                });
                for together in [0..1, 1..2, 2..4, 4..8, 8..16, 16..17, 17..20] {
                    let count = together.len() as u32;
                    rows.add_samples(count, &mut spare[0], |samples| {
                        for pixel in 0..9 {
                            let weights = vec![weight(pixel); together.len()];
                            let parts = together.clone().map(|sample| row((sample, pixel), channels, front));
                            let (fronts, backs): (Vec<_>, Vec<_>) = parts.unzip();
                            samples.add_rows(pixel, &weights, &fronts.concat(), &backs.concat());
                        }
                    });
                    ones.add_samples(count, &mut spare[1], |samples| {
                        for (index, sample) in (0..).zip(together.clone()) {
                            for pixel in 0..9 {
                                let value = |c| value((sample, pixel, c), channels);
                                samples.add(pixel, index, weight(pixel), value);
                            }
                        }
                    });
                }
                let kept_out = if channels > 2 { (2, Some((2, 7))) } else { (1, Some((2, 7))) };
                assert_eq!((ones.invalid, ones.first_invalid), kept_out);
                assert_eq!(ones.total().counts()[..3], [20, 20, 19]);
                assert_eq!(rows, ones, "{channels} {front}");
            }
        }
    }
}
