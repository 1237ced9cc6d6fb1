//! Elementary functions for any number of lanes.
//!
//! Minimax coefficients are those of the Cephes library's single-precision functions (Moshier 1992),
//! rounded to f32; the reductions are our own, since the arguments here are turns and ratios.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use crate::simd::{Bits, Real};

/// Sine and cosine of 2π `turns`, absolute error below 2⁻²². `turns` finite, |turns| < 2²².
#[inline]
pub fn sin_cos_turns<R: Real>(turns: R) -> (R, R) {
    // The nearest quarter turn; what remains is exact and in [-1/8, 1/8].
    let quarter = (turns * R::splat(4.0) + R::splat(0.5)).floor();
    let x = (turns - quarter * R::splat(0.25)) * R::splat(TAU);
    let z = x * x;
    let sin = x + x
        * z
        * (R::splat(-0.166_666_55) + z * (R::splat(0.008_332_161) + z * R::splat(-0.000_195_152_96)));
    let cos = R::one() - z * R::splat(0.5)
        + z * z
            * (R::splat(0.041_666_646) + z * (R::splat(-0.001_388_731_6) + z * R::splat(0.000_024_433_157)));
    let quadrant = quarter.to_int() & R::Bits::splat(3);
    let odd = (quadrant & R::Bits::splat(1)).equal(R::Bits::splat(1));
    let (s, c) = (R::select(odd, cos, sin), R::select(odd, sin, cos));
    let upper = (quadrant & R::Bits::splat(2)).equal(R::Bits::splat(0));
    let right = quadrant.equal(R::Bits::splat(0)) | quadrant.equal(R::Bits::splat(3));
    (R::select(upper, s, -s), R::select(right, c, -c))
}

/// Angle of the point (x, y) in [-π, π], absolute error below 2⁻²¹; 0 for the origin.
#[inline]
pub fn atan2<R: Real>(y: R, x: R) -> R {
    let (ax, ay) = (x.abs(), y.abs());
    let steep = ax.lt(ay);
    let (high, low) = (R::select(steep, ay, ax), R::select(steep, ax, ay));
    let ratio = R::select(high.gt(R::zero()), low / high, R::zero());
    // tan(π/8): above it, atan r = π/4 + atan((r − 1)/(r + 1)).
    let large = ratio.gt(R::splat(0.414_213_57));
    let r = R::select(large, (ratio - R::one()) / (ratio + R::one()), ratio);
    let z = r * r;
    let polynomial = ((R::splat(0.080_537_446) * z - R::splat(0.138_776_86)) * z + R::splat(0.199_777_1)) * z
        - R::splat(0.333_329_5);
    let atan = R::select(large, R::splat(FRAC_PI_4), R::zero()) + (polynomial * z * r + r);
    let first = R::select(steep, R::splat(FRAC_PI_2) - atan, atan);
    let left = R::select(x.lt(R::zero()), R::splat(PI) - first, first);
    R::select(y.lt(R::zero()), -left, left)
}

/// Arc cosine in [0, π]; `x` is clamped to [-1, 1].
#[inline]
pub fn acos<R: Real>(x: R) -> R {
    let x = x.clamp(-1.0, 1.0);
    atan2(((R::one() - x) * (R::one() + x)).sqrt(), x)
}

/// 2ˣ, relative error below 2⁻²¹; `x` is clamped to [-126, 127].
#[inline]
pub fn exp2<R: Real>(x: R) -> R {
    let x = x.clamp(-126.0, 127.0);
    let n = (x + R::splat(0.5)).floor();
    let f = x - n;
    let polynomial =
        ((((R::splat(1.535_336_2e-4) * f + R::splat(1.339_887_5e-3)) * f + R::splat(9.618_437e-3)) * f
            + R::splat(5.550_332_5e-2))
            * f
            + R::splat(2.402_264_7e-1))
            * f
            + R::splat(std::f32::consts::LN_2);
    let exponent = n.to_int().wrapping_add(R::Bits::splat(127)) << 23;
    (R::one() + polynomial * f) * R::from_bits(exponent)
}

/// log₂ x for positive normal x; −126 or less for 0 and subnormals.
#[inline]
pub fn log2<R: Real>(x: R) -> R {
    let x = x.max(R::splat(f32::MIN_POSITIVE));
    let bits = x.to_bits();
    // Mantissa in [√½, √2): the logarithm of what remains is small and the sum does not cancel.
    let offset = bits.wrapping_add(R::Bits::splat(0x3f80_0000 - 0x3f35_04f3));
    let exponent = R::from_int((offset >> 23).wrapping_add(R::Bits::splat(127u32.wrapping_neg())));
    let mantissa = (offset & R::Bits::splat(0x007f_ffff)).wrapping_add(R::Bits::splat(0x3f35_04f3));
    let m = R::from_bits(mantissa) - R::one();
    let z = m * m;
    let coefficients = [
        -1.151_461e-1,
        1.167_699_9e-1,
        -1.242_014_1e-1,
        1.424_932_3e-1,
        -1.666_805_8e-1,
        2.000_071_5e-1,
        -2.499_999_4e-1,
        3.333_333e-1,
    ];
    let polynomial = coefficients.into_iter().fold(R::splat(7.037_683_6e-2), |sum, c| sum * m + R::splat(c));
    let ln = m * z * polynomial - R::splat(0.5) * z + m;
    exponent + ln * R::splat(std::f32::consts::LOG2_E)
}

