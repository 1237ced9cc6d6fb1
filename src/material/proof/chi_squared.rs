//! Samples against the density that they are said to have, by Pearson's χ².

use std::f64::consts::{SQRT_2, TAU};

use glam::Vec3;

use super::{Random, Reflector, integrate};
use crate::simd::{Mask, Real, Vector3};

/// Bins along cos θ and along φ.
const COS: usize = 20;
const PHI: usize = 30;
/// Bins that expect fewer samples are tested together.
const FEWEST: f64 = 8.0;
/// Points a side of a bin: at first, and where the integral still changes.
const STEPS: (usize, usize) = (24, 192);

/// How well samples seen from one direction follow their density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Probability of a χ² at least as large as the one found, if they do follow it.
    pub p: f64,
    /// Pearson's statistic.
    pub chi_squared: f64,
    /// Its degrees of freedom.
    pub freedom: f64,
    /// ∫ pdf dω.
    pub density: f64,
    /// Share of the samples that carry light and are of no delta lobe: what the integral should be.
    pub share: f64,
    /// Samples that carry no light at all.
    pub lost: f64,
    /// Number of samples.
    pub count: usize,
}

impl Fit {
    /// Draws `count` samples (a multiple of eight) seen from `wo` and counts them in 600 bins of equal
    /// solid angle, in which it integrates the density.
    pub fn new<R: Real>(model: &impl Reflector<R>, wo: Vec3, count: usize, seed: u64) -> Self {
        let low = if model.transmits() { -1.0 } else { 0.0 };
        let (observed, lost) = draw(model, wo, low, count, seed);
        let expected = expect(model, wo, low, count);
        let mut test = Pearson::default();
        for (&seen, &share) in observed.iter().zip(&expected) {
            test.bin(f64::from(seen), share * count as f64);
        }
        let total: u32 = observed.iter().sum();
        let density: f64 = expected.iter().sum();
        test.bin((count - total as usize) as f64, count as f64 * (1.0 - density));
        let (p, chi_squared, freedom) = test.finish();
        let share = f64::from(total) / count as f64;
        Self { p, chi_squared, freedom, density, share, lost: lost as f64 / count as f64, count }
    }

    /// |∫pdf − share|, less three standard deviations of the share's noise.
    pub fn excess(&self) -> f64 {
        let noise = 3.0 * (self.share * (1.0 - self.share) / self.count as f64).sqrt();
        ((self.density - self.share).abs() - noise).max(0.0)
    }
}

/// How many samples fall into each bin, and how many carry nothing.
fn draw<R: Real>(
    model: &impl Reflector<R>,
    wo: Vec3,
    low: f64,
    count: usize,
    seed: u64,
) -> (Vec<u32>, usize) {
    let mut observed = vec![0u32; COS * PHI];
    let mut lost = 0;
    let mut random = Random::new(seed);
    for _ in 0..count / R::LANES {
        let [lobe, u, v] = random.triple();
        let sample = model.sample(Vector3::splat(wo), lobe, (u, v));
        lost += R::LANES - sample.valid.count() as usize;
        let smooth = (sample.valid & !sample.delta).to_bitmask();
        for wi in (0..R::LANES).filter(|i| smooth >> i & 1 != 0).map(|i| sample.wi.lane(i).as_dvec3()) {
            let turn = wi.y.atan2(wi.x).rem_euclid(TAU) / TAU;
            let z = (wi.z - low) / (1.0 - low);
            let (i, j) = ((z * COS as f64) as usize, (turn * PHI as f64) as usize);
            observed[i.min(COS - 1) * PHI + j.min(PHI - 1)] += 1;
        }
    }
    (observed, lost)
}

