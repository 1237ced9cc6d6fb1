//! Lanes moved together.

use super::{f32x8, u32x8};

/// The lanes where a ≤ b: lane i is bit i. NaN is no.
#[inline]
pub fn le_bits(a: f32x8, b: f32x8) -> u8 {
    #[cfg(all(target_arch = "x86_64", target_feature = "avx512vl"))]
    return avx512::le_bits(a, b);
    #[cfg(not(all(target_arch = "x86_64", target_feature = "avx512vl")))]
    return portable::le_bits(a, b);
}

/// The same without the lanes where `words` are `never`.
#[inline]
pub fn le_bits_unless(a: f32x8, b: f32x8, words: u32x8, never: u32) -> u8 {
    #[cfg(all(target_arch = "x86_64", target_feature = "avx512vl"))]
    return avx512::le_bits_unless(a, b, words, never);
    #[cfg(not(all(target_arch = "x86_64", target_feature = "avx512vl")))]
    return portable::le_bits_unless(a, b, words, never);
}

/// The lanes of `values` whose bit is set, in order from the first lane on, and 0 behind them.
#[inline]
pub fn compress(values: u32x8, bits: u8) -> u32x8 {
    #[cfg(all(target_arch = "x86_64", target_feature = "avx512vl"))]
    return avx512::compress(values, bits);
    #[cfg(not(all(target_arch = "x86_64", target_feature = "avx512vl")))]
    return portable::compress(values, bits);
}

/// What every target can do.
#[cfg(any(test, not(all(target_arch = "x86_64", target_feature = "avx512vl"))))]
pub(super) mod portable {
    use super::{f32x8, u32x8};
    use crate::simd::{Bits, Mask, Mask8, Real};

    /// For each set of lanes, the lanes in it and then the others.
    static ORDERS: [[u32; 8]; 256] = orders();

    const fn orders() -> [[u32; 8]; 256] {
        let mut orders = [[0; 8]; 256];
        let mut bits = 0;
        while bits < 256 {
            let (mut inside, mut outside) = (0, (bits as u32).count_ones() as usize);
            let mut lane = 0;
            while lane < 8 {
                if bits >> lane & 1 != 0 {
                    orders[bits][inside] = lane;
                    inside += 1;
                } else {
                    orders[bits][outside] = lane;
                    outside += 1;
                }
                lane += 1;
            }
            bits += 1;
        }
        orders
    }

    #[inline]
    pub(in crate::simd) fn le_bits(a: f32x8, b: f32x8) -> u8 {
        a.le(b).to_bitmask() as u8
    }

    #[inline]
    pub(in crate::simd) fn le_bits_unless(a: f32x8, b: f32x8, words: u32x8, never: u32) -> u8 {
        (a.le(b) & !words.equal(u32x8::splat(never))).to_bitmask() as u8
    }

    #[inline]
    pub(in crate::simd) fn compress(values: u32x8, bits: u8) -> u32x8 {
        let chosen = u32x8::select(Mask8::from_bitmask(u32::from(bits)), values, u32x8::splat(0));
        chosen.shuffle(u32x8::new(ORDERS[usize::from(bits)]))
    }
}

/// AVX-512 has a register of masks and one instruction for each of the two.
#[cfg(all(target_arch = "x86_64", target_feature = "avx512vl"))]
#[allow(unsafe_code)]
mod avx512 {
    use std::arch::x86_64::{
        __m256, __m256i, _CMP_LE_OQ, _mm256_cmp_ps_mask, _mm256_cmpneq_epu32_mask, _mm256_loadu_ps,
        _mm256_loadu_si256, _mm256_mask_cmp_ps_mask, _mm256_maskz_compress_epi32, _mm256_storeu_si256,
    };

    use super::{f32x8, u32x8};
    use crate::simd::Bits;

    #[inline]
    fn floats(lanes: f32x8) -> __m256 {
        // SAFETY: the feature is compiled in, and an array of eight floats is what is read.
        unsafe { _mm256_loadu_ps(lanes.to_array().as_ptr()) }
    }

    #[inline]
    pub(super) fn le_bits(a: f32x8, b: f32x8) -> u8 {
        // SAFETY: the feature is compiled in.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(floats(a), floats(b)) }
    }

    #[inline]
    fn integers(lanes: u32x8) -> __m256i {
        // SAFETY: the feature is compiled in, and an array of eight integers is what is read.
        unsafe { _mm256_loadu_si256(lanes.to_array().as_ptr().cast::<__m256i>()) }
    }

    #[inline]
    pub(super) fn le_bits_unless(a: f32x8, b: f32x8, words: u32x8, never: u32) -> u8 {
        // SAFETY: the feature is compiled in.
        unsafe {
            let lanes = _mm256_cmpneq_epu32_mask(integers(words), integers(u32x8::splat(never)));
            _mm256_mask_cmp_ps_mask::<_CMP_LE_OQ>(lanes, floats(a), floats(b))
        }
    }

    #[inline]
    pub(super) fn compress(values: u32x8, bits: u8) -> u32x8 {
        let mut out = [0; 8];
        // SAFETY: the feature is compiled in, and an array of eight integers is what is written.
        unsafe {
            let lanes = _mm256_maskz_compress_epi32(bits, integers(values));
            _mm256_storeu_si256(out.as_mut_ptr().cast::<__m256i>(), lanes);
        }
        u32x8::new(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_of_lanes_moves_to_the_front() {
        let values = std::array::from_fn(|i| 10 + i as u32);
        for bits in 0..=u8::MAX {
            let mut expected = [0; 8];
            let chosen = (0..8).filter(|i| bits >> i & 1 != 0).map(|i| values[i]);
            expected.iter_mut().zip(chosen).for_each(|(to, from)| *to = from);
            assert_eq!(compress(u32x8::new(values), bits).to_array(), expected, "{bits:08b}");
            assert_eq!(portable::compress(u32x8::new(values), bits).to_array(), expected, "{bits:08b}");
        }
    }

    #[test]
    fn bits_of_a_comparison() {
        let a = f32x8::new([1.0, 2.0, 3.0, f32::NAN, -0.0, f32::INFINITY, 1.0, -1.0]);
        let b = f32x8::new([1.0, 1.0, 4.0, 1.0, 0.0, f32::INFINITY, f32::NAN, f32::NEG_INFINITY]);
        assert_eq!(le_bits(a, b), 0b0011_0101);
        assert_eq!(portable::le_bits(a, b), 0b0011_0101);
        let words = u32x8::new([9, 0, 7, 0, 9, 8, 9, 9]);
        assert_eq!(le_bits_unless(a, b, words, 9), 0b0010_0100);
        assert_eq!(portable::le_bits_unless(a, b, words, 9), 0b0010_0100);
    }
}
