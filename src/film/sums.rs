//! What the samples of a pixel add up to, in one order.
//!
//! Rounded sums depend on how they are bracketed, so brackets are fixed: sixteen samples in a row are a
//! *block*, added one after the other, and blocks are the leaves of a binary tree, where two neighbours
//! become one sum:
//!
//! ```text
//!  level 2          0–3
//!  level 1      0–1     2–3     4–5
//!  blocks      0   1   2   3   4   5   6 …
//! ```
//!
//! Whoever has whole blocks can do the sums that lie within them and leave the others to whoever joins the
//! pieces: samples may be rendered in several goes, on several machines, and end in the same bits. Besides,
//! rounding grows like the logarithm of the number of samples, not like the number.

use super::GREATEST;
use crate::simd::{LANES, Real, f32x8};

/// Samples that are added one after the other.
pub const BLOCK: u32 = 16;

/// Four numbers of a pixel, side by side.
pub type Quad = [f32; 4];

/// In a row of so many channels: each of them, and 1 behind the last. A pixel's row is all that a sample has to
/// touch; were its channels in planes, their lines would drive each other out of the cache.
pub fn quads(channels: usize) -> usize {
    let numbers = channels + 1;
    numbers.div_ceil(4)
}

/// Sums over the pixels of a tile, of some samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Sums {
    /// Pixel after pixel, a row each: its channels, what its samples count together, and zeros.
    rows: Vec<Quad>,
    channels: usize,
    /// How many samples there are of each pixel.
    counts: Vec<u32>,
}

impl Sums {
    /// Of no samples.
    pub fn new(pixels: usize, channels: usize) -> Self {
        Self { rows: vec![[0.0; 4]; pixels * quads(channels)], channels, counts: vec![0; pixels] }
    }

    /// Of planes, channel after channel; `None` if they don't fit together.
    pub fn from_planes(values: &[f32], weights: &[f32], counts: Vec<u32>) -> Option<Self> {
        let pixels = counts.len();
        let fits = pixels > 0 && weights.len() == pixels && values.len().is_multiple_of(pixels);
        let mut sums = fits.then(|| Self::new(pixels, values.len() / pixels))?;
        sums.counts = counts;
        for (c, plane) in values.chunks_exact(pixels).chain([weights]).enumerate() {
            plane.iter().enumerate().for_each(|(pixel, &value)| *sums.number(pixel, c) = value);
        }
        Some(sums)
    }

    /// Pixels.
    pub fn pixels(&self) -> usize {
        self.counts.len()
    }

    /// Channels.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// How many samples there are of each pixel.
    pub fn counts(&self) -> &[u32] {
        &self.counts
    }

    /// A channel's sums, pixel after pixel; the channel behind the last is what the samples of each pixel count together.
    pub fn plane(&self, channel: usize) -> impl Iterator<Item = f32> {
        self.plane_from(channel, 0)
    }

    /// The same from the pixel `first` on.
    fn plane_from(&self, channel: usize, first: usize) -> impl Iterator<Item = f32> {
        let quads = quads(self.channels);
        let rows = self.rows[first * quads..].chunks_exact(quads);
        rows.map(move |row| row[channel / 4][channel % 4])
    }

    fn number(&mut self, pixel: usize, number: usize) -> &mut f32 {
        let row = pixel * quads(self.channels);
        &mut self.rows[row + number / 4][number % 4]
    }

    /// The same memory, of no samples.
    pub(super) fn cleared(mut self) -> Self {
        self.rows.fill([0.0; 4]);
        self.counts.fill(0);
        self
    }

    /// Adds to a pixel a sample of a weight: `value(c)` for each channel c.
    pub(super) fn add(&mut self, pixel: usize, weight: f32, value: impl Fn(usize) -> f32) {
        for c in 0..self.channels {
            *self.number(pixel, c) += value(c) * weight;
        }
        *self.number(pixel, self.channels) += weight;
        self.counts[pixel] += 1;
    }

    /// The same of a row that [`quads`] describes, if none of its numbers is too great. Is it there now?
    ///
    /// `FIRST` says that there was none: sums are 0, and are not read. To a system that gives memory out when it is touched,
    /// reading it and then writing it is touching it twice, and telling all threads in between.
    #[inline]
    #[must_use]
    pub(super) fn add_row<const FIRST: bool>(&mut self, pixel: usize, weight: f32, row: &[Quad]) -> bool {
        let sums = &mut self.rows[pixel * row.len()..][..row.len()];
        // Of three colours, and of six layers besides, in registers.
        let added = match row.len() {
            1 => add_quads::<1, FIRST>(sums, row, weight),
            5 => add_quads::<5, FIRST>(sums, row, weight),
            _ => add_some::<FIRST>(sums, row, weight),
        };
        self.counts[pixel] = u32::from(added) + if FIRST { 0 } else { self.counts[pixel] };
        added
    }

    /// These and later ones.
    pub fn absorb(&mut self, later: &Self) {
        for (sum, more) in self.rows.as_flattened_mut().iter_mut().zip(later.rows.as_flattened()) {
            *sum += more;
        }
        for (sum, more) in self.counts.iter_mut().zip(&later.counts) {
            *sum += more;
        }
    }

