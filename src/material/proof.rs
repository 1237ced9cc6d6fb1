//! What every reflection model must satisfy, for the models' tests.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::{Bsdf, Sample};
use crate::simd::{Mask, Real, Vector3, f32x8};

/// A repeatable sequence.
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// In [0, 1).
    pub(super) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / 16_777_216.0
    }

    /// A direction of the upper half, or of both.
    pub(super) fn direction(&mut self, both: bool) -> Vec3 {
        let z = self.unit() * if both { 2.0 } else { 1.0 } - if both { 1.0 } else { 0.0 };
        let (s, c) = (self.unit() * std::f32::consts::TAU).sin_cos();
        Vec3::new((1.0 - z * z).max(0.0).sqrt() * c, (1.0 - z * z).max(0.0).sqrt() * s, z)
    }
}

/// The direction with this angle from the normal, in degrees.
pub(super) fn at(degrees: f32) -> Vec3 {
    let (s, c) = degrees.to_radians().sin_cos();
    Vec3::new(s * 0.6, -s * 0.8, c)
}

fn toward(cos: f64, phi: f64) -> Vector3<f32> {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    Vector3::from(DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).as_vec3())
}

/// ∫ f dω over cos θ and φ in these ranges, by midpoints.
fn integrate(cos: (f64, f64), phi: (f64, f64), steps: u32, f: impl Fn(Vector3<f32>) -> f64) -> f64 {
    let place =
        |(low, high): (f64, f64), i: u32| low + (high - low) * (f64::from(i) + 0.5) / f64::from(steps);
    let mut sum = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            sum += f(toward(place(cos, i), place(phi, j)));
        }
    }
    sum * (cos.1 - cos.0) * (phi.1 - phi.0) / f64::from(steps * steps)
}

/// ∫ f dω over the upper hemisphere.
pub(super) fn hemisphere(f: impl Fn(Vector3<f32>) -> f64) -> f64 {
    integrate((0.0, 1.0), (0.0, TAU), 1000, f)
}

/// ∫ f cos θ dω per channel.
pub(super) fn albedo(bsdf: &Bsdf<f32>, wo: Vec3) -> [f64; 3] {
    [0, 1, 2].map(|i| hemisphere(|wi| f64::from(Vec3::from(bsdf.eval(wo.into(), wi))[i])))
}

/// f(a, b) = f(b, a): the cosine that `eval` contains is taken out.
pub(super) fn is_reciprocal(bsdf: &Bsdf<f32>) {
    let mut random = Random::new(1);
    for _ in 0..100_000 {
        let (a, b) = (random.direction(false), random.direction(false));
        let f = |wo: Vec3, wi: Vec3| Vec3::from(bsdf.eval(wo.into(), wi.into())) / wi.z;
        let (there, back) = (f(a, b), f(b, a));
        assert!(
            (there - back).abs().max_element() <= 1e-5 * (1.0 + there.max_element()),
            "{a} {b}: {there} {back}"
        );
    }
}

/// Black, and of density 0, unless both directions are on the side of the normal.
pub(super) fn is_black_from_behind(bsdf: &Bsdf<f32>) {
    let mut random = Random::new(2);
    for _ in 0..10_000 {
        let (wo, wi) = (random.direction(true), random.direction(true));
        if wo.z <= 0.0 || wi.z <= 0.0 {
            assert_eq!(Vec3::from(bsdf.eval(wo.into(), wi.into())), Vec3::ZERO);
            assert_eq!(bsdf.pdf(wo.into(), wi.into()), 0.0);
        }
        if wo.z <= 0.0 {
            assert!(!bsdf.sample(wo.into(), random.unit(), (random.unit(), random.unit())).valid);
        }
    }
}

