//! Sampling of tables by their running sums, eight at a time.
//!
//! The inverse of a running sum keeps the order of the numbers that go in, so what is stratified before
//! is stratified after; an alias table would not.

use crate::simd::{Bits, Real};

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Appends the running sums of weights, from 0 to exactly 1, and returns their total. Weights that add up
/// to 0 are taken as equal.
pub(super) fn push_sums(weights: &[f64], sums: &mut Vec<f32>) -> f64 {
    let total: f64 = weights.iter().sum();
    let equal = 1.0 / weights.len() as f64;
    let mut below = 0.0;
    sums.push(0.0);
    sums.extend(weights.iter().map(|weight| {
        below += if total > 0.0 { weight / total } else { equal };
        below.min(1.0) as f32
    }));
    // What is left by rounding belongs to the last that has a weight, not to those behind it.
    let last = sums[sums.len() - 1];
    for sum in sums.iter_mut().rev().take_while(|sum| **sum == last) {
        *sum = 1.0;
    }
    total
}

/// Where `u` falls in tables of `count` intervals, the lanes' tables starting at `first`: the place of the
/// interval's lower sum, and how far into the interval, in [0, 1). Intervals of weight 0 are never found.
///
/// Bisection without branches: all lanes take the same steps, and their loads do not wait for each other.
#[inline]
pub(super) fn find<R: Real>(sums: &[f32], first: R::Bits, count: usize, u: R) -> (R::Bits, R) {
    let (mut at, mut left) = (first, count);
    while left > 1 {
        let half = left / 2;
        let middle = at.wrapping_add(R::Bits::splat(half as u32));
        let sum = R::from_fn(|i| sums[middle.lane(i) as usize]);
        at = R::Bits::select(sum.le(u), middle, at);
        left -= half;
    }
    let low = R::from_fn(|i| sums[at.lane(i) as usize]);
    let high = R::from_fn(|i| sums[at.lane(i) as usize + 1]);
    (at, ((u - low) / (high - low)).clamp(0.0, BELOW_ONE))
}

/// A number in [0, 1) with a density that goes linearly from `a` at 0 to `b` at 1, neither negative:
/// the root of a quadratic equation, written so that nothing cancels.
#[inline]
pub(super) fn linear<R: Real>(u: R, a: R, b: R) -> R {
    let sum = a + b;
    let (a, b) = (a / sum, b / sum);
    let x = u / (a + ((R::one() - u) * a * a + u * b * b).sqrt());
    R::select(x.ge(R::zero()), x, u).min(R::splat(BELOW_ONE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::f32x8;

    #[test]
    fn intervals_are_found_by_their_weights() {
        let mut sums = vec![-7.0; 3];
        let total = push_sums(&[0.0, 1.0, 0.0, 2.0, 1.0, 0.0], &mut sums);
        assert_eq!(total, 4.0);
        assert_eq!(sums[3..], [0.0, 0.0, 0.25, 0.25, 0.75, 1.0, 1.0]);
        for (u, at, rest) in [(0.0, 1, 0.0), (0.125, 1, 0.5), (0.25, 3, 0.0), (0.5, 3, 0.5), (0.875, 4, 0.5)]
        {
            assert_eq!(find::<f32>(&sums, 3, 6, u), (3 + at, rest), "{u}");
        }
        let (last, rest) = find::<f32>(&sums, 3, 6, BELOW_ONE);
        assert!(last == 7 && rest < 1.0);
    }

    #[test]
    fn what_weighs_nothing_is_never_drawn() {
        let mut sums = Vec::new();
        push_sums(&[0.1, 1e-30, 0.7, 0.0, 0.0], &mut sums);
        for i in 0..1 << 16 {
            let (at, _) = find::<f32>(&sums, 0, 5, i as f32 / 65536.0);
            assert!(at < 3, "{at}");
        }
        assert_eq!(find::<f32>(&sums, 0, 5, BELOW_ONE).0, 2);
        let mut black = Vec::new();
        assert_eq!(push_sums(&[0.0; 4], &mut black), 0.0);
        assert_eq!(black, [0.0, 0.25, 0.5, 0.75, 1.0]);
    }

    #[test]
    fn lanes_have_the_scalar_bits() {
        let mut sums = Vec::new();
        let weight = |i: u32| f64::from(i.wrapping_mul(0x9e37_79b9) >> 24);
        push_sums(&(0..1000).map(weight).collect::<Vec<_>>(), &mut sums);
        for i in 0..1000 {
            let u = f32x8::from_fn(|k| ((i * 8 + k) as f32 * 0.618_034).fract());
            let (at, rest) = find(&sums, Bits::splat(0), 1000, u);
            let slope = linear(u, rest, u);
            for k in 0..8 {
                let one = find::<f32>(&sums, 0, 1000, u.lane(k));
                assert_eq!((at.lane(k), rest.lane(k).to_bits()), (one.0, one.1.to_bits()));
                assert_eq!(slope.lane(k).to_bits(), linear(u.lane(k), one.1, u.lane(k)).to_bits());
            }
        }
    }

    #[test]
    fn linear_densities_have_their_moments() {
        for (a, b) in [(1.0, 1.0), (0.0, 3.0), (3.0, 0.0), (1e20, 3e20), (1e-30, 5e-30)] {
            let n = 1 << 16;
            let mean =
                (0..n).map(|i| f64::from(linear::<f32>((i as f32 + 0.5) / n as f32, a, b))).sum::<f64>()
                    / f64::from(n);
            // ∫ x (a + (b − a)x) dx / ∫ (a + (b − a)x) dx.
            let want = (f64::from(a) / 6.0 + f64::from(b) / 3.0) / (0.5 * (f64::from(a) + f64::from(b)));
            assert!((mean - want).abs() < 1e-6, "{a} {b}: {mean} {want}");
        }
        assert_eq!(linear(0.3f32, 0.0, 0.0), 0.3);
    }
}