/// The integral of the density over each bin.
fn expect<R: Real>(model: &impl Reflector<R>, wo: Vec3, low: f64, count: usize) -> Vec<f64> {
    let pdf = |wi| [model.eval_pdf(Vector3::splat(wo), wi).1];
    let bin = |i: usize, j: usize| {
        let edge = |k: usize, n: usize| k as f64 / n as f64;
        let cos = (low + (1.0 - low) * edge(i, COS), low + (1.0 - low) * edge(i + 1, COS));
        let phi = (edge(j, PHI) * TAU, edge(j + 1, PHI) * TAU);
        let mut steps = STEPS.0;
        let [mut share] = integrate(cos, phi, steps, pdf);
        loop {
            // Narrow lobes, and edges where total reflection begins, want more points than the rest.
            let [finer] = integrate(cos, phi, 2 * steps, pdf);
            let change = (finer - share).abs() * count as f64;
            share = finer;
            steps *= 2;
            // A twentieth of a bin's standard deviation is beyond what the test could see.
            if steps >= STEPS.1 || change <= 0.05 * (share * count as f64).max(FEWEST).sqrt() {
                return share;
            }
        }
    };
    (0..COS * PHI).map(|k| bin(k / PHI, k % PHI)).collect()
}

/// The statistic in the making.
#[derive(Default)]
struct Pearson {
    chi_squared: f64,
    bins: f64,
    /// Seen and expected in the bins that expect too few.
    rest: (f64, f64),
}

impl Pearson {
    fn bin(&mut self, seen: f64, expected: f64) {
        if expected < FEWEST {
            self.rest = (self.rest.0 + seen, self.rest.1 + expected);
        } else {
            self.add(seen, expected);
        }
    }

    fn add(&mut self, seen: f64, expected: f64) {
        self.chi_squared += (seen - expected).powi(2) / expected;
        self.bins += 1.0;
    }

    /// p, χ² and the degrees of freedom.
    fn finish(mut self) -> (f64, f64, f64) {
        let (seen, expected) = self.rest;
        if expected >= FEWEST {
            self.add(seen, expected);
        } else if seen >= 5.0 * FEWEST {
            // Where next to nothing is expected, χ² would divide by it.
            return (0.0, f64::INFINITY, self.bins);
        }
        let freedom = self.bins - 1.0;
        // One bin holds all samples: they agree if they are all there.
        let p = if freedom > 0.0 { chi_squared_tail(self.chi_squared, freedom) } else { 1.0 };
        (p, self.chi_squared, freedom)
    }
}

/// The probability of a χ² at least this large, by the cube root's normal distribution (Wilson and
/// Hilferty 1931).
pub fn chi_squared_tail(chi_squared: f64, freedom: f64) -> f64 {
    let s = 2.0 / (9.0 * freedom);
    let z = ((chi_squared / freedom).cbrt() - (1.0 - s)) / s.sqrt();
    0.5 * erfc(z / SQRT_2)
}

/// The level of each of `tests` independent tests at which all of them together have the level `all`:
/// 1 − (1 − all)^(1/tests) \[Sid67\].
pub fn sidak(all: f64, tests: usize) -> f64 {
    // The difference to 1 would lose the digits that count.
    -((-all).ln_1p() / tests.max(1) as f64).exp_m1()
}

