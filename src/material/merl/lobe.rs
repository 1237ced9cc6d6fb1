//! How bright a table is at each angle of the half vector: a density to draw half vectors from.

use super::{MERL_CELLS, theta_h};
use crate::math::{INV_TWO_PI, sin_cos_turns};
use crate::simd::{Bits, Real};

/// A density of half vectors, constant in each cell of θ_h.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lobe {
    /// Per solid angle, by cell.
    density: Vec<f32>,
    /// Probability of the cells before each, and 1.
    before: Vec<f32>,
    /// 1 − cos θ_h where cells begin, and the end: near the pole the cosine has no bits left.
    below_pole: Vec<f32>,
}

impl Lobe {
    pub(super) fn new(values: &[[f32; 3]]) -> Self {
        let [cells, d_cells, phi_cells] = MERL_CELLS;
        let below_pole = |cell: usize| {
            let (sin, _) = sin_cos_turns(theta_h(cell as f32) / (2.0 * std::f32::consts::TAU));
            2.0 * sin * sin
        };
        let below_pole: Vec<f32> = (0..=cells).map(below_pole).collect();
        let widths: Vec<f32> = below_pole.windows(2).map(|ends| ends[1] - ends[0]).collect();
        // Grazing difference angles are left out: there everything is bright.
        let seen = d_cells * 2 / 3 * phi_cells;
        let row = |cell: usize| &values[cell * d_cells * phi_cells..][..seen];
        let mean = |cell: usize| row(cell).iter().flatten().map(|x| f64::from(*x)).sum::<f64>() / seen as f64;
        let masses = (0..cells).map(|cell| mean(cell).max(1e-6) * f64::from(widths[cell]));
        let masses: Vec<f64> = masses.collect();
        let total: f64 = masses.iter().sum();
        let mut before = vec![0.0];
        let mut sum = 0.0;
        for mass in &masses {
            sum += mass / total;
            before.push((sum as f32).min(1.0));
        }
        let density = (0..cells).map(|cell| (before[cell + 1] - before[cell]) * INV_TWO_PI / widths[cell]);
        let density = density.collect();
        Self { density, before, below_pole }
    }

    /// The density at a place among the cells.
    #[inline]
    pub(super) fn density<R: Real>(&self, cell: R) -> R {
        let last = self.density.len() - 1;
        let place = cell.clamp(0.0, last as f32).to_int();
        R::from_fn(|i| self.density[(place.lane(i) as usize).min(last)])
    }

    /// 1 − cos θ_h with that density, from a number in [0, 1).
    #[inline]
    pub(super) fn below_pole<R: Real>(&self, u: R) -> R {
        R::from_fn(|i| {
            let u = u.lane(i);
            let cell = self.before.partition_point(|before| *before <= u).clamp(1, self.density.len()) - 1;
            let (low, high) = (self.before[cell], self.before[cell + 1]);
            let part = if high > low { ((u - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
            self.below_pole[cell] + (self.below_pole[cell + 1] - self.below_pole[cell]) * part
        })
    }
}
