//! Eight truth values.

use std::ops::{BitAnd, BitOr, Not};

use super::{Bits, Mask, f32x8, u32x8};

/// Eight lanes, each all ones or all zeros.
#[derive(Clone, Copy, Debug)]
pub struct Mask8(pub(super) wide::f32x8);

impl Mask8 {
    /// The first `count` lanes are true.
    #[inline]
    pub fn first(count: usize) -> Self {
        const INDEX: f32x8 = f32x8::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        Self(INDEX.0.simd_lt(wide::f32x8::splat(count as f32)))
    }

    /// Lane by lane.
    #[inline]
    pub fn from_array(lanes: [bool; 8]) -> Self {
        Self(wide::f32x8::new(lanes.map(|lane| f32::from_bits(if lane { u32::MAX } else { 0 }))))
    }

    /// Are all lanes true?
    #[inline]
    pub fn all(self) -> bool {
        self.0.all()
    }

    /// Lane `i`.
    #[inline]
    pub fn lane(self, i: usize) -> bool {
        self.to_bitmask() >> i & 1 != 0
    }
}

impl Mask for Mask8 {
    #[inline]
    fn splat(value: bool) -> Self {
        Self(wide::f32x8::splat(f32::from_bits(if value { u32::MAX } else { 0 })))
    }
    #[inline]
    fn to_bitmask(self) -> u32 {
        self.0.to_bitmask()
    }
    #[inline]
    fn from_bitmask(bits: u32) -> Self {
        const BIT: u32x8 = u32x8::new([1, 2, 4, 8, 16, 32, 64, 128]);
        (u32x8::splat(bits) & BIT).equal(BIT)
    }
    #[inline]
    fn any(self) -> bool {
        self.0.any()
    }
}

impl BitAnd for Mask8 {
    type Output = Self;
    #[inline]
    fn bitand(self, rhs: Self) -> Self {
        Self(self.0 & rhs.0)
    }
}

impl BitOr for Mask8 {
    type Output = Self;
    #[inline]
    fn bitor(self, rhs: Self) -> Self {
        Self(self.0 | rhs.0)
    }
}

impl Not for Mask8 {
    type Output = Self;
    #[inline]
    fn not(self) -> Self {
        Self(!self.0)
    }
}
