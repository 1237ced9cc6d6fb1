use glam::Vec3;

use super::*;
use crate::material::{Bsdf, Distribution, proof};

const KINDS: [Distribution; 2] = [Distribution::Beckmann, Distribution::Ggx];

fn glass<R: Real>(kind: Distribution, alpha: f32, eta: f32) -> Bsdf<'static, R> {
    Bsdf::RoughDielectric(RoughDielectric {
        surface: Microfacet::new(kind, R::splat(alpha), R::splat(alpha)),
        eta: R::splat(eta),
        reflectance: Vector3::splat(Vec3::ONE),
        transmittance: Vector3::splat(Vec3::ONE),
    })
}

#[test]
fn lanes_equal_scalar() {
    for kind in KINDS {
        for eta in [1.5, 1.0 / 1.5] {
            proof::lanes_equal_scalar(&glass(kind, 0.3, eta), &glass(kind, 0.3, eta));
        }
    }
}

#[test]
fn samples_are_distributed_by_the_density() {
    for kind in KINDS {
        for (alpha, eta) in [(0.4, 1.5), (0.5, 1.0 / 1.5)] {
            // From above, and from below.
            proof::samples_are_right(&glass(kind, alpha, eta), &[0.0, 40.0, 70.0, 140.0, 180.0]);
        }
    }
}

/// f_t(wo, wi)/n(wo)² is symmetric, and f_r is.
#[test]
fn it_is_reciprocal_once_radiance_is_over_the_square_of_the_index() {
    let mut random = proof::Random::new(1);
    for kind in KINDS {
        let bsdf = glass::<f32>(kind, 0.5, 1.5);
        for _ in 0..100_000 {
            let (a, b) = (random.direction(true), random.direction(true));
            let n2 = |w: Vec3| if w.z > 0.0 { 1.0 } else { 2.25 };
            let f = |wo: Vec3, wi: Vec3| bsdf.eval(wo.into(), wi.into()).x / wi.z.abs() / n2(wo);
            let (there, back) = (f(a, b), f(b, a));
            assert!((there - back).abs() <= 1e-3 * (1.0 + there), "{a} {b}: {there} {back}");
        }
    }
}

/// Reflected and transmitted power, radiance put back by n²: single scattering loses a little.
#[test]
fn energy_is_kept_but_for_what_a_second_bounce_would_carry() {
    let mut random = proof::Random::new(2);
    for kind in KINDS {
        for (degrees, least) in [(0.0, 0.97), (45.0, 0.96), (180.0, 0.9), (150.0, 0.85)] {
            let (bsdf, wo) = (glass::<f32>(kind, 0.2, 1.5), proof::at(degrees));
            let (count, mut power) = (100_000, 0.0);
            for _ in 0..count {
                let sample = bsdf.sample(wo.into(), random.unit(), (random.unit(), random.unit()));
                if sample.valid {
                    power += f64::from(sample.weight.x * sample.eta * sample.eta);
                }
            }
            let power = power / f64::from(count);
            assert!(power < 1.002 && power > least, "{kind:?} {degrees}: {power}");
        }
    }
}

/// What Mitsuba 3.9.1 gives for the same parameters; its density for Beckmann has another G1.
#[test]
fn it_is_that_of_mitsuba() {
    use Distribution::{Beckmann, Ggx};
    proof::has_values(&glass(Ggx, 0.3, 1.5), &proof::ABOVE, &GGX, 2e-4);
    proof::has_values(&glass(Ggx, 0.3, 1.5), &proof::THROUGH, &GGX_THROUGH, 2e-4);
    proof::has_values(&glass(Beckmann, 0.4, 1.5), &proof::ABOVE, &BECKMANN, 2e-4);
    proof::has_values(&glass(Beckmann, 0.4, 1.5), &proof::THROUGH, &BECKMANN_THROUGH, 2e-4);
}

const GGX: [[f32; 4]; 6] = [
    [0.02071768, 0.02071768, 0.02071768, 0.02077925],
    [0.03831236, 0.03831236, 0.03831236, 0.03873045],
    [0.0684947, 0.0684947, 0.0684947, 0.07034559],
    [0.2221171, 0.2221171, 0.2221171, 0.2362152],
    [0.02361827, 0.02361827, 0.02361827, 0.02398669],
    [0.6807469, 0.6807469, 0.6807469, 1.142715],
];
const GGX_THROUGH: [[f32; 4]; 6] = [
    [9.354651, 9.354651, 9.354651, 21.11052],
    [4.517891, 4.517891, 4.517891, 10.27618],
    [0.1097382, 0.1097382, 0.1097382, 0.04891748],
    [1.29695, 1.29695, 1.29695, 1.337149],
    [12.60051, 12.60051, 12.60051, 5.66134],
    [10.36019, 10.36019, 10.36019, 23.31444],
];
const BECKMANN: [[f32; 4]; 6] = [
    [0.0174221, 0.0174221, 0.0174221, f32::NAN],
    [0.02369324, 0.02369324, 0.02369324, f32::NAN],
    [0.04263566, 0.04263566, 0.04263566, f32::NAN],
    [0.2187368, 0.2187368, 0.2187368, f32::NAN],
    [0.02370252, 0.02370252, 0.02370252, f32::NAN],
    [0.6470836, 0.6470836, 0.6470836, f32::NAN],
];
const BECKMANN_THROUGH: [[f32; 4]; 6] = [
    [5.927354, 5.927354, 5.927354, f32::NAN],
    [2.732533, 2.732533, 2.732533, f32::NAN],
    [0.0, 0.0, 0.0, f32::NAN],
    [0.9462997, 0.9462997, 0.9462997, f32::NAN],
    [8.393859, 8.393859, 8.393859, f32::NAN],
    [6.741525, 6.741525, 6.741525, f32::NAN],
];
