//! What one lane and eight lanes have in common.

use std::{
    fmt::Debug,
    ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub},
};

/// A truth value for each lane: `bool` or [`Mask8`](super::Mask8).
pub trait Mask: Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// The same in every lane.
    fn splat(value: bool) -> Self;
    /// Lane `i` is bit `i`.
    fn to_bitmask(self) -> u32;
    /// Lane `i` is bit `i`; higher bits are ignored.
    fn from_bitmask(bits: u32) -> Self;

    /// Is any lane true?
    #[inline]
    fn any(self) -> bool {
        self.to_bitmask() != 0
    }

    /// Is no lane true?
    #[inline]
    fn none(self) -> bool {
        !self.any()
    }

    /// Are all lanes true?
    #[inline]
    fn all(self) -> bool {
        (!self).none()
    }

    /// Lanes that are true.
    #[inline]
    fn count(self) -> u32 {
        self.to_bitmask().count_ones()
    }
}

/// Unsigned 32-bit integers, wrapping: `u32` or [`u32x8`](super::u32x8).
pub trait Bits:
    Copy
    + Debug
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
    /// The truth values that go with it.
    type Mask: Mask;

    /// The same in every lane.
    fn splat(value: u32) -> Self;
    /// Lane `i` is `f(i)`.
    fn from_fn(f: impl FnMut(usize) -> u32) -> Self;
    /// The value of a lane.
    fn lane(self, i: usize) -> u32;
    /// Sum modulo 2³².
    fn wrapping_add(self, rhs: Self) -> Self;
    /// Product modulo 2³².
    fn wrapping_mul(self, rhs: Self) -> Self;
    /// Bit i becomes bit 31 − i.
    fn reverse_bits(self) -> Self;
    /// Equal, lane by lane.
    fn equal(self, rhs: Self) -> Self::Mask;
    /// `if mask { a } else { b }`, lane by lane.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
}

/// A float for each lane: `f32`, [`f32x8`](super::f32x8) or, where rays meet geometry, [`f32x16`](super::f32x16).
///
/// Each operation rounds once, to nearest even, in either implementation: equal inputs give equal bits.
/// Where a result can be NaN its payload is unspecified.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 1, 8 or 16.
    const LANES: usize;
    /// Truth values.
    type Mask: Mask;
    /// Integers of the same shape.
    type Bits: Bits<Mask = Self::Mask>;

    /// The same in every lane.
    fn splat(value: f32) -> Self;
    /// Lane `i` is `f(i)`.
    fn from_fn(f: impl FnMut(usize) -> f32) -> Self;
    /// Number k of each lane's row in the k-th of them.
    fn from_rows(row: impl FnMut(usize) -> [f32; 8]) -> [Self; 8];
    /// The value of a lane.
    fn lane(self, i: usize) -> f32;
    /// √x, correctly rounded.
    fn sqrt(self) -> Self;
    /// |x|.
    fn abs(self) -> Self;
    /// x < y; false for NaN.
    fn lt(self, rhs: Self) -> Self::Mask;
    /// x ≤ y; false for NaN.
    fn le(self, rhs: Self) -> Self::Mask;
    /// x = y; false for NaN.
    fn equal(self, rhs: Self) -> Self::Mask;
    /// `if mask { a } else { b }`, lane by lane.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// `if self < rhs { self } else { rhs }`: `rhs` where either is NaN or both are zero.
    fn min(self, rhs: Self) -> Self;
    /// `if rhs < self { self } else { rhs }`: `rhs` where either is NaN or both are zero.
    fn max(self, rhs: Self) -> Self;
    /// IEEE 754 bits.
    fn to_bits(self) -> Self::Bits;
    /// IEEE 754 bits.
    fn from_bits(bits: Self::Bits) -> Self;
    /// Rounded towards zero. For |x| < 2³¹; anything else gives an unspecified integer.
    fn to_int(self) -> Self::Bits;
    /// The integer, taken as signed; exact below 2²⁴ in magnitude.
    fn from_int(bits: Self::Bits) -> Self;

    /// x > y; false for NaN.
    #[inline]
    fn gt(self, rhs: Self) -> Self::Mask {
        rhs.lt(self)
    }

    /// x ≥ y; false for NaN.
    #[inline]
    fn ge(self, rhs: Self) -> Self::Mask {
        rhs.le(self)
    }

    /// Clamped to [`low`, `high`].
    #[inline]
    fn clamp(self, low: f32, high: f32) -> Self {
        self.max(Self::splat(low)).min(Self::splat(high))
    }

    /// The largest integer not above x.
    #[inline]
    fn floor(self) -> Self {
        let toward_zero = Self::from_int(self.to_int());
        let below = toward_zero - Self::one();
        let floor = Self::select(self.lt(toward_zero), below, toward_zero);
        // From 2²³ on every float is an integer, and conversion may overflow.
        Self::select(self.abs().lt(Self::splat(8_388_608.0)), floor, self)
    }

    /// Zero in every lane.
    #[inline]
    fn zero() -> Self {
        Self::splat(0.0)
    }

    /// One in every lane.
    #[inline]
    fn one() -> Self {
        Self::splat(1.0)
    }

    /// x if the mask says so, else 0.
    #[inline]
    fn only(self, mask: Self::Mask) -> Self {
        Self::select(mask, self, Self::zero())
    }
}

