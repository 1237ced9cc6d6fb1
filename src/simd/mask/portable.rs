//! Sets of lanes as registers in which a lane is all ones or all zeros.

macro_rules! set {
    ($name:ident: $float:ident, $int:ident, $bits:expr) => {
        #[derive(Clone, Copy, Debug)]
        pub(in crate::simd) struct $name(pub(in crate::simd) wide::$float);

        impl $name {
            #[inline]
            pub(in crate::simd) fn lt(a: wide::$float, b: wide::$float) -> Self {
                Self(a.simd_lt(b))
            }
            #[inline]
            pub(in crate::simd) fn le(a: wide::$float, b: wide::$float) -> Self {
                Self(a.simd_le(b))
            }
            #[inline]
            pub(in crate::simd) fn equal(a: wide::$float, b: wide::$float) -> Self {
                Self(a.simd_eq(b))
            }
            #[inline]
            pub(in crate::simd) fn equal_bits(a: wide::$int, b: wide::$int) -> Self {
                Self(wide::$float::new(a.simd_eq(b).to_array().map(f32::from_bits)))
            }
            #[inline]
            pub(in crate::simd) fn choose(self, a: wide::$float, b: wide::$float) -> wide::$float {
                self.0.select(a, b)
            }
            #[inline]
            pub(in crate::simd) fn choose_bits(self, a: wide::$int, b: wide::$int) -> wide::$int {
                wide::$int::new(self.0.to_array().map(f32::to_bits)).bitselect(a, b)
            }
            #[inline]
            pub(in crate::simd) fn of_bits(bits: u32) -> Self {
                const BIT: wide::$int = wide::$int::new($bits);
                Self::equal_bits(wide::$int::splat(bits) & BIT, BIT)
            }
            #[inline]
            pub(in crate::simd) fn splat(value: bool) -> Self {
                Self(wide::$float::splat(f32::from_bits(if value { u32::MAX } else { 0 })))
            }
            #[inline]
            pub(in crate::simd) fn bits(self) -> u32 {
                self.0.to_bitmask()
            }
            #[inline]
            pub(in crate::simd) fn any(self) -> bool {
                self.0.any()
            }
        }
    };
}
set!(Set8: f32x8, u32x8, [1, 2, 4, 8, 16, 32, 64, 128]);
set!(Set16: f32x16, u32x16, [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768]);
