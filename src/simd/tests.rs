//! Eight lanes do what eight scalars do, for every special value beside every other.

#![allow(clippy::needless_range_loop)] // lanes are numbered

use super::*;

const SPECIAL: [f32; 32] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    1.5,
    -2.5,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
    -f32::NAN,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1e-45,
    -1e-45,
    1e-40,
    -1e-40,
    f32::EPSILON,
    0.999_999_94,
    -0.999_999_94,
    8_388_607.5,
    -8_388_607.5,
    8_388_608.0,
    16_777_216.0,
    2_147_483_500.0,
    -2_147_483_600.0,
    3.0e9,
    1e30,
    -1e-30,
];

const WORDS: [u32; 12] = [
    0,
    1,
    2,
    7,
    0x7fff_ffff,
    0x8000_0000,
    0x8000_0001,
    0xffff_ffff,
    0x00ff_ffff,
    0x0100_0001,
    0xdead_beef,
    747_796_405,
];

/// Equal bits, or NaN both.
#[track_caller]
fn same(got: f32, want: f32, what: impl std::fmt::Debug) {
    assert!(got.to_bits() == want.to_bits() || got.is_nan() && want.is_nan(), "{got} for {want}: {what:?}");
}

/// Every pair of special values, each in every lane, other values beside it.
fn pairs(mut f: impl FnMut([f32; 8], [f32; 8])) {
    let n = SPECIAL.len();
    for a in 0..n {
        for b in 0..n {
            f(
                std::array::from_fn(|i| SPECIAL[(a + i) % n]),
                std::array::from_fn(|i| SPECIAL[(b + 5 * i) % n]),
            );
        }
    }
}

/// An operation of two values, written once for any width.
trait Binary {
    fn apply<R: Real>(a: R, b: R) -> R;
}

fn check_binary<B: Binary>() {
    pairs(|a, b| {
        let got = B::apply(f32x8::new(a), f32x8::new(b));
        for i in 0..8 {
            same(got.lane(i), B::apply(a[i], b[i]), (std::any::type_name::<B>(), a[i], b[i]));
        }
        // Sixteen: these, and the other way round.
        let other = B::apply(f32x8::new(b), f32x8::new(a));
        let halves = |a: [f32; 8], b: [f32; 8]| f32x16::of_halves([f32x8::new(a), f32x8::new(b)]);
        let both = B::apply(halves(a, b), halves(b, a));
        for i in 0..8 {
            same(both.lane(i), got.lane(i), (std::any::type_name::<B>(), a[i], b[i]));
            same(both.lane(i + 8), other.lane(i), (std::any::type_name::<B>(), b[i], a[i]));
        }
    });
}

macro_rules! binary {
    ($($name:ident: $a:ident, $b:ident => $e:expr;)*) => {$(
        struct $name;
        impl Binary for $name {
            fn apply<R: Real>($a: R, $b: R) -> R {
                let _ = $b;
                $e
            }
        }
    )*
    #[test]
    fn arithmetic_equals_scalar() {
        $(check_binary::<$name>();)*
    }};
}

binary! {
    Sum: a, b => a + b;
    Difference: a, b => a - b;
    Product: a, b => a * b;
    Quotient: a, b => a / b;
    Opposite: a, b => -a;
    Root: a, b => a.sqrt();
    Magnitude: a, b => a.abs();
    Least: a, b => a.min(b);
    Greatest: a, b => a.max(b);
    Chosen: a, b => R::select(a.lt(b), a, b);
    Kept: a, b => a.only(b.ge(R::zero()));
    Clamped: a, b => a.clamp(-1.0, 2.0);
    NotFused: a, b => a * b + a;
    ThroughBits: a, b => R::from_bits(a.to_bits());
}

#[test]
fn minimum_and_maximum_are_the_documented_choice() {
    // Bits, not values: which of two zeros, and whose NaN.
    pairs(|a, b| {
        let (min, max) = (f32x8::new(a).min(f32x8::new(b)), f32x8::new(a).max(f32x8::new(b)));
        for i in 0..8 {
            let (min_want, max_want) =
                (if a[i] < b[i] { a[i] } else { b[i] }, if b[i] < a[i] { a[i] } else { b[i] });
            assert_eq!(min.lane(i).to_bits(), min_want.to_bits(), "{} {}", a[i], b[i]);
            assert_eq!(max.lane(i).to_bits(), max_want.to_bits(), "{} {}", a[i], b[i]);
            assert_eq!(Real::min(a[i], b[i]).to_bits(), min_want.to_bits());
            assert_eq!(Real::max(a[i], b[i]).to_bits(), max_want.to_bits());
        }
    });
}

