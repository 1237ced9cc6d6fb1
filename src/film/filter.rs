//! Where the samples of a pixel are taken, and what each counts.
//!
//! A reconstructed pixel is a weighted mean of radiance about its centre c,
//!
//! ```text
//! pixel(c) = ∫ f(x) f(y) L(c + (x, y)) dx dy / ∫ f(x) f(y) dx dy
//! ```
//!
//! Its samples are drawn with the density |f| \[ESG06\], so each counts the same, up to the sign of f:
//! it is its own pixel's, and no other's. Units are pixels.

use crate::simd::{Bits, Real};

/// Cells of the table of quantiles.
const CELLS: u32 = 1024;

/// A symmetric reconstruction filter, the same in x and in y, ready to be sampled.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    /// `None` is the box of one pixel, whose samples stay where they are.
    table: Option<Table>,
}

#[derive(Clone, Debug, PartialEq)]
struct Table {
    /// Distances from the centre below which lie 0/n, 1/n … n/n of ∫|f|.
    quantiles: Vec<f32>,
    /// Shares of ∫|f| at which f changes its sign, going outwards.
    crossings: Vec<f32>,
}

impl Filter {
    /// All of the pixel, and nothing else, alike.
    pub const BOX: Self = Self { table: None };

    /// Any symmetric f, positive at 0 and 0 beyond `radius`.
    pub fn new(radius: f64, f: impl Fn(f64) -> f64) -> Self {
        // Much finer than the quantiles, so that their error is what counts.
        const STEPS: u32 = 64 * CELLS;
        let width = radius / f64::from(STEPS);
        let values: Vec<f64> = (0..STEPS).map(|i| f((f64::from(i) + 0.5) * width)).collect();
        let total: f64 = values.iter().map(|value| value.abs()).sum();
        let mut quantiles = Vec::with_capacity(CELLS as usize + 1);
        let mut crossings = Vec::new();
        let mut below = 0.0;
        for (i, &value) in values.iter().enumerate() {
            let mass = value.abs() / total;
            if i > 0 && value * values[i - 1] < 0.0 {
                crossings.push(below as f32);
            }
            // A distance where there is no mass is nobody's quantile.
            while mass > 0.0 && quantiles.len() <= CELLS as usize {
                let wanted = quantiles.len() as f64 / f64::from(CELLS);
                if wanted > below + mass {
                    break;
                }
                quantiles.push(((i as f64 + (wanted - below) / mass) * width) as f32);
            }
            below += mass;
        }
        // What rounding has left of the last one.
        quantiles.resize(CELLS as usize + 1, radius as f32);
        Self { table: Some(Table { quantiles, crossings }) }
    }

    /// Places within or about a pixel, measured from its corner as its centre ± radius, from random numbers
    /// in [0, 1), and what samples there count: 1 or −1.
    #[inline]
    pub fn sample<R: Real>(&self, (u, v): (R, R)) -> ((R, R), R) {
        let Some(table) = &self.table else { return ((u, v), R::one()) };
        let ((x, x_sign), (y, y_sign)) = (table.sample(u), table.sample(v));
        ((x, y), x_sign * y_sign)
    }
}

impl Table {
    /// By the inverse of the distribution, linear between quantiles, which keeps strata in their order.
    #[inline]
    fn sample<R: Real>(&self, u: R) -> (R, R) {
        let half = R::splat(0.5);
        let signed = u + u - R::one();
        let share = signed.abs();
        let scaled = share * R::splat(CELLS as f32);
        let cell = scaled.min(R::splat(CELLS as f32 - 1.0)).floor();
        let fraction = scaled - cell;
        let cell = cell.to_int();
        let low = R::from_fn(|i| self.quantiles[cell.lane(i) as usize]);
        let high = R::from_fn(|i| self.quantiles[cell.lane(i) as usize + 1]);
        let distance = low + (high - low) * fraction;
        let offset = R::select(signed.lt(R::zero()), -distance, distance);
        let sign = self
            .crossings
            .iter()
            .fold(R::one(), |sign, &crossing| R::select(R::splat(crossing).le(share), -sign, sign));
        (half + offset, sign)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::f32x8;

    /// Midpoints of 4096 equal shares, and their signs.
    fn samples(filter: &Filter) -> Vec<(f64, f64)> {
        let at = |i: u32| (i as f32 + 0.5) / 4096.0;
        let one = |i| filter.table.as_ref().map_or((at(i), 1.0), |table| table.sample(at(i)));
        (0..4096).map(one).map(|(x, sign)| (f64::from(x) - 0.5, f64::from(sign))).collect()
    }

    fn tent(x: f64) -> f64 {
        (1.0 - x / 1.5).max(0.0)
    }

    /// A parabola with a negative rim: mass 2/3 inside of 1, 4/3 − … outside, up to 1.5.
    fn hat(x: f64) -> f64 {
        if x < 1.5 { 1.0 - x * x } else { 0.0 }
    }

    #[test]
    fn moments_are_those_of_the_filter() {
        // ∫x²f/∫f over [0, r], in closed form.
        for (filter, second) in [
            (Filter::new(1.5, tent), 1.5 * 1.5 / 6.0),
            (
                Filter::new(1.5, hat),
                (1.5f64.powi(3) / 3.0 - 1.5f64.powi(5) / 5.0) / (1.5 - 1.5f64.powi(3) / 3.0),
            ),
            (Filter::BOX, 1.0 / 12.0),
        ] {
            let samples = samples(&filter);
            let weight: f64 = samples.iter().map(|(_, sign)| sign).sum();
            let moment = |n: i32| samples.iter().map(|(x, sign)| sign * x.powi(n)).sum::<f64>() / weight;
            assert!(moment(1).abs() < 1e-6, "{}", moment(1));
            assert!((moment(2) - second).abs() < 2e-3 * second.abs().max(0.1), "{} {second}", moment(2));
        }
    }

    #[test]
    fn samples_count_what_the_sign_says() {
        // ∫|f| = ∫f inside 1, minus what is negative outside.
        let (inside, all) = (1.0 - 1.0 / 3.0, 1.5 - 1.5f64.powi(3) / 3.0);
        let want = all / (inside + (inside - all));
        let samples = samples(&Filter::new(1.5, hat));
        let mean = samples.iter().map(|(_, sign)| sign).sum::<f64>() / 4096.0;
        assert!((mean - want).abs() < 1e-3, "{mean} {want}");
        assert!(
            samples.iter().all(|(x, sign)| (x.abs() < 1.0) == (*sign > 0.0) || (x.abs() - 1.0).abs() < 1e-3)
        );
    }

    #[test]
    fn the_box_leaves_samples_where_they_are() {
        let (place, weight) = Filter::BOX.sample((0.125f32, 0.75));
        assert_eq!((place, weight), ((0.125, 0.75), 1.0));
        // The same box by its table.
        let ((x, _), _) = Filter::new(0.5, |_| 1.0).sample((0.125f32, 0.75));
        assert!((x - 0.125).abs() < 1e-6, "{x}");
    }

    #[test]
    fn lanes_have_the_scalar_bits() {
        let filter = Filter::new(1.5, hat);
        let u = |i: usize| [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.999_99, 0.25][i];
        let ((x, y), w) = filter.sample((f32x8::from_fn(u), f32x8::from_fn(|i| u(7 - i))));
        for i in 0..8 {
            let ((a, b), c) = filter.sample((u(i), u(7 - i)));
            let bits = [x.lane(i), y.lane(i), w.lane(i)].map(f32::to_bits);
            assert_eq!(bits, [a, b, c].map(f32::to_bits));
        }
    }
}
