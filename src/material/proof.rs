//! What every reflection model must satisfy, for the models' tests.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::{Bsdf, Sample};
use crate::simd::{Mask, Real, Vector3, f32x8};

/// A repeatable sequence, by Steele, Lea and Flood's "SplitMix" (2014): numbers drawn in threes must not
/// lie on planes.
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x5851_f42d_4c95_7f2d))
    }

    /// In [0, 1).
    pub(super) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 40) as f32 / 16_777_216.0
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

/// ∫ f dω over cos θ and φ in these ranges, on one side of the horizon: in s = √(1 − |cos θ|), which
/// spreads out what happens about the pole, by Gauss's rule of two points; in φ by midpoints.
fn integrate(cos: (f64, f64), phi: (f64, f64), steps: u32, f: impl Fn(Vector3<f32>) -> f64) -> f64 {
    let from_pole = |cos: f64| (1.0 - cos.abs()).sqrt();
    let (first, last) = (from_pole(cos.0), from_pole(cos.1));
    let side = if cos.0 < 0.0 { -1.0 } else { 1.0 };
    let (width, turn) = ((last - first) / f64::from(steps / 2), (phi.1 - phi.0) / f64::from(steps));
    let mut sum = 0.0;
    for i in 0..steps {
        let in_cell = 0.5 + (f64::from(i % 2) - 0.5) / 3.0f64.sqrt();
        let s = first + width * (f64::from(i / 2) + in_cell);
        for j in 0..steps {
            let phi = phi.0 + turn * (f64::from(j) + 0.5);
            sum += s * f(toward(side * (1.0 - s * s), phi));
        }
    }
    sum * width.abs() * turn
}

/// ∫ f dω over the upper hemisphere.
pub(super) fn hemisphere(f: impl Fn(Vector3<f32>) -> f64) -> f64 {
    integrate((0.0, 1.0), (0.0, TAU), 1000, f)
}

/// The lowest cosine at which a model can send light.
fn lowest(bsdf: &Bsdf<f32>) -> f64 {
    let transmits = match bsdf {
        Bsdf::RoughDielectric(_) => true,
        Bsdf::Principled(principled) => principled.spec_trans > 0.0,
        _ => false,
    };
    if transmits { -1.0 } else { 0.0 }
}

/// ∫ pdf dω over all directions that the model can draw.
fn total_density(bsdf: &Bsdf<f32>, wo: Vec3) -> f64 {
    let pdf = |wi| f64::from(bsdf.pdf(wo.into(), wi));
    let below = if lowest(bsdf) < 0.0 { integrate((-1.0, 0.0), (0.0, TAU), 1000, pdf) } else { 0.0 };
    below + hemisphere(pdf)
}

/// ∫ f cos θ dω per channel.
pub(super) fn albedo(bsdf: &Bsdf<f32>, wo: Vec3) -> [f64; 3] {
    let mut sum = DVec3::ZERO;
    let steps = 700;
    for i in 0..steps {
        for j in 0..steps {
            let at = |k: u32| (f64::from(k) + 0.5) / f64::from(steps);
            sum += Vec3::from(bsdf.eval(wo.into(), toward(at(i), TAU * at(j)))).as_dvec3();
        }
    }
    (sum * TAU / f64::from(steps * steps)).to_array()
}

/// No more light leaves than arrives, from any angle.
pub(super) fn conserves_energy(bsdf: &Bsdf<f32>) {
    for degrees in [0.0, 30.0, 60.0, 80.0, 88.0] {
        let albedo = albedo(bsdf, at(degrees));
        assert!(albedo.iter().all(|a| *a <= 1.0 + 2e-3), "{degrees}: {albedo:?}");
    }
}

/// The greatest relative change of f where both directions turn about the normal.
pub(super) fn anisotropy(bsdf: &Bsdf<f32>) -> f32 {
    let mut random = Random::new(7);
    let mut most = 0.0f32;
    for _ in 0..20_000 {
        let (wo, wi) = (random.direction(false), random.direction(false));
        let turn = glam::Quat::from_rotation_z(random.unit() * std::f32::consts::TAU);
        let f = |wo: Vec3, wi: Vec3| Vec3::from(bsdf.eval(wo.into(), wi.into())).max_element();
        let (a, b) = (f(wo, wi), f(turn * wo, turn * wi));
        most = most.max((a - b).abs() / (1e-3 + a.max(b)));
    }
    most
}

/// Pairs (θ_o, φ_o, θ_i, φ_i) in degrees at which other renderers have been asked.
pub(super) const ABOVE: [[f32; 4]; 6] = [
    [0.0, 0.0, 20.0, 40.0],
    [30.0, 20.0, 35.0, 190.0],
    [50.0, 100.0, 48.0, 285.0],
    [75.0, 200.0, 60.0, 15.0],
    [40.0, 0.0, 40.0, 150.0],
    [80.0, 310.0, 82.0, 128.0],
];

/// The same, through the surface, from either side; the fourth is reflected below it.
pub(super) const THROUGH: [[f32; 4]; 6] = [
    [30.0, 20.0, 160.0, 205.0],
    [60.0, 100.0, 145.0, 280.0],
    [140.0, 30.0, 20.0, 200.0],
    [120.0, 250.0, 130.0, 75.0],
    [160.0, 0.0, 35.0, 180.0],
    [10.0, 0.0, 175.0, 170.0],
];

