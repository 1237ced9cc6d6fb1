//! What the models' tests assert of a model in one lane.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::{Fit, Random, Reflector, at, integrate, sidak};
use crate::material::Bsdf;
use crate::simd::{Mask, Real, Vector3, f32x8};

fn toward(cos: f64, phi: f64) -> Vector3<f32> {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    Vector3::from(DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).as_vec3())
}

/// ∫ f dω over the upper hemisphere.
pub(crate) fn hemisphere(f: impl Fn(Vector3<f32>) -> f64) -> f64 {
    let [sum] = integrate((0.0, 1.0), (0.0, TAU), 1000, |wi: Vector3<f32>| [f(wi) as f32]);
    sum
}

/// ∫ pdf dω over all directions that the model can draw.
fn total_density(bsdf: &Bsdf<f32>, wo: Vec3) -> f64 {
    let pdf = |wi| [bsdf.pdf(wo.into(), wi)];
    let below = if bsdf.transmits() { integrate((-1.0, 0.0), (0.0, TAU), 1000, pdf) } else { [0.0] };
    let above = integrate((0.0, 1.0), (0.0, TAU), 1000, pdf);
    below[0] + above[0]
}

/// ∫ f cos θ dω per channel.
pub(crate) fn albedo(bsdf: &Bsdf<f32>, wo: Vec3) -> [f64; 3] {
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
pub(crate) fn conserves_energy(bsdf: &Bsdf<f32>) {
    for degrees in [0.0, 30.0, 60.0, 80.0, 88.0] {
        let albedo = albedo(bsdf, at(degrees));
        assert!(albedo.iter().all(|a| *a <= 1.0 + 2e-3), "{degrees}: {albedo:?}");
    }
}

/// The greatest relative change of f where both directions turn about the normal.
pub(crate) fn anisotropy(bsdf: &Bsdf<f32>) -> f32 {
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
pub(crate) const ABOVE: [[f32; 4]; 6] = [
    [0.0, 0.0, 20.0, 40.0],
    [30.0, 20.0, 35.0, 190.0],
    [50.0, 100.0, 48.0, 285.0],
    [75.0, 200.0, 60.0, 15.0],
    [40.0, 0.0, 40.0, 150.0],
    [80.0, 310.0, 82.0, 128.0],
];

/// The same, through the surface, from either side; the fourth is reflected below it.
pub(crate) const THROUGH: [[f32; 4]; 6] = [
    [30.0, 20.0, 160.0, 205.0],
    [60.0, 100.0, 145.0, 280.0],
    [140.0, 30.0, 20.0, 200.0],
    [120.0, 250.0, 130.0, 75.0],
    [160.0, 0.0, 35.0, 180.0],
    [10.0, 0.0, 175.0, 170.0],
];

/// (r, g, b, pdf) of `eval` and `pdf` at these pairs.
pub(crate) fn has_values(bsdf: &Bsdf<f32>, pairs: &[[f32; 4]; 6], values: &[[f32; 4]; 6], tolerance: f32) {
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
pub(crate) fn is_sound(bsdf: &Bsdf<f32>, angles: &[f32]) {
    is_reciprocal_to(1e-4, bsdf);
    is_black_from_behind(bsdf);
    conserves_energy(bsdf);
    samples_are_right(bsdf, angles);
}

/// Sampling, densities and weights agree, seen from these angles.
pub(crate) fn samples_are_right(bsdf: &Bsdf<f32>, angles: &[f32]) {
    for &degrees in angles {
        density_is_that_of_valid_samples(bsdf, at(degrees), 3e-3);
        weights_are_quotients(bsdf, at(degrees));
        sampling_matches_pdf(bsdf, at(degrees));
    }
}

/// f(a, b) = f(b, a), to a relative 10⁻⁵: the cosine that `eval` contains is taken out.
pub(crate) fn is_reciprocal(bsdf: &Bsdf<f32>) {
    is_reciprocal_to(1e-5, bsdf);
}

/// The same to a tolerance: with microfacets, the angle to the half vector is computed from one side or
/// from the other.
pub(crate) fn is_reciprocal_to(tolerance: f32, bsdf: &Bsdf<f32>) {
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
pub(crate) fn is_black_from_behind(bsdf: &Bsdf<f32>) {
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
pub(crate) fn density_is_that_of_valid_samples(bsdf: &Bsdf<f32>, wo: Vec3, tolerance: f64) -> f64 {
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
pub(crate) fn weights_are_quotients(bsdf: &Bsdf<f32>, wo: Vec3) {
    let mut random = Random::new(4);
    for _ in 0..50_000 {
        let sample = bsdf.sample(wo.into(), random.unit(), (random.unit(), random.unit()));
        if !sample.valid {
            continue;
        }
        assert!(!sample.delta && sample.pdf > 0.0, "{sample:?}");
        let stays = sample.wi.z * wo.z > 0.0;
        assert!((stays && sample.eta == 1.0) || (!stays && bsdf.transmits() && sample.eta != 1.0));
        assert!((sample.wi.length() - 1.0).abs() < 1e-5, "{sample:?}");
        let pdf = bsdf.pdf(wo.into(), sample.wi);
        assert!((pdf - sample.pdf).abs() <= 1e-5 * pdf, "{pdf} {sample:?}");
        let (eval, weight) = (Vec3::from(bsdf.eval(wo.into(), sample.wi)), Vec3::from(sample.weight));
        assert!((weight * pdf - eval).abs().max_element() <= 1e-5 * eval.max_element(), "{eval} {sample:?}");
    }
}

/// χ² tests that the whole suite runs: models and their parameters times angles.
const SUITE: usize = 77;

/// Samples fall into the bins of the sphere as `pdf` says: Pearson's χ². The level is that at which all
/// tests of the suite together fail one time in a hundred if every model is right.
pub(crate) fn sampling_matches_pdf(bsdf: &Bsdf<f32>, wo: Vec3) {
    let fit = Fit::new(bsdf, wo, 400_000, 5);
    assert!(fit.p > sidak(0.01, SUITE), "{wo}: {fit:?}");
}

/// The same model with the same parameters in eight lanes gives the bits of one, for 8 × 10,000 inputs.
pub(crate) fn lanes_equal_scalar(one: &Bsdf<f32>, eight: &Bsdf<f32x8>) {
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
}
