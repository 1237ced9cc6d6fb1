//! The error function and its inverse.

use std::f32::consts::FRAC_2_SQRT_PI;

use super::{exp, ln};
use crate::simd::Real;

/// 2/√π ∫₀ˣ exp(−t²) dt, absolute error below 5·10⁻⁷: its series up to ½, then formula 7.1.26 of \[AS64\].
#[inline]
pub fn erf<R: Real>(x: R) -> R {
    let coefficients = [1.061_405_4, -1.453_152_1, 1.421_413_8, -0.284_496_72, 0.254_829_6];
    let series = [-1.0 / 1320.0, 1.0 / 216.0, -1.0 / 42.0, 0.1, -1.0 / 3.0, 1.0];
    let z = x * x;
    let near = series.into_iter().fold(R::zero(), |sum, c| sum * z + R::splat(c));
    let near = R::splat(FRAC_2_SQRT_PI) * x * near;
    let ax = x.abs();
    let t = R::one() / (R::one() + R::splat(0.327_591_1) * ax);
    let polynomial = coefficients.into_iter().fold(R::zero(), |sum, c| (sum + R::splat(c)) * t);
    let far = R::one() - polynomial * exp(-z);
    let far = R::select(x.lt(R::zero()), -far, far);
    R::select(ax.lt(R::splat(0.5)), near, far)
}

/// The x with erf x = y, relative error below 10⁻⁶ \[Gil12\]; beyond ±1 as at the last float before it.
#[inline]
pub fn erf_inv<R: Real>(y: R) -> R {
    let y = y.clamp(-1.0 + f32::EPSILON / 2.0, 1.0 - f32::EPSILON / 2.0);
    let centre = [
        2.810_226_4e-8,
        3.432_739_4e-7,
        -3.523_387_7e-6,
        -4.391_506_5e-6,
        2.185_808_7e-4,
        -1.253_725e-3,
        -4.177_681_6e-3,
        2.466_407_3e-1,
        1.501_409_4,
    ];
    let tail = [
        -2.002_142_6e-4,
        1.009_505_6e-4,
        1.349_343_2e-3,
        -3.673_428_4e-3,
        5.739_507_7e-3,
        -7.622_461_3e-3,
        9.438_870_5e-3,
        1.001_674,
        2.832_976_8,
    ];
    let w = -ln((R::one() - y) * (R::one() + y));
    let near = w.lt(R::splat(5.0));
    let z = R::select(near, w - R::splat(2.5), w.max(R::zero()).sqrt() - R::splat(3.0));
    let polynomial = centre
        .into_iter()
        .zip(tail)
        .fold(R::zero(), |sum, (centre, tail)| sum * z + R::select(near, R::splat(centre), R::splat(tail)));
    polynomial * y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::f32x8;

    #[test]
    fn erf_has_its_tabulated_values() {
        // A&S table 7.1.
        let table = [
            (0.0f32, 0.0),
            (0.1, 0.112_462_916),
            (0.5, 0.520_499_878),
            (1.0, 0.842_700_793),
            (2.0, 0.995_322_265),
        ];
        for (x, want) in table {
            assert!((f64::from(erf(x)) - want).abs() < 5e-7, "{x}: {}", erf(x));
            assert_eq!(erf(-x), -erf(x));
        }
        assert_eq!((erf(9.0f32), erf(1e18f32)), (1.0, 1.0));
    }

    #[test]
    fn erf_is_its_own_integral() {
        // Simpson's rule in f64, a step at a time.
        let f = |t: f64| 2.0 / std::f64::consts::PI.sqrt() * (-t * t).exp();
        let (step, mut sum) = (1e-3, 0.0);
        for i in 0..4000 {
            let x = f64::from(i) * step;
            sum += step / 6.0 * (f(x) + 4.0 * f(x + step / 2.0) + f(x + step));
            let at = (x + step) as f32;
            assert!((f64::from(erf(at)) - sum).abs() < 5e-7, "{at}: {} {sum}", erf(at));
        }
    }

    #[test]
    fn the_inverse_is_one() {
        for i in 1..200_000 {
            let x = (i as f32 - 100_000.0) / 100_000.0 * 2.5;
            // The slope of the inverse multiplies the error of erf.
            let slope = f64::from(x * x).exp() * 0.8863;
            let error = f64::from(erf_inv(erf(x)) - x).abs();
            assert!(error < 4e-7 * slope + 2e-6 * f64::from(x.abs()), "{x}: {error}");
        }
        assert!(erf_inv(1.0f32).is_finite() && erf_inv(-1.0f32) < -3.7);
    }

    #[test]
    fn lanes_equal_scalar() {
        for i in 0..10_000 {
            let x = (i as f32 - 5000.0) / 1500.0;
            let lanes = f32x8::from_fn(|k| if k == 5 { x } else { 0.3 });
            assert_eq!(erf(lanes).lane(5).to_bits(), erf(x).to_bits());
            assert_eq!(erf_inv(lanes).lane(5).to_bits(), erf_inv(x).to_bits());
        }
    }
}