/// eˣ, relative error below 2⁻²¹ (1 + |x|); `x` is clamped to [-87, 88].
#[inline]
pub fn exp<R: Real>(x: R) -> R {
    exp2(x * R::splat(std::f32::consts::LOG2_E))
}

/// The natural logarithm of a positive normal x; −87 or less for 0 and subnormals.
#[inline]
pub fn ln<R: Real>(x: R) -> R {
    log2(x) * R::splat(std::f32::consts::LN_2)
}

/// xʸ for x ≥ 0: 1 where y = 0, else 0 where x = 0.
#[inline]
pub fn pow<R: Real>(x: R, y: R) -> R {
    let power = exp2(y * log2(x));
    let power = R::select(x.gt(R::zero()), power, R::zero());
    R::select(y.equal(R::zero()), R::one(), power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::f32x8;

    fn sweep(low: f32, high: f32) -> impl Iterator<Item = f32> {
        (0..=100_000).map(move |i| low + (high - low) * i as f32 / 100_000.0)
    }

    /// Checks against f64, and that eight lanes have the scalar's bits.
    fn check(f: fn(f32) -> f32, f8: fn(f32x8) -> f32x8, exact: fn(f64) -> f64, x: f32, tolerance: f64) {
        let (got, want) = (f(x), exact(f64::from(x)));
        assert!(
            (f64::from(got) - want).abs() <= tolerance * want.abs().max(1.0),
            "f({x}) = {got}, not {want}"
        );
        let lanes = f8(f32x8::from_fn(|i| if i == 3 { x } else { 0.25 }));
        assert_eq!(lanes.lane(3).to_bits(), got.to_bits(), "{x}");
    }

    #[test]
    fn elementary_functions_agree_with_f64_and_with_their_lanes() {
        for x in sweep(-3.0, 3.0) {
            check(
                |x| sin_cos_turns(x).0,
                |x| sin_cos_turns(x).0,
                |x| (x * std::f64::consts::TAU).sin(),
                x,
                3e-7,
            );
            check(
                |x| sin_cos_turns(x).1,
                |x| sin_cos_turns(x).1,
                |x| (x * std::f64::consts::TAU).cos(),
                x,
                3e-7,
            );
            check(
                |x| atan2(x, 0.7),
                |x| atan2(x, f32x8::splat(0.7)),
                |x| x.atan2(f64::from(0.7f32)),
                x,
                4e-7,
            );
            check(
                |x| atan2(0.3, x),
                |x| atan2(f32x8::splat(0.3), x),
                |x| f64::from(0.3f32).atan2(x),
                x,
                4e-7,
            );
        }
        for x in sweep(-1.0, 1.0) {
            check(acos, acos, f64::acos, x, 4e-7);
        }
        for x in sweep(-20.0, 20.0) {
            check(exp2, exp2, f64::exp2, x, 5e-7);
            check(exp, exp, f64::exp, x, 5e-7 * f64::from(1.0 + x.abs()));
        }
        for x in sweep(1e-6, 50.0) {
            check(log2, log2, f64::log2, x, 3e-7);
            check(ln, ln, f64::ln, x, 3e-7);
            check(|x| pow(x, 2.5), |x| pow(x, f32x8::splat(2.5)), |x| x.powf(2.5), x, 2e-6);
        }
    }

    #[test]
    fn corners_of_the_domain() {
        assert_eq!(atan2(0.0f32, 0.0), 0.0);
        assert_eq!(atan2(0.0f32, -1.0), PI);
        assert_eq!(acos(-1.0f32), PI);
        assert_eq!(acos(1.0f32), 0.0);
        assert_eq!(sin_cos_turns(0.25f32), (1.0, 0.0));
        assert_eq!(sin_cos_turns(0.5f32).1, -1.0);
        assert_eq!((pow(0.0f32, 3.0), pow(0.0f32, 0.0), pow(1.0f32, 1e6)), (0.0, 1.0, 1.0));
        assert_eq!((-1.5f32).floor(), -2.0);
        assert_eq!(<f32 as Real>::floor(3e30), 3e30);
        assert_eq!(<f32 as Real>::floor(-7.25), -8.0);
    }
}
