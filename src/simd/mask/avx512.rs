//! Sets of lanes as bits: AVX-512 has registers for them.

use std::arch::x86_64::{
    __m256, __m256i, __m512, __m512i, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm256_cmp_ps_mask,
    _mm256_cmpeq_epu32_mask, _mm256_loadu_ps, _mm256_loadu_si256, _mm256_mask_blend_epi32,
    _mm256_mask_blend_ps, _mm256_storeu_ps, _mm256_storeu_si256, _mm512_cmp_ps_mask, _mm512_cmpeq_epu32_mask,
    _mm512_loadu_ps, _mm512_loadu_si512, _mm512_mask_blend_epi32, _mm512_mask_blend_ps, _mm512_storeu_ps,
    _mm512_storeu_si512,
};

macro_rules! set {
    (
        $name:ident($bits:ident): $float:ident, $int:ident, $lanes:literal, $floats:ident, $integers:ident,
        $load:ident, $load_bits:ident, $store:ident, $store_bits:ident,
        $compare:ident, $equal:ident, $blend:ident, $blend_bits:ident
    ) => {
        #[derive(Clone, Copy, Debug)]
        pub(in crate::simd) struct $name(pub(in crate::simd) $bits);

        impl $name {
            #[inline]
            fn floats(lanes: wide::$float) -> $floats {
                // SAFETY: the feature is compiled in, and an array of as many floats is what is read.
                unsafe { $load(lanes.to_array().as_ptr()) }
            }
            #[inline]
            fn integers(lanes: wide::$int) -> $integers {
                // SAFETY: the feature is compiled in, and an array of as many integers is what is read.
                unsafe { $load_bits(lanes.to_array().as_ptr().cast()) }
            }
            #[inline]
            pub(in crate::simd) fn lt(a: wide::$float, b: wide::$float) -> Self {
                // SAFETY: the feature is compiled in.
                Self(unsafe { $compare::<_CMP_LT_OQ>(Self::floats(a), Self::floats(b)) })
            }
            #[inline]
            pub(in crate::simd) fn le(a: wide::$float, b: wide::$float) -> Self {
                // SAFETY: the feature is compiled in.
                Self(unsafe { $compare::<_CMP_LE_OQ>(Self::floats(a), Self::floats(b)) })
            }
            #[inline]
            pub(in crate::simd) fn equal(a: wide::$float, b: wide::$float) -> Self {
                // SAFETY: the feature is compiled in.
                Self(unsafe { $compare::<_CMP_EQ_OQ>(Self::floats(a), Self::floats(b)) })
            }
            #[inline]
            pub(in crate::simd) fn equal_bits(a: wide::$int, b: wide::$int) -> Self {
                // SAFETY: the feature is compiled in.
                Self(unsafe { $equal(Self::integers(a), Self::integers(b)) })
            }
            #[inline]
            pub(in crate::simd) fn choose(self, a: wide::$float, b: wide::$float) -> wide::$float {
                let mut out = [0.0; $lanes];
                // SAFETY: the feature is compiled in, and an array of as many floats is what is written.
                unsafe { $store(out.as_mut_ptr(), $blend(self.0, Self::floats(b), Self::floats(a))) };
                wide::$float::new(out)
            }
            #[inline]
            pub(in crate::simd) fn choose_bits(self, a: wide::$int, b: wide::$int) -> wide::$int {
                let mut out = [0u32; $lanes];
                // SAFETY: the feature is compiled in, and an array of as many integers is what is written.
                unsafe {
                    let lanes = $blend_bits(self.0, Self::integers(b), Self::integers(a));
                    $store_bits(out.as_mut_ptr().cast(), lanes);
                }
                wide::$int::new(out)
            }
            #[inline]
            pub(in crate::simd) fn of_bits(bits: u32) -> Self {
                Self(bits as $bits)
            }
            #[inline]
            pub(in crate::simd) fn splat(value: bool) -> Self {
                Self(if value { $bits::MAX } else { 0 })
            }
            #[inline]
            pub(in crate::simd) fn bits(self) -> u32 {
                u32::from(self.0)
            }
            #[inline]
            pub(in crate::simd) fn any(self) -> bool {
                self.0 != 0
            }
        }
    };
}
set!(
    Set8(u8): f32x8, u32x8, 8, __m256, __m256i, _mm256_loadu_ps, _mm256_loadu_si256, _mm256_storeu_ps,
    _mm256_storeu_si256, _mm256_cmp_ps_mask, _mm256_cmpeq_epu32_mask, _mm256_mask_blend_ps, _mm256_mask_blend_epi32
);
set!(
    Set16(u16): f32x16, u32x16, 16, __m512, __m512i, _mm512_loadu_ps, _mm512_loadu_si512, _mm512_storeu_ps,
    _mm512_storeu_si512, _mm512_cmp_ps_mask, _mm512_cmpeq_epu32_mask, _mm512_mask_blend_ps, _mm512_mask_blend_epi32
);
