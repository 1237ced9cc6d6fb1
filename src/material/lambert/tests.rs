use glam::Vec3;

use super::*;
use crate::material::{Bsdf, proof};

const RHO: Vec3 = Vec3::new(0.25, 0.5, 1.0);

fn lambert<R: Real>() -> Bsdf<'static, R> {
    Bsdf::Lambert(Lambert { reflectance: Vector3::splat(RHO) })
}

#[test]
fn lanes_equal_scalar() {
    proof::lanes_equal_scalar(&lambert(), &lambert());
}

#[test]
fn it_is_reciprocal_and_black_from_behind() {
    proof::is_reciprocal(&lambert());
    proof::is_black_from_behind(&lambert());
}

#[test]
fn the_albedo_is_rho_from_everywhere() {
    for degrees in [0.0, 30.0, 60.0, 85.0, 89.9] {
        let albedo = proof::albedo(&lambert(), proof::at(degrees));
        for i in 0..3 {
            assert!((albedo[i] - f64::from(RHO[i])).abs() < 1e-5, "{degrees}: {albedo:?}");
        }
    }
}

#[test]
fn samples_are_distributed_by_the_density() {
    for degrees in [0.0, 60.0] {
        let total = proof::density_is_that_of_valid_samples(&lambert(), proof::at(degrees), 1e-5);
        assert!((total - 1.0).abs() < 1e-5, "{total}");
        proof::weights_are_quotients(&lambert(), proof::at(degrees));
        proof::sampling_matches_pdf(&lambert(), proof::at(degrees));
    }
}

#[test]
fn a_weight_is_that_of_the_sample() {
    let model = Lambert { reflectance: Vector3::<f32>::splat(RHO) };
    // Midpoints, the rim of the square, and the edges of what counts as rim.
    let inside = (0..64u8).map(|i| (f32::from(i) + 0.5) / 64.0);
    let rim = [0.0, f32::MIN_POSITIVE, 0.000_49, 0.000_51, 0.999_49, 0.999_51, 1.0 - f32::EPSILON / 2.0];
    let numbers: Vec<f32> = inside.chain(rim).collect();
    for wo in [proof::at(30.0), -proof::at(30.0)].map(Vector3::splat) {
        for (u, v) in numbers.iter().flat_map(|&u| numbers.iter().map(move |&v| (u, v))) {
            let sample = model.sample(wo, (u, v));
            let (weight, expected) = (model.sampled_weight(wo, (u, v)), sample.weight.only(sample.valid));
            assert_eq!((weight.x, weight.y, weight.z), (expected.x, expected.y, expected.z), "{u} {v}");
        }
    }
}