/// ∫ pdf = the share of samples that are valid, to `tolerance`.
pub(super) fn density_is_that_of_valid_samples(bsdf: &Bsdf<f32>, wo: Vec3, tolerance: f64) -> f64 {
    let total = hemisphere(|wi| f64::from(bsdf.pdf(wo.into(), wi)));
    let (mut random, count) = (Random::new(3), 400_000);
    let mut draw = || bsdf.sample(wo.into(), random.unit(), (random.unit(), random.unit())).valid;
    let valid = (0..count).filter(|_| draw()).count() as f64 / f64::from(count);
    // Three standard deviations of a share.
    let noise = 3.0 * (valid * (1.0 - valid) / f64::from(count)).sqrt();
    assert!((total - valid).abs() < tolerance + noise, "∫pdf = {total}, {valid} of the samples are valid");
    total
}

/// A sample's density is `pdf`, its weight is `eval`/`pdf`, and it is of unit length and above.
pub(super) fn weights_are_quotients(bsdf: &Bsdf<f32>, wo: Vec3) {
    let mut random = Random::new(4);
    for _ in 0..50_000 {
        let sample = bsdf.sample(wo.into(), random.unit(), (random.unit(), random.unit()));
        if !sample.valid {
            continue;
        }
        assert!(!sample.delta && sample.eta == 1.0 && sample.wi.z > 0.0 && sample.pdf > 0.0, "{sample:?}");
        assert!((sample.wi.length() - 1.0).abs() < 1e-5, "{sample:?}");
        let pdf = bsdf.pdf(wo.into(), sample.wi);
        assert!((pdf - sample.pdf).abs() <= 1e-5 * pdf, "{pdf} {sample:?}");
        let (eval, weight) = (Vec3::from(bsdf.eval(wo.into(), sample.wi)), Vec3::from(sample.weight));
        assert!((weight * pdf - eval).abs().max_element() <= 1e-5 * eval.max_element(), "{eval} {sample:?}");
    }
}

