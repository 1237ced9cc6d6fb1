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

use crate::simd::{LANES, f32x8};

/// Samples that are added one after the other.
pub const BLOCK: u32 = 16;

/// Sums over the pixels of a tile, of some samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Sums {
    /// Channel after channel, in each pixel after pixel.
    pub values: Vec<f32>,
    /// What the samples of each pixel count together.
    pub weights: Vec<f32>,
    /// How many there are of each pixel.
    pub counts: Vec<u32>,
}

impl Sums {
    pub(super) fn new(pixels: usize, channels: usize) -> Self {
        Self { values: vec![0.0; pixels * channels], weights: vec![0.0; pixels], counts: vec![0; pixels] }
    }

    /// The same memory, of no samples.
    pub(super) fn cleared(mut self) -> Self {
        self.values.fill(0.0);
        self.weights.fill(0.0);
        self.counts.fill(0);
        self
    }

    #[inline]
    pub(super) fn add(&mut self, pixel: usize, weight: f32, value: impl Fn(usize) -> f32) {
        let pixels = self.counts.len();
        for (c, plane) in self.values.chunks_exact_mut(pixels).enumerate() {
            plane[pixel] += value(c) * weight;
        }
        self.weights[pixel] += weight;
        self.counts[pixel] += 1;
    }

    /// The same for eight neighbours from `first` on: `values` are channel by channel.
    #[inline]
    pub(super) fn add_eight(&mut self, first: usize, weights: f32x8, values: &[f32x8]) {
        let pixels = self.counts.len();
        let add = |numbers: &mut [f32], more: f32x8| {
            if let Some(eight) = numbers[first..].first_chunk_mut::<LANES>() {
                *eight = (f32x8::new(*eight) + more).to_array();
            }
        };
        for (plane, &value) in self.values.chunks_exact_mut(pixels).zip(values) {
            add(plane, value * weights);
        }
        add(&mut self.weights, weights);
        self.counts[first..first + LANES].iter_mut().for_each(|count| *count += 1);
    }

    /// These and later ones.
    pub fn absorb(&mut self, later: &Self) {
        for (sum, more) in self.values.iter_mut().zip(&later.values) {
            *sum += more;
        }
        for (sum, more) in self.weights.iter_mut().zip(&later.weights) {
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
        let pixels = first..first + out.len();
        let sums = &self.values[channel * self.counts.len()..][pixels.clone()];
        let weighed = self.weights[pixels.clone()].iter().zip(&self.counts[pixels]);
        for ((mean, &sum), (&weight, &count)) in out.iter_mut().zip(sums).zip(weighed) {
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

/// Puts a node behind those it follows, and joins neighbours for as long as there are any. Returns sums that are
/// not needed any more, if there are any: their memory is.
pub(super) fn push(nodes: &mut Vec<Node>, mut node: Node) -> Option<Sums> {
    let mut free = None;
    while let Some(left) =
        nodes.pop_if(|left| left.level == node.level && left.index % 2 == 0 && left.index + 1 == node.index)
    {
        let mut sums = left.sums;
        sums.absorb(&node.sums);
        free = Some(node.sums);
        node = Node { level: node.level + 1, index: node.index / 2, sums };
    }
    nodes.push(node);
    free
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
        blocks.into_iter().for_each(|index| drop(push(&mut nodes, block(index))));
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
                pushed(cut..count).into_iter().for_each(|node| drop(push(&mut joined, node)));
                assert_eq!(joined, whole, "{cut} of {count}");
            }
        }
    }
}
