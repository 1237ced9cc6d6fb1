//! Random numbers that belong to the path.
//!
//! A number is a function of (pixel, sample, dimension) and of nothing else. Dimensions come in pairs:
//! each pair is a two-dimensional Sobol' sequence over the pixel's samples, with its order shuffled and
//! its values Owen-scrambled by hashes of the path and of the pair \[Bur20\]. Any power of two of samples
//! is stratified in every elementary interval of each pair, and pairs are independent of each other.

use crate::simd::{Bits, Real};

/// Identifies a path: the pixel, the seed of the render and, where a path has branched, the branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathKey(pub u32);

impl PathKey {
    /// The key of all paths through pixel (x, y).
    #[inline]
    pub fn new(x: u32, y: u32, seed: u32) -> Self {
        Self(Self::of_pixels(x, y, seed))
    }

    /// The same for pixels in lanes.
    #[inline]
    pub fn of_pixels<B: Bits>(x: B, y: B, seed: u32) -> B {
        mix(x ^ mix(y ^ B::splat(mix(seed ^ 0x9e37_79b9))))
    }
}

/// The sequences of some paths, each at a sample.
#[derive(Clone, Copy, Debug)]
pub struct Sampler<R: Real> {
    key: R::Bits,
    /// Bit-reversed.
    sample: R::Bits,
}

impl<R: Real> Sampler<R> {
    /// The sampler of the paths with these [`PathKey`]s at these samples of their pixels.
    #[inline]
    pub fn new(key: R::Bits, sample: R::Bits) -> Self {
        Self { key, sample: sample.reverse_bits() }
    }

    /// Two numbers in [0, 1) from a pair of dimensions.
    #[inline]
    pub fn pair(&self, pair: u32) -> (R, R) {
        let [numbers] = self.pairs([pair]);
        numbers
    }

    /// Several pairs. Each is a chain of multiplications that wait for one another; two or three chains take hardly
    /// longer than one.
    #[inline]
    pub fn pairs<const N: usize>(&self, pairs: [u32; N]) -> [(R, R); N] {
        let seeds = pairs.map(|pair| mix(self.key ^ R::Bits::splat(mix(pair.wrapping_mul(0x9e37_79b9)))));
        // Reversed indices throughout: the first Sobol' dimension reversed is the index itself.
        let indices = seeds.map(|seed| laine_karras(self.sample, seed).reverse_bits());
        std::array::from_fn(|i| {
            let (seed, index) = (seeds[i], indices[i]);
            let first = laine_karras(index, mix(seed ^ R::Bits::splat(0xa511_e9b3)));
            let second = laine_karras(sobol_second_reversed(index), mix(seed ^ R::Bits::splat(0x63d8_3595)));
            (to_unit(first.reverse_bits()), to_unit(second.reverse_bits()))
        })
    }

    /// The key of the other branch where a path splits in two.
    #[inline]
    pub fn branch_key(&self) -> R::Bits {
        mix(self.key ^ R::Bits::splat(0x5bd1_e995))
    }
}

/// The top 24 bits as a number in [0, 1).
#[inline]
fn to_unit<R: Real>(bits: R::Bits) -> R {
    R::from_int(bits >> 8) * R::splat(1.0 / 16_777_216.0)
}

/// A permutation of 32-bit integers with good avalanche (Wellons' "lowbias32").
#[inline]
fn mix<B: Bits>(x: B) -> B {
    let x = (x ^ (x >> 16)).wrapping_mul(B::splat(0x7feb_352d));
    let x = (x ^ (x >> 15)).wrapping_mul(B::splat(0x846c_a68b));
    x ^ (x >> 16)
}

/// Owen scrambling of a bit-reversed number: each bit is flipped by a hash of the bits below it, that
/// is, of the higher digits before reversal. Constants by Vegdahl (2021).
#[inline]
fn laine_karras<B: Bits>(x: B, seed: B) -> B {
    let x = x ^ x.wrapping_mul(B::splat(0x3d20_adea));
    let x = x.wrapping_add(seed);
    let x = x.wrapping_mul((seed >> 16) | B::splat(1));
    let x = x ^ x.wrapping_mul(B::splat(0x0552_6c56));
    x ^ x.wrapping_mul(B::splat(0x53a2_2864))
}