/// The probability of a χ² at least this large, by the cube root's normal distribution (Wilson and
/// Hilferty 1931).
pub(super) fn chi2_p(chi2: f64, freedom: f64) -> f64 {
    let s = 2.0 / (9.0 * freedom);
    let z = ((chi2 / freedom).cbrt() - (1.0 - s)) / s.sqrt();
    0.5 * erfc(z / std::f64::consts::SQRT_2)
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

/// Samples fall into the bins of the hemisphere as `pdf` says: Pearson's χ², p > 0.01.
pub(super) fn sampling_matches_pdf(bsdf: &Bsdf<f32>, wo: Vec3) {
    const COS: usize = 20;
    const PHI: usize = 30;
    let count = 400_000;
    let mut observed = vec![0u32; COS * PHI];
    let mut random = Random::new(5);
    for _ in 0..count {
        let Sample { wi, valid, .. } = bsdf.sample(wo.into(), random.unit(), (random.unit(), random.unit()));
        if valid {
            let phi = f64::from(wi.y).atan2(f64::from(wi.x)).rem_euclid(TAU);
            let (i, j) = ((wi.z * COS as f32) as usize, (phi / TAU * PHI as f64) as usize);
            observed[i.min(COS - 1) * PHI + j.min(PHI - 1)] += 1;
        }
    }
    let mut chi2 = 0.0;
    let (mut freedom, mut rest) = (-1.0, (0.0, 0.0));
    let mut add = |expected: f64, seen: f64| {
        chi2 += (seen - expected).powi(2) / expected;
        freedom += 1.0;
    };
    let mut total = 0.0;
    for i in 0..COS {
        for j in 0..PHI {
            let edge = |k: usize, n: usize| k as f64 / n as f64;
            let cos = (edge(i, COS), edge(i + 1, COS));
            let phi = (edge(j, PHI) * TAU, edge(j + 1, PHI) * TAU);
            let share = integrate(cos, phi, 24, |wi| f64::from(bsdf.pdf(wo.into(), wi)));
            let (expected, seen) = (share * f64::from(count), f64::from(observed[i * PHI + j]));
            total += seen;
            // Bins that expect next to nothing are tested together.
            if expected < 8.0 {
                rest = (rest.0 + expected, rest.1 + seen);
            } else {
                add(expected, seen);
            }
        }
    }
    if rest.0 >= 8.0 {
        add(rest.0, rest.1);
    } else {
        assert!(rest.1 < 40.0, "{} samples where {} are expected", rest.1, rest.0);
    }
    let invalid = (
        f64::from(count) - hemisphere(|wi| f64::from(bsdf.pdf(wo.into(), wi))) * f64::from(count),
        f64::from(count) - total,
    );
    if invalid.0 >= 8.0 {
        add(invalid.0, invalid.1);
    }
    let p = chi2_p(chi2, freedom);
    assert!(p > 0.01, "χ² = {chi2} of {freedom} degrees of freedom: p = {p}");
}

/// The same model with the same parameters in eight lanes gives the bits of one, for 8 × 10,000 inputs.
pub(super) fn lanes_equal_scalar(one: &Bsdf<f32>, eight: &Bsdf<f32x8>) {
    let mut random = Random::new(6);
    let special = [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(0.0, -1.0, -0.0), Vec3::new(0.6, 0.0, 0.8)];
    let bits = |v: Vec3| v.to_array().map(f32::to_bits);
    for round in 0..10_000 {
        let mut pick = |i: usize| {
            if (round + i).is_multiple_of(9) {
                special[(round / 9 + i) % special.len()]
            } else {
                random.direction(true)
            }
        };
        let (wo, wi): ([Vec3; 8], [Vec3; 8]) =
            (std::array::from_fn(&mut pick), std::array::from_fn(|i| pick(i + 4)));
        let numbers: [[f32; 3]; 8] = [(); 8].map(|()| [(); 3].map(|()| random.unit()));
        let (wo8, wi8) = (Vector3::from_fn(|i| wo[i]), Vector3::from_fn(|i| wi[i]));
        let number = |k: usize| f32x8::from_fn(|i| numbers[i][k]);
        let (eval, pdf) = (eight.eval(wo8, wi8), eight.pdf(wo8, wi8));
        let sample = eight.sample(wo8, number(0), (number(1), number(2)));
        let branches = eight.branches(wo8);
        for i in 0..8 {
            let (wo, wi): (Vector3<f32>, Vector3<f32>) = (wo[i].into(), wi[i].into());
            assert_eq!(bits(eval.lane(i)), bits(one.eval(wo, wi).into()));
            assert_eq!(pdf.lane(i).to_bits(), one.pdf(wo, wi).to_bits());
            let want = one.sample(wo, numbers[i][0], (numbers[i][1], numbers[i][2]));
            assert_eq!((sample.valid.lane(i), sample.delta.lane(i)), (want.valid, want.delta));
            if want.valid {
                assert_eq!(bits(sample.wi.lane(i)), bits(want.wi.into()));
                assert_eq!(bits(sample.weight.lane(i)), bits(want.weight.into()));
                assert_eq!(sample.pdf.lane(i).to_bits(), want.pdf.to_bits());
                assert_eq!(sample.eta.lane(i).to_bits(), want.eta.to_bits());
            }
            for (branch, want) in branches.iter().zip(one.branches(wo)) {
                assert_eq!(branch.valid.to_bitmask() >> i & 1 != 0, want.valid);
                if want.valid {
                    assert_eq!(bits(branch.wi.lane(i)), bits(want.wi.into()));
                    assert_eq!(bits(branch.weight.lane(i)), bits(want.weight.into()));
                }
            }
        }
    }
}

#[test]
fn the_tools_know_what_is_known() {
    assert!((hemisphere(|_| 1.0) - TAU).abs() < 1e-9);
    assert!((hemisphere(|wi| f64::from(wi.z)) - PI).abs() < 1e-6);
    // Tables: χ² of 0.05 for 10 and 100, of 0.01 for 100 degrees of freedom.
    for (chi2, freedom, p) in
        [(18.307, 10.0, 0.05), (124.342, 100.0, 0.05), (135.807, 100.0, 0.01), (99.334, 100.0, 0.5)]
    {
        assert!((chi2_p(chi2, freedom) - p).abs() < 2e-3, "{}", chi2_p(chi2, freedom));
    }
}