#[test]
fn comparisons_equal_scalar_and_nan_is_false() {
    pairs(|a, b| {
        let (x, y) = (f32x8::new(a), f32x8::new(b));
        let got = [x.lt(y), x.le(y), x.gt(y), x.ge(y), x.equal(y)];
        for i in 0..8 {
            let want = [a[i] < b[i], a[i] <= b[i], a[i] > b[i], a[i] >= b[i], a[i] == b[i]];
            assert_eq!(got.map(|mask| mask.lane(i)), want, "{} {}", a[i], b[i]);
        }
        let chosen = f32x8::select(x.lt(y), x, y);
        for i in 0..8 {
            let want = if a[i] < b[i] { a[i] } else { b[i] };
            assert_eq!(chosen.lane(i).to_bits(), want.to_bits());
        }
    });
}

#[test]
fn integers_and_floors_equal_scalar() {
    pairs(|a, _| {
        let (int, floor) = (f32x8::new(a).to_int(), f32x8::new(a).floor());
        for (i, x) in a.into_iter().enumerate() {
            if x.abs() < 2_147_483_648.0 {
                assert_eq!(int.lane(i), (x as i32).cast_unsigned(), "{x}");
                assert_eq!(int.lane(i), x.to_int());
            }
            same(floor.lane(i), Real::floor(x), x);
            // −0 may come back as 0.
            assert!(floor.lane(i) == x.floor() || x.is_nan(), "{x}: {}", floor.lane(i));
        }
    });
    for word in WORDS {
        let words: [u32; 8] = std::array::from_fn(|i| word.wrapping_add(i as u32 * 0x0123_4567));
        let got = f32x8::from_int(u32x8::new(words));
        for (i, word) in words.into_iter().enumerate() {
            same(got.lane(i), word.cast_signed() as f32, word);
            same(got.lane(i), <f32 as Real>::from_int(word), word);
        }
    }
}

#[test]
fn words_equal_scalar() {
    let n = WORDS.len();
    for first in 0..n {
        for second in 0..n {
            let a: [u32; 8] = std::array::from_fn(|i| WORDS[(first + i) % n]);
            let b: [u32; 8] = std::array::from_fn(|i| WORDS[(second + 5 * i) % n]);
            let (x, y) = (u32x8::new(a), u32x8::new(b));
            let got = [
                x & y,
                x | y,
                x ^ y,
                !x,
                x.wrapping_add(y),
                x.wrapping_mul(y),
                Bits::select(x.equal(y), x, y),
                Bits::select(!x.equal(y), x, y),
            ];
            for i in 0..8 {
                let (a, b) = (a[i], b[i]);
                let want = [a & b, a | b, a ^ b, !a, a.wrapping_add(b), a.wrapping_mul(b), b, a];
                assert_eq!(got.map(|word| word.lane(i)), want, "{a:#x} {b:#x}");
                assert_eq!(x.equal(y).lane(i), a == b);
            }
            for count in 0..32 {
                for (i, a) in a.into_iter().enumerate() {
                    assert_eq!((x << count).lane(i), a << count);
                    assert_eq!((x >> count).lane(i), a >> count, "not arithmetic");
                }
            }
        }
    }
}

#[test]
fn masks_are_their_bits() {
    for bits in 0..256 {
        let mask = Mask8::from_bitmask(bits);
        assert_eq!(mask.to_bitmask(), bits);
        assert_eq!((!mask).to_bitmask(), 255 - bits);
        assert_eq!((mask.any(), mask.none(), mask.all()), (bits != 0, bits == 0, bits == 255));
        assert_eq!(mask.count(), bits.count_ones());
        assert_eq!(Mask8::from_bitmask(bits | 0xff00).to_bitmask(), bits);
        for other in (0..256).step_by(7) {
            let second = Mask8::from_bitmask(other);
            assert_eq!((mask & second).to_bitmask(), bits & other);
            assert_eq!((mask | second).to_bitmask(), bits | other);
        }
        let (index, tens) = (f32x8::from_fn(|i| i as f32), f32x8::from_fn(|i| 10.0 * i as f32));
        let words = Bits::select(mask, u32x8::splat(1), u32x8::splat(2));
        for i in 0..8 {
            let set = bits >> i & 1 != 0;
            assert_eq!(mask.lane(i), set);
            assert_eq!(f32x8::select(mask, index, tens).lane(i), i as f32 * if set { 1.0 } else { 10.0 });
            assert_eq!(words.lane(i), if set { 1 } else { 2 });
        }
    }
    assert_eq!((Mask8::splat(true).to_bitmask(), Mask8::splat(false).to_bitmask()), (255, 0));
    for count in 0..=8 {
        assert_eq!(Mask8::first(count).to_bitmask(), (1u32 << count) - 1);
    }
}

