//! Eight integers.

use std::ops::{BitAnd, BitOr, BitXor, Not, Shl, Shr};

use super::{Bits, Mask8, mask::Set8};

/// Eight `u32`, one a lane, wrapping.
#[allow(non_camel_case_types)]
#[derive(Clone, Copy, Debug, Default)]
#[repr(transparent)]
pub struct u32x8(pub(super) wide::u32x8);

impl u32x8 {
    /// Lane `i` is `lanes[i]`.
    #[inline]
    pub const fn new(lanes: [u32; 8]) -> Self {
        Self(wide::u32x8::new(lanes))
    }

    /// Lane `i` is element `i`.
    #[inline]
    pub fn to_array(self) -> [u32; 8] {
        self.0.to_array()
    }

    /// The lower four lanes and the upper four.
    #[inline]
    pub fn of_halves(low: [u32; 4], high: [u32; 4]) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (low, high);
        Self::new([a, b, c, d, e, f, g, h])
    }

    /// Lane `i` is lane `indices[i]` of this one; indices below 8.
    #[inline]
    pub fn shuffle(self, indices: Self) -> Self {
        Self(self.0.shuffle(indices.0))
    }

    #[inline]
    pub(super) fn from_signed(lanes: wide::i32x8) -> Self {
        Self::new(lanes.to_array().map(i32::cast_unsigned))
    }

    #[inline]
    pub(super) fn to_signed(self) -> wide::i32x8 {
        wide::i32x8::new(self.to_array().map(u32::cast_signed))
    }
}

macro_rules! lane_by_lane {
    ($($trait:ident $verb:ident $op:tt $rhs:ty),*) => {$(
        impl $trait<$rhs> for u32x8 {
            type Output = Self;
            #[inline]
            fn $verb(self, rhs: $rhs) -> Self {
                Self(self.0 $op rhs.0)
            }
        }
    )*};
}
lane_by_lane!(BitAnd bitand & Self, BitOr bitor | Self, BitXor bitxor ^ Self);

impl Shl<u32> for u32x8 {
    type Output = Self;
    #[inline]
    fn shl(self, rhs: u32) -> Self {
        Self(self.0 << rhs)
    }
}

impl Shr<u32> for u32x8 {
    type Output = Self;
    #[inline]
    fn shr(self, rhs: u32) -> Self {
        Self(self.0 >> rhs)
    }
}

impl Not for u32x8 {
    type Output = Self;
    #[inline]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Bits for u32x8 {
    type Mask = Mask8;

    #[inline]
    fn splat(value: u32) -> Self {
        Self(wide::u32x8::splat(value))
    }
    #[inline]
    fn from_fn(f: impl FnMut(usize) -> u32) -> Self {
        Self::new(std::array::from_fn(f))
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
        // Two instructions where the target can map bytes, and shifts elsewhere.
        Self::new(self.to_array().map(u32::reverse_bits))
    }
    #[inline]
    fn equal(self, rhs: Self) -> Mask8 {
        Mask8(Set8::equal_bits(self.0, rhs.0))
    }
    #[inline]
    fn select(mask: Mask8, a: Self, b: Self) -> Self {
        Self(mask.0.choose_bits(a.0, b.0))
    }
}