impl Mask for bool {
    #[inline]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline]
    fn to_bitmask(self) -> u32 {
        u32::from(self)
    }
    #[inline]
    fn from_bitmask(bits: u32) -> Self {
        bits & 1 != 0
    }
}

impl Bits for u32 {
    type Mask = bool;

    #[inline]
    fn splat(value: u32) -> Self {
        value
    }
    #[inline]
    fn from_fn(mut f: impl FnMut(usize) -> u32) -> Self {
        f(0)
    }
    #[inline]
    fn lane(self, _: usize) -> u32 {
        self
    }
    #[inline]
    fn wrapping_add(self, rhs: Self) -> Self {
        u32::wrapping_add(self, rhs)
    }
    #[inline]
    fn wrapping_mul(self, rhs: Self) -> Self {
        u32::wrapping_mul(self, rhs)
    }
    #[inline]
    fn reverse_bits(self) -> Self {
        u32::reverse_bits(self)
    }
    #[inline]
    fn equal(self, rhs: Self) -> bool {
        self == rhs
    }
    #[inline]
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
}

impl Real for f32 {
    const LANES: usize = 1;
    type Mask = bool;
    type Bits = u32;

    #[inline]
    fn splat(value: f32) -> Self {
        value
    }
    #[inline]
    fn from_fn(mut f: impl FnMut(usize) -> f32) -> Self {
        f(0)
    }
    #[inline]
    fn from_rows(mut row: impl FnMut(usize) -> [f32; 8]) -> [Self; 8] {
        row(0)
    }
    #[inline]
    fn lane(self, _: usize) -> f32 {
        self
    }
    #[inline]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    #[inline]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline]
    fn lt(self, rhs: Self) -> bool {
        self < rhs
    }
    #[inline]
    fn le(self, rhs: Self) -> bool {
        self <= rhs
    }
    #[inline]
    fn equal(self, rhs: Self) -> bool {
        self == rhs
    }
    #[inline]
    fn select(mask: bool, a: Self, b: Self) -> Self {
        if mask { a } else { b }
    }
    #[inline]
    fn min(self, rhs: Self) -> Self {
        if self < rhs { self } else { rhs }
    }
    #[inline]
    fn max(self, rhs: Self) -> Self {
        if rhs < self { self } else { rhs }
    }
    #[inline]
    fn to_bits(self) -> u32 {
        f32::to_bits(self)
    }
    #[inline]
    fn from_bits(bits: u32) -> Self {
        f32::from_bits(bits)
    }
    #[inline]
    fn to_int(self) -> u32 {
        (self as i32).cast_unsigned()
    }
    #[inline]
    fn from_int(bits: u32) -> Self {
        bits.cast_signed() as f32
    }
}