#[test]
fn reductions_find_the_extremes_in_every_lane() {
    for lane in 0..8 {
        for value in [-7.0f32, 7.0, 0.0, f32::INFINITY, f32::NEG_INFINITY, 1e-45] {
            let mut lanes = [1.0f32, -1.0, 2.0, -2.0, 3.0, -3.0, 0.5, -0.5];
            lanes[lane] = value;
            let (least, greatest) =
                lanes.iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, g), &x| (l.min(x), g.max(x)));
            assert_eq!((f32x8::new(lanes).reduce_min(), f32x8::new(lanes).reduce_max()), (least, greatest));
        }
    }
}

/// What one operation is for sixteen lanes, two are for eight.
#[test]
fn sixteen_lanes_are_twice_eight() {
    pairs(|a, b| {
        let (a, b) = ([f32x8::new(a), f32x8::new(b)], [f32x8::new(b), f32x8::new(a)]);
        let (x, y) = (f32x16::of_halves(a), f32x16::of_halves(b));
        let bits = |lanes: f32x8| lanes.to_array().map(f32::to_bits);
        let masks = [x.lt(y), x.le(y), x.equal(y), x.gt(y), x.ge(y)];
        for half in 0..2 {
            let (a, b) = (a[half], b[half]);
            assert_eq!(bits(x.half(half)), bits(a));
            assert_eq!(bits(x.halves()[half]), bits(a));
            assert_eq!(bits(x.min(y).half(half)), bits(a.min(b)), "which zero, and whose NaN");
            assert_eq!(bits(x.max(y).half(half)), bits(a.max(b)));
            let want = [a.lt(b), a.le(b), a.equal(b), a.gt(b), a.ge(b)].map(Mask::to_bitmask);
            assert_eq!(masks.map(|mask| mask.to_bitmask() >> (8 * half) & 0xff), want);
            for quarter in 0..2 {
                let got = x.quarter(half * 2 + quarter).map(f32::to_bits);
                assert_eq!(got, a.half(quarter).map(f32::to_bits));
                assert_eq!(x.to_bits().quarter(half * 2 + quarter), got);
            }
        }
        let mut swapped = x;
        swapped.put_quarter(1, y.quarter(3));
        assert_eq!(swapped.quarter(1).map(f32::to_bits), y.quarter(3).map(f32::to_bits));
        assert_eq!(bits(swapped.half(1)), bits(x.half(1)));
    });
    for bits in (0..0x1_0000).step_by(5) {
        let mask = Mask16::from_bitmask(bits);
        assert_eq!((mask.to_bitmask(), (!mask).to_bitmask()), (bits, 0xffff - bits));
        assert_eq!((mask.any(), mask.count()), (bits != 0, bits.count_ones()));
        let other = Mask16::from_bitmask(0x3c5a);
        assert_eq!((mask & other).to_bitmask(), bits & 0x3c5a);
        assert_eq!((mask | other).to_bitmask(), bits | 0x3c5a);
        let words = Bits::select(mask, u32x16::splat(1), u32x16::splat(2));
        assert!((0..16).all(|i| words.lane(i) == 2 - (bits >> i & 1)));
    }
    assert_eq!((Mask16::splat(true).to_bitmask(), Mask16::splat(false).to_bitmask()), (0xffff, 0));
    for first in 0..WORDS.len() {
        let a: [u32; 16] = std::array::from_fn(|i| WORDS[(first + i) % WORDS.len()]);
        let (x, y) = (u32x16::from_fn(|i| a[i]), u32x16::from_fn(|i| a[15 - i]));
        let got =
            [x & y, x | y, x ^ y, !x, x.wrapping_add(y), x.wrapping_mul(y), x << 3, x >> 3, x.reverse_bits()];
        for i in 0..16 {
            let (a, b) = (a[i], a[15 - i]);
            let want = [
                a & b,
                a | b,
                a ^ b,
                !a,
                a.wrapping_add(b),
                a.wrapping_mul(b),
                a << 3,
                a >> 3,
                a.reverse_bits(),
            ];
            assert_eq!(got.map(|word| word.lane(i)), want);
            assert_eq!(x.equal(y).to_bitmask() >> i & 1 != 0, a == b);
        }
    }
    for lane in 0..16 {
        for value in [-7.0f32, 7.0, f32::INFINITY, f32::NEG_INFINITY] {
            let lanes = f32x16::from_fn(|i| if i == lane { value } else { 0.5 });
            assert_eq!((lanes.reduce_min(), lanes.reduce_max()), (value.min(0.5), value.max(0.5)));
        }
    }
    let rows = f32x16::from_rows(|i| std::array::from_fn(|k| (100 * i + k) as f32));
    for (k, row) in rows.into_iter().enumerate() {
        assert!((0..16).all(|i| row.lane(i) == (100 * i + k) as f32));
    }
}
