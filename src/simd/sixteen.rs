//! Sixteen lanes: two packets at once, in one register where there is AVX-512.

use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

use super::{Bits, Mask16, Real, f32x8, mask::Set16, transpose, u32x8};

/// Sixteen `f32`, one a lane. Equality of bits with sixteen scalars is the contract.
#[allow(non_camel_case_types)]
#[derive(Clone, Copy, Debug, Default)]
#[repr(transparent)]
pub struct f32x16(wide::f32x16);

/// Sixteen `u32`, one a lane, wrapping.
#[allow(non_camel_case_types)]
#[derive(Clone, Copy, Debug, Default)]
#[repr(transparent)]
pub struct u32x16(wide::u32x16);

/// Does one register hold sixteen lanes? Where it takes two, a kernel that keeps many numbers has too few of them,
/// and had better see the halves one after the other.
pub const ONE_REGISTER: bool = cfg!(all(target_arch = "x86_64", target_feature = "avx512f"));

/// Most lanes in which anything is shaded: as many as one register has, and eight at least.
pub const MOST: usize = if ONE_REGISTER { 16 } else { 8 };

/// Lanes that come in eights.
pub trait Eights: Real {
    /// Lanes 8i to 8i + 7.
    fn eight(&self, i: usize) -> f32x8;
    /// Lanes 8i to 8i + 7 are `f(i)`.
    fn of_eights(f: impl Fn(usize) -> f32x8) -> Self;
}

impl Eights for f32x8 {
    #[inline(always)]
    fn eight(&self, _: usize) -> f32x8 {
        *self
    }

    #[inline(always)]
    fn of_eights(f: impl Fn(usize) -> f32x8) -> Self {
        f(0)
    }
}

impl Eights for f32x16 {
    #[inline(always)]
    fn eight(&self, i: usize) -> f32x8 {
        self.half(i)
    }

    #[inline(always)]
    fn of_eights(f: impl Fn(usize) -> f32x8) -> Self {
        Self::of_halves([f(0), f(1)])
    }
}

impl f32x16 {
    /// Lane `i` is `lanes[i]`.
    #[inline]
    pub const fn new(lanes: [f32; 16]) -> Self {
        Self(wide::f32x16::new(lanes))
    }

    /// Lane `i` is element `i`.
    #[inline]
    pub fn to_array(self) -> [f32; 16] {
        self.0.to_array()
    }

    /// Lanes 0 to 7 and 8 to 15.
    #[inline]
    pub fn halves(self) -> [f32x8; 2] {
        [self.half(0), self.half(1)]
    }

    /// Lanes 0 to 7 and 8 to 15.
    #[inline(always)]
    pub fn of_halves([low, high]: [f32x8; 2]) -> Self {
        let (low, high) = (low.to_array(), high.to_array());
        Self::from_fn(|i| if i < 8 { low[i] } else { high[i - 8] })
    }

    /// Lanes 8i to 8i + 7; from memory, where the number is not known beforehand.
    #[inline(always)]
    pub fn half(&self, i: usize) -> f32x8 {
        let lanes = self.0.as_array();
        let at = |lane: usize| lanes[i * 8 + lane];
        f32x8::new([at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)])
    }

    /// Replaces lanes 8i to 8i + 7.
    #[inline(always)]
    pub fn put_half(&mut self, i: usize, half: f32x8) {
        self.0.as_mut_array()[i * 8..i * 8 + 8].copy_from_slice(&half.to_array());
    }

    /// Lanes 4i to 4i + 3.
    #[inline]
    pub fn quarter(&self, i: usize) -> [f32; 4] {
        let lanes = self.0.as_array();
        [lanes[i * 4], lanes[i * 4 + 1], lanes[i * 4 + 2], lanes[i * 4 + 3]]
    }

    /// Replaces lanes 4i to 4i + 3.
    #[inline]
    pub fn put_quarter(&mut self, i: usize, quarter: [f32; 4]) {
        self.0.as_mut_array()[i * 4..i * 4 + 4].copy_from_slice(&quarter);
    }

    /// As [`f32x8::fused`].
    #[inline]
    pub fn fused(self, factor: Self, addend: Self) -> Self {
        Self(self.0.mul_add(factor.0, addend.0))
    }

    /// The least lane; lanes that are NaN may or may not count.
    #[inline]
    pub fn reduce_min(self) -> f32 {
        let [low, high] = self.halves();
        low.min(high).reduce_min()
    }

    /// The greatest lane; lanes that are NaN may or may not count.
    #[inline]
    pub fn reduce_max(self) -> f32 {
        let [low, high] = self.halves();
        low.max(high).reduce_max()
    }
}

impl u32x16 {
    /// Lanes 8i to 8i + 7.
    #[inline(always)]
    pub fn half(&self, i: usize) -> u32x8 {
        let lanes = self.0.as_array();
        let at = |lane: usize| lanes[i * 8 + lane];
        u32x8::new([at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)])
    }

    /// Replaces lanes 8i to 8i + 7.
    #[inline(always)]
    pub fn put_half(&mut self, i: usize, half: u32x8) {
        self.0.as_mut_array()[i * 8..i * 8 + 8].copy_from_slice(&half.to_array());
    }

    /// Lanes 4i to 4i + 3.
    #[inline]
    pub fn quarter(&self, i: usize) -> [u32; 4] {
        let lanes = self.0.as_array();
        [lanes[i * 4], lanes[i * 4 + 1], lanes[i * 4 + 2], lanes[i * 4 + 3]]
    }
}