/// erfc to about 1e-7, by a Chebyshev fit.
fn erfc(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.5 * x.abs());
    let fit = [
        -1.265_512_23,
        1.000_023_68,
        0.374_091_96,
        0.096_784_18,
        -0.186_288_06,
        0.278_868_07,
        -1.135_203_98,
        1.488_515_87,
        -0.822_152_23,
        0.170_872_77,
    ];
    let polynomial = fit.iter().rev().fold(0.0, |sum, c| sum * t + c);
    let erfc = t * (-x * x + polynomial).exp();
    if x < 0.0 { 2.0 - erfc } else { erfc }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Sample;
    use crate::math::warp;
    use crate::simd::{Mask8, f32x8};

    #[test]
    fn tails_are_those_of_tables() {
        // χ² of 0.05 for 10 and 100, of 0.01 for 100 degrees of freedom.
        for (chi_squared, freedom, p) in
            [(18.307, 10.0, 0.05), (124.342, 100.0, 0.05), (135.807, 100.0, 0.01), (99.334, 100.0, 0.5)]
        {
            let found = chi_squared_tail(chi_squared, freedom);
            assert!((found - p).abs() < 2e-3, "{found}");
        }
    }

    #[test]
    fn the_level_of_many_tests_is_that_of_all() {
        assert!((sidak(0.01, 1) - 0.01).abs() < 1e-15);
        for tests in [2, 7, 100] {
            assert!((1.0 - (1.0 - sidak(0.01, tests)).powi(tests as i32) - 0.01).abs() < 1e-12);
        }
    }

    /// Draws by the cosine, of one side or of both, and says that its density is something else.
    struct Claims {
        density: fn(f32) -> f32,
        both: bool,
        /// Of the samples, how many carry light.
        valid: f32,
    }

    fn cosine(z: f32) -> f32 {
        z.abs() / std::f32::consts::PI
    }

    impl Reflector<f32x8> for Claims {
        fn eval_pdf(&self, _: Vector3<f32x8>, wi: Vector3<f32x8>) -> (Vector3<f32x8>, f32x8) {
            let pdf = f32x8::from_fn(|i| (self.density)(wi.z.lane(i)));
            (wi.map(|_| pdf), pdf)
        }

        fn sample(&self, _: Vector3<f32x8>, lobe: f32x8, (u, v): (f32x8, f32x8)) -> Sample<f32x8> {
            let w = warp::cosine_hemisphere(u, v);
            let below = lobe.lt(f32x8::splat(0.5)) & Mask8::splat(self.both);
            let wi = Vector3 { z: f32x8::select(below, -w.z, w.z), ..w };
            let (one, valid) = (f32x8::one(), lobe.lt(f32x8::splat(self.valid)));
            Sample { wi, weight: wi, pdf: one, eta: one, delta: Mask8::splat(false), valid }
        }

        fn transmits(&self) -> bool {
            self.both
        }
    }

    fn fit(density: fn(f32) -> f32, both: bool, valid: f32) -> Fit {
        Fit::new(&Claims { density, both, valid }, Vec3::Z, 80_000, 11)
    }

    #[test]
    fn what_is_drawn_as_it_is_said_fits() {
        for (fit, valid) in [
            (fit(cosine, false, 1.0), 1.0),
            (fit(|z| 0.5 * cosine(z), true, 1.0), 1.0),
            (fit(|z| 0.75 * cosine(z), false, 0.75), 0.75),
        ] {
            assert!(fit.p > 1e-3 && fit.p < 0.999, "{fit:?}");
            assert!((fit.density - valid).abs() < 1e-3 && fit.excess() < 1e-6, "{fit:?}");
            assert!((fit.lost - (1.0 - valid)).abs() < 0.01 && fit.lost + fit.share == 1.0, "{fit:?}");
            // χ² is about as large as its degrees of freedom, one less than there are bins with enough samples.
            assert!(fit.freedom > 550.0 && fit.freedom <= 600.0, "{fit:?}");
            assert!((fit.chi_squared / fit.freedom - 1.0).abs() < 0.2, "{fit:?}");
        }
    }

    #[test]
    fn what_is_drawn_otherwise_does_not() {
        // Uniform; a tenth too little; nothing where much is drawn.
        let densities: [fn(f32) -> f32; 3] = [
            |_| 0.5 / std::f32::consts::PI,
            |z| 0.9 * cosine(z),
            |z| if z > 0.5 { cosine(z) / 0.75 } else { 0.0 },
        ];
        for density in densities {
            let fit = fit(density, false, 1.0);
            assert!(fit.p < 1e-9 && fit.chi_squared > 2.0 * fit.freedom, "{fit:?}");
        }
        assert!(fit(densities[1], false, 1.0).excess() > 0.09);
    }
}
