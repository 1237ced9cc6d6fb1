//! Lanes moved together.

use super::u32x8;

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
    use super::u32x8;
    use crate::simd::{Bits, Mask, Mask8};

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
    pub(in crate::simd) fn compress(values: u32x8, bits: u8) -> u32x8 {
        let chosen = u32x8::select(Mask8::from_bitmask(u32::from(bits)), values, u32x8::splat(0));
        chosen.shuffle(u32x8::new(ORDERS[usize::from(bits)]))
    }
}

/// AVX-512 has an instruction for it.
#[cfg(all(target_arch = "x86_64", target_feature = "avx512vl"))]
#[allow(unsafe_code)]
mod avx512 {
    use std::arch::x86_64::{__m256i, _mm256_loadu_si256, _mm256_maskz_compress_epi32, _mm256_storeu_si256};

    use super::u32x8;

    #[inline]
    fn integers(lanes: u32x8) -> __m256i {
        // SAFETY: the feature is compiled in, and an array of eight integers is what is read.
        unsafe { _mm256_loadu_si256(lanes.to_array().as_ptr().cast::<__m256i>()) }
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
}