/// (r, g, b, pdf) of `eval` and `pdf` at these pairs.
pub(super) fn has_values(bsdf: &Bsdf<f32>, pairs: &[[f32; 4]; 6], values: &[[f32; 4]; 6], tolerance: f32) {
    let direction = |theta: f32, phi: f32| {
        let ((s, c), (sin, cos)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
        Vec3::new(s * cos, s * sin, c)
    };
    for (&[theta_o, phi_o, theta_i, phi_i], &[r, g, b, pdf]) in pairs.iter().zip(values) {
        let (wo, wi) = (direction(theta_o, phi_o).into(), direction(theta_i, phi_i).into());
        let (eval, got) = bsdf.eval_pdf(wo, wi);
        let (eval, want) = (Vec3::from(eval), Vec3::new(r, g, b));
        let off = (eval - want).abs() - tolerance * want - 1e-6;
        assert!(off.max_element() <= 0.0, "{theta_o} {theta_i}: {eval}, not {want}");
        // NaN: the other renderer's density is another one.
        assert!(
            pdf.is_nan() || (got - pdf).abs() <= tolerance * pdf,
            "{theta_o} {theta_i}: {got}, not {pdf}"
        );
    }
}

/// All that can be said of a smooth model that is black from behind.
pub(super) fn is_sound(bsdf: &Bsdf<f32>, angles: &[f32]) {
    is_reciprocal_to(1e-4, bsdf);
    is_black_from_behind(bsdf);
    conserves_energy(bsdf);
    samples_are_right(bsdf, angles);
}

/// Sampling, densities and weights agree, seen from these angles.
pub(super) fn samples_are_right(bsdf: &Bsdf<f32>, angles: &[f32]) {
    for &degrees in angles {
        density_is_that_of_valid_samples(bsdf, at(degrees), 3e-3);
        weights_are_quotients(bsdf, at(degrees));
        sampling_matches_pdf(bsdf, at(degrees));
    }
}

/// f(a, b) = f(b, a), to a relative 10⁻⁵: the cosine that `eval` contains is taken out.
pub(super) fn is_reciprocal(bsdf: &Bsdf<f32>) {
    is_reciprocal_to(1e-5, bsdf);
}

/// The same to a tolerance: with microfacets, the angle to the half vector is computed from one side or
/// from the other.
pub(super) fn is_reciprocal_to(tolerance: f32, bsdf: &Bsdf<f32>) {
    let mut random = Random::new(1);
    for _ in 0..100_000 {
        let (a, b) = (random.direction(false), random.direction(false));
        let f = |wo: Vec3, wi: Vec3| Vec3::from(bsdf.eval(wo.into(), wi.into())) / wi.z;
        let (there, back) = (f(a, b), f(b, a));
        assert!(
            (there - back).abs().max_element() <= tolerance * (1.0 + there.max_element()),
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
    let total = total_density(bsdf, wo);
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
        assert!(!sample.delta && sample.pdf > 0.0, "{sample:?}");
        let stays = sample.wi.z * wo.z > 0.0;
        assert!((stays && sample.eta == 1.0) || (!stays && lowest(bsdf) < 0.0 && sample.eta != 1.0));
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
    let low = lowest(bsdf);
    let mut observed = vec![0u32; COS * PHI];
    // Models on one side and on both don't share their luck.
    let mut random = Random::new(if low < 0.0 { 11 } else { 5 });
    for _ in 0..count {
        let Sample { wi, valid, .. } = bsdf.sample(wo.into(), random.unit(), (random.unit(), random.unit()));
        if valid {
            let phi = f64::from(wi.y).atan2(f64::from(wi.x)).rem_euclid(TAU);
            let z = (f64::from(wi.z) - low) / (1.0 - low);
            let (i, j) = ((z * COS as f64) as usize, (phi / TAU * PHI as f64) as usize);
            observed[i.min(COS - 1) * PHI + j.min(PHI - 1)] += 1;
        }
    }
    let mut chi2 = 0.0;
    let (mut freedom, mut rest) = (-1.0, (0.0, 0.0));
    let mut add = |expected: f64, seen: f64| {
        chi2 += (seen - expected).powi(2) / expected;
        freedom += 1.0;
    };
    let (mut total, mut drawn) = (0.0, 0.0);
    for i in 0..COS {
        for j in 0..PHI {
            let edge = |k: usize, n: usize| k as f64 / n as f64;
            let cos = (low + (1.0 - low) * edge(i, COS), low + (1.0 - low) * edge(i + 1, COS));
            let phi = (edge(j, PHI) * TAU, edge(j + 1, PHI) * TAU);
            // Refraction has edges, where total reflection begins.
            let share =
                integrate(cos, phi, if low < 0.0 { 64 } else { 24 }, |wi| f64::from(bsdf.pdf(wo.into(), wi)));
            let (expected, seen) = (share * f64::from(count), f64::from(observed[i * PHI + j]));
            total += seen;
            drawn += share;
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
    let invalid = (f64::from(count) * (1.0 - drawn), f64::from(count) - total);
    if invalid.0 >= 8.0 {
        add(invalid.0, invalid.1);
    }
    let p = chi2_p(chi2, freedom);
    assert!(p > 0.01, "{wo}: χ² = {chi2} of {freedom} degrees of freedom: p = {p}");
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
