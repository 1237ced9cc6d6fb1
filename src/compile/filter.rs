//! Reconstruction filters to tables.
//!
//! Each is symmetric and the same in x and in y; x is in pixels.

use std::f64::consts::PI;

use crate::film::Filter;
use crate::scene::ReconstructionFilter;

/// A filter, ready to be sampled.
pub(super) fn compile(filter: ReconstructionFilter) -> Filter {
    match filter {
        ReconstructionFilter::Box => Filter::BOX,
        ReconstructionFilter::Tent { radius } => Filter::new(radius, |x| 1.0 - x / radius),
        ReconstructionFilter::Gaussian { stddev } => {
            let radius = 4.0 * stddev;
            let bell = |x: f64| libm::exp(-0.5 * (x / stddev) * (x / stddev));
            Filter::new(radius, |x| bell(x) - bell(radius))
        }
        ReconstructionFilter::Mitchell { b, c } => Filter::new(2.0, |x| mitchell(x, b, c)),
        ReconstructionFilter::CatmullRom => Filter::new(2.0, |x| mitchell(x, 0.0, 0.5)),
        ReconstructionFilter::Lanczos { lobes } => {
            let lobes = f64::from(lobes);
            Filter::new(lobes, |x| sinc(x) * sinc(x / lobes))
        }
    }
}

/// The cubics of \[MN88\]; b = 0, c = ½ interpolates.
fn mitchell(x: f64, b: f64, c: f64) -> f64 {
    let (x2, x3) = (x * x, x * x * x);
    if x < 1.0 {
        ((12.0 - 9.0 * b - 6.0 * c) * x3 + (-18.0 + 12.0 * b + 6.0 * c) * x2 + (6.0 - 2.0 * b)) / 6.0
    } else {
        ((-b - 6.0 * c) * x3 + (6.0 * b + 30.0 * c) * x2 + (-12.0 * b - 48.0 * c) * x + (8.0 * b + 24.0 * c))
            / 6.0
    }
}

/// sin πx / πx.
fn sinc(x: f64) -> f64 {
    if x < 1e-6 { 1.0 } else { libm::sin(PI * x) / (PI * x) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_join_and_sum_to_one() {
        for (b, c) in [(1.0 / 3.0, 1.0 / 3.0), (0.0, 0.5), (1.0, 0.0), (0.5, 0.25)] {
            assert!((mitchell(1.0 - 1e-12, b, c) - mitchell(1.0, b, c)).abs() < 1e-9);
            assert!(mitchell(2.0, b, c).abs() < 1e-12);
            for shift in [0.0f64, 0.2, 0.5, 0.9] {
                let sum: f64 =
                    (-3..=3).map(|i| (f64::from(i) + shift).abs()).map(|x| mitchell(x.min(2.0), b, c)).sum();
                assert!((sum - 1.0).abs() < 1e-12, "{b} {c} {shift}: {sum}");
            }
        }
    }

    /// Values of Mitsuba 3.9.1 at 0, ¼ … 1¾, or 2½ for the widest.
    #[test]
    fn curves_are_mitsubas() {
        let third = 1.0 / 3.0;
        let close = |got: f64, want: f64| assert!((got - want).abs() < 1e-6, "{got} {want}");
        close(mitchell(0.25, third, third), 0.782_118_08);
        close(mitchell(1.25, third, third), -0.023_437_42);
        close(mitchell(1.5, 0.5, 0.25), -0.020_833_42);
        close(mitchell(1.25, 0.0, 0.5), -0.070_312_5);
        let lanczos = |x: f64, lobes: f64| sinc(x) * sinc(x / lobes);
        close(lanczos(0.25, 3.0), 0.890_067_04);
        close(lanczos(2.5, 3.0), 0.024_317_07);
        close(lanczos(1.5, 2.0), -0.063_684_35);
    }
}
