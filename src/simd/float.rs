//! Eight floats.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{Mask8, Real, mask::Set8, u32x8};

/// Eight `f32`, one a lane. Equality of bits with eight scalars is the contract.
#[allow(non_camel_case_types)]
#[derive(Clone, Copy, Debug, Default)]
#[repr(transparent)]
pub struct f32x8(pub(super) wide::f32x8);

impl f32x8 {
    /// Lane `i` is `lanes[i]`.
    #[inline]
    pub const fn new(lanes: [f32; 8]) -> Self {
        Self(wide::f32x8::new(lanes))
    }

    /// Lane `i` is element `i`.
    #[inline]
    pub fn to_array(self) -> [f32; 8] {
        self.0.to_array()
    }

    /// The lower four lanes and the upper four.
    #[inline]
    pub fn of_halves(low: [f32; 4], high: [f32; 4]) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (low, high);
        Self::new([a, b, c, d, e, f, g, h])
    }

    /// Lanes 4i to 4i + 3.
    #[inline]
    pub fn half(self, i: usize) -> [f32; 4] {
        let [a, b, c, d, e, f, g, h] = self.to_array();
        if i == 0 { [a, b, c, d] } else { [e, f, g, h] }
    }

    /// self·factor + addend, rounded once where the target fuses and twice where it does not. Its bits
    /// differ between instruction sets: only for tests that cull, with a margin for either.
    #[inline]
    pub fn fused(self, factor: Self, addend: Self) -> Self {
        Self(self.0.mul_add(factor.0, addend.0))
    }

    /// The least lane; lanes that are NaN may or may not count.
    #[inline]
    pub fn reduce_min(self) -> f32 {
        let a = self.to_array();
        let half: [f32; 4] = std::array::from_fn(|i| Real::min(a[i], a[i + 4]));
        Real::min(Real::min(half[0], half[2]), Real::min(half[1], half[3]))
    }

    /// The greatest lane; lanes that are NaN may or may not count.
    #[inline]
    pub fn reduce_max(self) -> f32 {
        let a = self.to_array();
        let half: [f32; 4] = std::array::from_fn(|i| Real::max(a[i], a[i + 4]));
        Real::max(Real::max(half[0], half[2]), Real::max(half[1], half[3]))
    }
}

/// Lane j of row i becomes lane i of row j.
#[inline]
pub fn transpose(rows: [f32x8; 8]) -> [f32x8; 8] {
    wide::f32x8::transpose(rows.map(|row| row.0)).map(f32x8)
}

impl From<[f32; 8]> for f32x8 {
    #[inline]
    fn from(lanes: [f32; 8]) -> Self {
        Self::new(lanes)
    }
}

macro_rules! lane_by_lane {
    ($($trait:ident $verb:ident $op:tt),*) => {$(
        impl $trait for f32x8 {
            type Output = Self;
            #[inline]
            fn $verb(self, rhs: Self) -> Self {
                Self(self.0 $op rhs.0)
            }
        }
    )*};
}
lane_by_lane!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Neg for f32x8 {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for f32x8 {
    const LANES: usize = 8;
    type Mask = Mask8;
    type Bits = u32x8;

    #[inline]
    fn splat(value: f32) -> Self {
        Self(wide::f32x8::splat(value))
    }
    #[inline]
    fn from_fn(f: impl FnMut(usize) -> f32) -> Self {
        Self::new(std::array::from_fn(f))
    }
    #[inline]
    fn from_rows(mut row: impl FnMut(usize) -> [f32; 8]) -> [Self; 8] {
        transpose(std::array::from_fn(|i| Self::new(row(i))))
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
    fn lt(self, rhs: Self) -> Mask8 {
        Mask8(Set8::lt(self.0, rhs.0))
    }
    #[inline]
    fn le(self, rhs: Self) -> Mask8 {
        Mask8(Set8::le(self.0, rhs.0))
    }
    #[inline]
    fn equal(self, rhs: Self) -> Mask8 {
        Mask8(Set8::equal(self.0, rhs.0))
    }
    #[inline]
    fn select(mask: Mask8, a: Self, b: Self) -> Self {
        Self(mask.0.choose(a.0, b.0))
    }
    // x86's own minimum and maximum are the comparison and the selection in one instruction; others'
    // are not, NaN and −0 apart.
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
    fn to_bits(self) -> u32x8 {
        u32x8(wide::u32x8::new(self.to_array().map(f32::to_bits)))
    }
    #[inline]
    fn from_bits(bits: u32x8) -> Self {
        Self::new(bits.to_array().map(f32::from_bits))
    }
    #[inline]
    fn to_int(self) -> u32x8 {
        u32x8::from_signed(self.0.fast_trunc_int())
    }
    #[inline]
    fn from_int(bits: u32x8) -> Self {
        Self(wide::f32x8::from_i32x8(bits.to_signed()))
    }
}
