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

/// Samples that are added one after the other.
pub const BLOCK: u32 = 16;

/// Four numbers of a pixel, side by side.
pub type Quad = [f32; 4];

/// The place in a row of what counts samples: 1 in each of them. So the first quad is a colour and its weight, and what
/// is behind it depends on neither.
pub const WEIGHT: usize = 3;

/// The place in a row of a channel's number.
#[inline]
pub fn place(channel: usize) -> usize {
    channel + usize::from(channel >= WEIGHT)
}

/// In a row of so many channels. A pixel's row is all that a sample has to touch; were its channels in planes, their
/// lines would drive each other out of the cache.
pub fn quads(channels: usize) -> usize {
    let numbers = channels + 1;
    numbers.div_ceil(4)
}

/// Sums over the pixels of a tile, of some samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Sums {
    /// Pixel after pixel, a row each: its channels, among them what its samples count together, and zeros.
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
            let at = sums.at(c);
            plane.iter().enumerate().for_each(|(pixel, &value)| *sums.number(pixel, at) = value);
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
        let (rows, at) = (self.rows.chunks_exact(quads(self.channels)), self.at(channel));
        rows.map(move |row| row[at / 4][at % 4])
    }

    /// The place in a row of a channel, or of what is behind the last.
    fn at(&self, channel: usize) -> usize {
        if channel == self.channels { WEIGHT } else { place(channel) }
    }

    /// The number at a place in a pixel's row.
    pub(super) fn number(&mut self, pixel: usize, at: usize) -> &mut f32 {
        let row = pixel * quads(self.channels);
        &mut self.rows[row + at / 4][at % 4]
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
        let (quads, at) = (quads(self.channels), place(channel));
        let rows = self.rows[first * quads..].chunks_exact(quads);
        for ((mean, row), &count) in out.iter_mut().zip(rows).zip(&self.counts[first..]) {
            let (sum, weight) = (row[at / 4][at % 4], row[0][WEIGHT]);
            let quotient = sum / if weight > 0.0 { weight } else { count as f32 };
            *mean = if count == 0 { 0.0 } else { quotient };
        }
    }

    /// A pixel's row, and how many samples it has.
    #[inline]
    pub(super) fn row(&mut self, pixel: usize) -> (&mut [Quad], &mut u32) {
        let quads = quads(self.channels);
        (&mut self.rows[pixel * quads..][..quads], &mut self.counts[pixel])
    }

    #[cfg(test)]
    pub(super) fn mean(&self, pixel: usize, channel: usize) -> f32 {
        let mut mean = [0.0];
        self.means(channel, pixel, &mut mean);
        mean[0]
    }
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
        let sums = Sums::from_planes(&[1.0 / (index + 1) as f32], &[1.0], vec![1]);
        Node { level: 0, index, sums: sums.expect("one pixel, one channel") }
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