macro_rules! lane_by_lane {
    ($name:ident: $($trait:ident $verb:ident $op:tt),*) => {$(
        impl $trait for $name {
            type Output = Self;
            #[inline]
            fn $verb(self, rhs: Self) -> Self {
                Self(self.0 $op rhs.0)
            }
        }
    )*};
}
lane_by_lane!(f32x16: Add add +, Sub sub -, Mul mul *, Div div /);
lane_by_lane!(u32x16: BitAnd bitand &, BitOr bitor |, BitXor bitxor ^);

impl Neg for f32x16 {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Not for u32x16 {
    type Output = Self;
    #[inline]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Shl<u32> for u32x16 {
    type Output = Self;
    #[inline]
    fn shl(self, rhs: u32) -> Self {
        Self(self.0 << rhs)
    }
}

impl Shr<u32> for u32x16 {
    type Output = Self;
    #[inline]
    fn shr(self, rhs: u32) -> Self {
        Self(self.0 >> rhs)
    }
}

impl Bits for u32x16 {
    type Mask = Mask16;

    #[inline]
    fn splat(value: u32) -> Self {
        Self(wide::u32x16::splat(value))
    }
    #[inline]
    fn from_fn(f: impl FnMut(usize) -> u32) -> Self {
        Self(wide::u32x16::new(std::array::from_fn(f)))
    }
    #[inline]
    fn lane(self, i: usize) -> u32 {
        self.0.as_array()[i]
    }
    #[inline]
    fn wrapping_add(self, rhs: Self) -> Self {
        Self(self.0 + rhs.0)
    }
    #[inline]
    fn wrapping_mul(self, rhs: Self) -> Self {
        Self(self.0 * rhs.0)
    }
    #[inline]
    fn reverse_bits(self) -> Self {
        Self(wide::u32x16::new(self.0.to_array().map(u32::reverse_bits)))
    }
    #[inline]
    fn equal(self, rhs: Self) -> Mask16 {
        Mask16(Set16::equal_bits(self.0, rhs.0))
    }
    #[inline]
    fn select(mask: Mask16, a: Self, b: Self) -> Self {
        Self(mask.0.choose_bits(a.0, b.0))
    }
}

impl Real for f32x16 {
    const LANES: usize = 16;
    type Mask = Mask16;
    type Bits = u32x16;

    #[inline]
    fn splat(value: f32) -> Self {
        Self(wide::f32x16::splat(value))
    }
    #[inline]
    fn from_fn(f: impl FnMut(usize) -> f32) -> Self {
        Self::new(std::array::from_fn(f))
    }
    #[inline]
    fn from_rows(mut row: impl FnMut(usize) -> [f32; 8]) -> [Self; 8] {
        let low = transpose(std::array::from_fn(|i| f32x8::new(row(i))));
        let high = transpose(std::array::from_fn(|i| f32x8::new(row(i + 8))));
        std::array::from_fn(|k| Self::of_halves([low[k], high[k]]))
    }
    #[inline]
    fn lane(self, i: usize) -> f32 {
        self.0.as_array()[i]
    }
    #[inline]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline]
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline]
    fn lt(self, rhs: Self) -> Mask16 {
        Mask16(Set16::lt(self.0, rhs.0))
    }
    #[inline]
    fn le(self, rhs: Self) -> Mask16 {
        Mask16(Set16::le(self.0, rhs.0))
    }
    #[inline]
    fn equal(self, rhs: Self) -> Mask16 {
        Mask16(Set16::equal(self.0, rhs.0))
    }
    #[inline]
    fn select(mask: Mask16, a: Self, b: Self) -> Self {
        Self(mask.0.choose(a.0, b.0))
    }
    // As for eight lanes.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    #[inline]
    fn min(self, rhs: Self) -> Self {
        Self(self.0.fast_min(rhs.0))
    }
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    #[inline]
    fn max(self, rhs: Self) -> Self {
        Self(self.0.fast_max(rhs.0))
    }
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    #[inline]
    fn min(self, rhs: Self) -> Self {
        Self::select(self.lt(rhs), self, rhs)
    }
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    #[inline]
    fn max(self, rhs: Self) -> Self {
        Self::select(rhs.lt(self), self, rhs)
    }
    #[inline]
    fn to_bits(self) -> u32x16 {
        u32x16(wide::u32x16::new(self.to_array().map(f32::to_bits)))
    }
    #[inline]
    fn from_bits(bits: u32x16) -> Self {
        Self::new(bits.0.to_array().map(f32::from_bits))
    }
    #[inline]
    fn to_int(self) -> u32x16 {
        u32x16(wide::u32x16::new(self.0.fast_trunc_int().to_array().map(i32::cast_unsigned)))
    }
    #[inline]
    fn from_int(bits: u32x16) -> Self {
        Self(wide::f32x16::from_i32x16(wide::i32x16::new(bits.0.to_array().map(u32::cast_signed))))
    }
}
