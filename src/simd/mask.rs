//! Truth values, eight or sixteen.
//!
//! AVX-512 keeps them as bits, in registers of their own; elsewhere a lane is all ones or all zeros.

#[cfg(all(target_arch = "x86_64", target_feature = "avx512vl"))]
#[allow(unsafe_code)]
mod avx512;
#[cfg(any(test, not(all(target_arch = "x86_64", target_feature = "avx512vl"))))]
mod portable;

use std::ops::{BitAnd, BitOr, Not};

#[cfg(all(target_arch = "x86_64", target_feature = "avx512vl"))]
pub(super) use avx512::{Set8, Set16};
#[cfg(not(all(target_arch = "x86_64", target_feature = "avx512vl")))]
pub(super) use portable::{Set8, Set16};

use super::Mask;

/// Eight truth values, one a lane.
#[derive(Clone, Copy, Debug)]
pub struct Mask8(pub(super) Set8);

/// Sixteen truth values, one a lane.
#[derive(Clone, Copy, Debug)]
pub struct Mask16(pub(super) Set16);

impl Mask8 {
    /// The first `count` lanes are true.
    #[inline]
    pub fn first(count: usize) -> Self {
        Self::from_bitmask(((1u64 << count.min(8)) - 1) as u32)
    }

    /// Lane by lane.
    #[inline]
    pub fn from_array(lanes: [bool; 8]) -> Self {
        Self::from_bitmask((0..8).fold(0, |bits, lane| bits | u32::from(lanes[lane]) << lane))
    }

    /// Lane `i`.
    #[inline]
    pub fn lane(self, i: usize) -> bool {
        self.to_bitmask() >> i & 1 != 0
    }
}

impl Mask16 {
    /// Lanes 8i to 8i + 7.
    #[inline]
    pub fn half(self, i: usize) -> Mask8 {
        Mask8::from_bitmask(self.to_bitmask() >> (i * 8) & 0xff)
    }
}

macro_rules! mask {
    ($name:ident($set:ident)) => {
        impl Mask for $name {
            #[inline]
            fn splat(value: bool) -> Self {
                Self($set::splat(value))
            }
            #[inline]
            fn to_bitmask(self) -> u32 {
                self.0.bits()
            }
            #[inline]
            fn from_bitmask(bits: u32) -> Self {
                Self($set::of_bits(bits))
            }
            #[inline]
            fn any(self) -> bool {
                self.0.any()
            }
        }

        impl BitAnd for $name {
            type Output = Self;
            #[inline]
            fn bitand(self, rhs: Self) -> Self {
                Self($set(self.0.0 & rhs.0.0))
            }
        }

        impl BitOr for $name {
            type Output = Self;
            #[inline]
            fn bitor(self, rhs: Self) -> Self {
                Self($set(self.0.0 | rhs.0.0))
            }
        }

        impl Not for $name {
            type Output = Self;
            #[inline]
            fn not(self) -> Self {
                Self($set(!self.0.0))
            }
        }
    };
}
mask!(Mask8(Set8));
mask!(Mask16(Set16));

#[cfg(test)]
mod tests {
    use super::*;

    const VALUES: [f32; 16] = {
        let (inf, nan) = (f32::INFINITY, f32::NAN);
        [0.0, -0.0, 1.0, -1.0, nan, inf, -inf, 1e-45, -1e-45, 3.5, 2.0, nan, f32::MAX, f32::MIN, 1.0, 0.0]
    };

    /// Every set of lanes, and every comparison of special values, in both kinds of sets.
    macro_rules! twins {
        ($test:ident: $set:ident, $float:ident, $int:ident, $lanes:literal) => {
            #[test]
            fn $test() {
                let all = u32::MAX >> (32 - $lanes);
                let turned = |by: usize| std::array::from_fn(|i| VALUES[(i + by) % 16]);
                for by in 0..256 {
                    let (a, b): ([f32; $lanes], [f32; $lanes]) = (turned(by % 16), turned(by / 16));
                    let [x, y] = [a, b].map(wide::$float::new);
                    let bits = |of: fn(f32, f32) -> bool| {
                        (0..$lanes).fold(0, |bits, i| bits | u32::from(of(a[i], b[i])) << i)
                    };
                    let [lt, le, equal] = [bits(|a, b| a < b), bits(|a, b| a <= b), bits(|a, b| a == b)];
                    let same = bits(|a, b| a.to_bits() == b.to_bits());
                    let [p, q] = [a, b].map(|lanes| wide::$int::new(lanes.map(f32::to_bits)));
                    assert_eq!([super::$set::lt(x, y).bits(), portable::$set::lt(x, y).bits()], [lt; 2]);
                    assert_eq!([super::$set::le(x, y).bits(), portable::$set::le(x, y).bits()], [le; 2]);
                    assert_eq!(
                        [super::$set::equal(x, y).bits(), portable::$set::equal(x, y).bits()],
                        [equal; 2]
                    );
                    let found =
                        [super::$set::equal_bits(p, q).bits(), portable::$set::equal_bits(p, q).bits()];
                    assert_eq!(found, [same; 2]);
                }
                let (a, b) = (wide::$int::splat(7), wide::$int::splat(9));
                let of = |x: wide::$int| wide::$float::new(x.to_array().map(f32::from_bits));
                for bits in (0..=all).step_by(if $lanes == 8 { 1 } else { 37 }) {
                    let (one, other) = (super::$set::of_bits(bits), portable::$set::of_bits(bits));
                    let want: [u32; $lanes] = std::array::from_fn(|i| if bits >> i & 1 != 0 { 7 } else { 9 });
                    for got in [one.choose_bits(a, b), other.choose_bits(a, b)] {
                        assert_eq!(got.to_array(), want);
                    }
                    for got in [one.choose(of(a), of(b)), other.choose(of(a), of(b))] {
                        assert_eq!(got.to_array().map(f32::to_bits), want);
                    }
                    assert_eq!([one.any(), other.any()], [bits != 0; 2]);
                    assert_eq!(
                        [super::$set(!one.0).bits(), portable::$set(!other.0).bits()],
                        [!bits & all; 2]
                    );
                    let (few, many) = (0x5a5a & all, 0x3c0f & all);
                    let and = [
                        super::$set(one.0 & super::$set::of_bits(few).0).bits(),
                        portable::$set(other.0 & portable::$set::of_bits(few).0).bits(),
                    ];
                    let or = [
                        super::$set(one.0 | super::$set::of_bits(many).0).bits(),
                        portable::$set(other.0 | portable::$set::of_bits(many).0).bits(),
                    ];
                    assert_eq!((and, or), ([bits & few; 2], [bits | many; 2]));
                }
                for value in [false, true] {
                    let want = if value { all } else { 0 };
                    assert_eq!(
                        [super::$set::splat(value).bits(), portable::$set::splat(value).bits()],
                        [want; 2]
                    );
                }
            }
        };
    }
    twins!(sets_of_eight_agree: Set8, f32x8, u32x8, 8);
    twins!(sets_of_sixteen_agree: Set16, f32x16, u32x16, 16);
}