/// The second Sobol' dimension of an index, bit-reversed. Its generator matrix is Pascal's triangle
/// modulo 2, a Kronecker power of ((1 1) (0 1)): five steps in place of thirty-two columns.
#[inline]
fn sobol_second_reversed<B: Bits>(index: B) -> B {
    let x = index;
    let x = x ^ ((x >> 16) & B::splat(0x0000_ffff));
    let x = x ^ ((x >> 8) & B::splat(0x00ff_00ff));
    let x = x ^ ((x >> 4) & B::splat(0x0f0f_0f0f));
    let x = x ^ ((x >> 2) & B::splat(0x3333_3333));
    x ^ ((x >> 1) & B::splat(0x5555_5555))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{f32x8, u32x8};

    fn points(key: u32, pair: u32, count: u32) -> Vec<(f32, f32)> {
        (0..count).map(|i| Sampler::<f32>::new(key, i).pair(pair)).collect()
    }

    #[test]
    fn every_elementary_interval_holds_one_point() {
        for key in [1, 77, 0xdead_beef] {
            let points = points(key, 3, 256);
            for log_columns in 0..=8 {
                let (columns, rows) = (1 << log_columns, 256 >> log_columns);
                let mut seen = vec![false; 256];
                for &(x, y) in &points {
                    let cell = (x * columns as f32) as usize * rows + (y * rows as f32) as usize;
                    assert!(
                        !std::mem::replace(&mut seen[cell], true),
                        "two points in a {columns} x {rows} cell"
                    );
                }
            }
        }
    }

    #[test]
    fn second_dimension_is_the_sobol_sequence() {
        // The first points of the unscrambled sequence: 0, 1/2, 3/4, 1/4, 5/8, 1/8, 3/8, 7/8.
        let want = [0.0, 0.5, 0.75, 0.25, 0.625, 0.125, 0.375, 0.875];
        for (index, want) in want.into_iter().enumerate() {
            let got: f32 = to_unit(sobol_second_reversed(index as u32).reverse_bits());
            assert_eq!(got, want, "{index}");
        }
    }

    #[test]
    fn several_pairs_are_one_by_one() {
        let sampler = Sampler::<f32>::new(99, 13);
        assert_eq!(sampler.pairs([4, 0, 7]), [4, 0, 7].map(|pair| sampler.pair(pair)));
    }

    #[test]
    fn pairs_and_pixels_are_uncorrelated() {
        let correlation = |a: &[(f32, f32)], b: &[(f32, f32)]| {
            let n = a.len() as f64;
            a.iter().zip(b).map(|(p, q)| f64::from(p.0 - 0.5) * f64::from(q.0 - 0.5)).sum::<f64>() / n * 12.0
        };
        let base = points(5, 0, 4096);
        for (key, pair) in [(5, 1), (5, 2), (6, 0), (9, 7)] {
            let c = correlation(&base, &points(key, pair, 4096));
            assert!(c.abs() < 0.08, "key {key} pair {pair}: {c}");
        }
    }

    #[test]
    fn lanes_have_the_scalar_bits() {
        let keys = u32x8::from_fn(|i| PathKey::new(i as u32, 4, 1).0);
        for first in [0, 1, 7, 255, 65_537] {
            let samples = u32x8::from_fn(|i| first + i as u32 / 2);
            let (x, y) = Sampler::<f32x8>::new(keys, samples).pair(9);
            for lane in 0..8 {
                let scalar = Sampler::<f32>::new(keys.lane(lane), samples.lane(lane)).pair(9);
                assert_eq!(
                    (x.lane(lane).to_bits(), y.lane(lane).to_bits()),
                    (scalar.0.to_bits(), scalar.1.to_bits())
                );
            }
        }
    }
}