    /// Means of a channel's samples from the pixel `first` on, 0 for pixels that have none.
    ///
    /// Divided by their weights, so that what is the same everywhere stays the same; but a few samples of
    /// both signs may weigh nothing together, and are then divided by their number.
    pub fn means(&self, channel: usize, first: usize, out: &mut [f32]) {
        let sums = self.plane_from(channel, first).zip(self.plane_from(self.channels, first));
        for ((mean, (sum, weight)), &count) in out.iter_mut().zip(sums).zip(&self.counts[first..]) {
            let quotient = sum / if weight > 0.0 { weight } else { count as f32 };
            *mean = if count == 0 { 0.0 } else { quotient };
        }
    }

    #[cfg(test)]
    pub(super) fn mean(&self, pixel: usize, channel: usize) -> f32 {
        let mut mean = [0.0];
        self.means(channel, pixel, &mut mean);
        mean[0]
    }
}

/// Is no number too great for a sum?
#[inline]
fn is_kept(numbers: f32x8) -> bool {
    numbers.abs().le(f32x8::splat(GREATEST)).all()
}

/// A row of a length that is known.
#[inline(always)]
fn add_quads<const N: usize, const FIRST: bool>(sums: &mut [Quad], row: &[Quad], weight: f32) -> bool {
    match (<&mut [Quad; N]>::try_from(sums), <&[Quad; N]>::try_from(row)) {
        (Ok(sums), Ok(row)) => add_some::<FIRST>(sums, row, weight),
        _ => false,
    }
}

#[inline(always)]
fn add_some<const FIRST: bool>(sums: &mut [Quad], row: &[Quad], weight: f32) -> bool {
    let (sums, last_sums) = sums.as_flattened_mut().as_chunks_mut::<LANES>();
    let (row, last) = row.as_flattened().as_chunks::<LANES>();
    let (last_sums, last) = (last_sums.as_chunks_mut::<4>().0, last.as_chunks::<4>().0);
    let weights = f32x8::splat(weight);
    let more = |row: &[f32; LANES]| f32x8::new(*row) * weights;
    let last_more = |row: &Quad| row.map(|number| number * weight);
    let mut kept = true;
    row.iter().for_each(|row| kept &= is_kept(more(row)));
    last.iter().for_each(|row| kept &= is_kept(f32x8::of_halves(last_more(row), [0.0; 4])));
    if kept {
        for (sums, row) in sums.iter_mut().zip(row) {
            let before = if FIRST { f32x8::zero() } else { f32x8::new(*sums) };
            *sums = (before + more(row)).to_array();
        }
        for (sums, row) in last_sums.iter_mut().zip(last) {
            let more = last_more(row);
            *sums = std::array::from_fn(|i| if FIRST { 0.0 + more[i] } else { sums[i] + more[i] });
        }
    }
    kept
}

/// The sum over the blocks `index`·2^`level` … (`index` + 1)·2^`level` − 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// 0 is a block.
    pub level: u32,
    /// Among the nodes of its level.
    pub index: u32,
    /// Over all samples below.
    pub sums: Sums,
}

impl Node {
    /// The first block below, and the first one behind.
    pub(super) fn blocks(&self) -> (u64, u64) {
        let first = u64::from(self.index) << self.level;
        (first, first + (1 << self.level))
    }
}

/// Puts a node behind those it follows, and joins neighbours for as long as there are any. Sums that are not needed
/// any more become `spare`: their memory is.
pub(super) fn push(nodes: &mut Vec<Node>, mut node: Node, spare: &mut Vec<Sums>) {
    while let Some(left) =
        nodes.pop_if(|left| left.level == node.level && left.index % 2 == 0 && left.index + 1 == node.index)
    {
        let mut sums = left.sums;
        sums.absorb(&node.sums);
        spare.push(node.sums);
        node = Node { level: node.level + 1, index: node.index / 2, sums };
    }
    nodes.push(node);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(index: u32) -> Node {
        let mut sums = Sums::new(1, 1);
        sums.add(0, 1.0, |_| 1.0 / (index + 1) as f32);
        Node { level: 0, index, sums }
    }

    fn pushed(blocks: impl IntoIterator<Item = u32>) -> Vec<Node> {
        let mut nodes = Vec::new();
        blocks.into_iter().for_each(|index| push(&mut nodes, block(index), &mut Vec::new()));
        nodes
    }

    #[test]
    fn nodes_are_the_binary_digits_of_their_number() {
        for count in 0..40u32 {
            let nodes = pushed(0..count);
            let levels: Vec<u32> = nodes.iter().map(|node| node.level).collect();
            let digits: Vec<u32> = (0..6).rev().filter(|bit| count >> bit & 1 != 0).collect();
            assert_eq!(levels, digits, "{count}");
            let ends: Vec<_> = nodes.iter().map(Node::blocks).collect();
            assert!(ends.windows(2).all(|pair| pair[0].1 == pair[1].0));
        }
    }

    #[test]
    fn pieces_join_to_the_bit_wherever_they_are_cut() {
        for count in 1..20 {
            let whole = pushed(0..count);
            for cut in 0..=count {
                let mut joined = pushed(0..cut);
                pushed(cut..count).into_iter().for_each(|node| push(&mut joined, node, &mut Vec::new()));
                assert_eq!(joined, whole, "{cut} of {count}");
            }
        }
    }
}
