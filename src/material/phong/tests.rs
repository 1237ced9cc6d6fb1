use glam::Vec3;

use super::*;
use crate::material::{Bsdf, proof};

const DIFFUSE: Vec3 = Vec3::new(0.5, 0.2, 0.0);
const SPECULAR: Vec3 = Vec3::new(0.5, 0.3, 1.0);

fn phong<R: Real>(diffuse: Vec3, specular: Vec3, exponent: f32) -> Bsdf<'static, R> {
    Bsdf::Phong(Phong {
        diffuse: Vector3::splat(diffuse),
        specular: Vector3::splat(specular),
        exponent: R::splat(exponent),
    })
}

#[test]
fn lanes_equal_scalar() {
    for (diffuse, specular, exponent) in [
        (DIFFUSE, SPECULAR, 20.0),
        (Vec3::ZERO, Vec3::ONE, 1000.0),
        (Vec3::ONE, Vec3::ZERO, 0.0),
        (Vec3::ZERO, Vec3::ZERO, 5.0),
    ] {
        proof::lanes_equal_scalar(&phong(diffuse, specular, exponent), &phong(diffuse, specular, exponent));
    }
}

#[test]
fn it_is_reciprocal_and_black_from_behind() {
    for exponent in [0.0, 1.0, 7.5, 100.0] {
        proof::is_reciprocal(&phong(DIFFUSE, SPECULAR, exponent));
        proof::is_black_from_behind(&phong(DIFFUSE, SPECULAR, exponent));
    }
}

#[test]
fn the_albedo_never_exceeds_the_sum_of_both_and_is_it_at_normal_incidence() {
    for exponent in [0.0, 1.0, 10.0, 50.0] {
        for degrees in [0.0, 20.0, 45.0, 70.0, 89.0] {
            let albedo = proof::albedo(&phong(DIFFUSE, SPECULAR, exponent), proof::at(degrees));
            for i in 0..3 {
                let sum = f64::from(DIFFUSE[i] + SPECULAR[i]);
                assert!(albedo[i] <= sum + 1e-3, "n = {exponent}, {degrees}: {albedo:?}");
                assert!(degrees > 0.0 || (albedo[i] - sum).abs() < 1e-3, "n = {exponent}: {albedo:?}");
            }
        }
    }
}

#[test]
fn samples_are_distributed_by_the_density() {
    for (exponent, degrees) in [(0.0, 30.0), (5.0, 0.0), (5.0, 60.0), (50.0, 40.0), (50.0, 80.0)] {
        let (bsdf, wo) = (phong(DIFFUSE, SPECULAR, exponent), proof::at(degrees));
        let total = proof::density_is_that_of_valid_samples(&bsdf, wo, 1e-3);
        // What is missing from 1 is drawn below the horizon.
        assert!(total < 1.001 && (degrees > 0.0 || total > 0.999), "n = {exponent}, {degrees}: {total}");
        proof::weights_are_quotients(&bsdf, wo);
        proof::sampling_matches_pdf(&bsdf, wo);
    }
}

#[test]
fn without_any_albedo_nothing_breaks() {
    let sample = phong::<f32>(Vec3::ZERO, Vec3::ZERO, 5.0).sample(Vec3::Z.into(), 0.5, (0.3, 0.7));
    assert_eq!(Vec3::from(sample.weight), Vec3::ZERO);
}

#[test]
fn the_plain_form_is_not_reciprocal() {
    // L = cosⁿα E on the slide is f cos θ_i, so f = cosⁿα / cos θ_i.
    let plain = |wo: Vec3, wi: Vec3| pow(mirror::<f32>(wo.into()).dot(wi.into()).max(0.0), 5.0) / wi.z;
    let (a, b) = (proof::at(20.0), Vec3::new(-0.6, 0.5, 0.61).normalize());
    let (there, back) = (plain(a, b), plain(b, a));
    assert!((there / back - a.z / b.z).abs() < 1e-3, "{there} {back}");
    assert!((there - back).abs() > 0.2 * there, "{there} {back}");
}

/// Seen from the normal: a lobe about it, (n + 1)/2π cosⁿθ, and the cosine's, each chosen by its part of the albedos.
#[test]
fn each_lobe_is_chosen_by_its_part_of_the_albedos() {
    let wi = proof::at(35.0);
    let glossy = 6.0 / std::f32::consts::TAU * wi.z.powi(5);
    let diffuse = wi.z / std::f32::consts::PI;
    let black = Vec3::ZERO;
    for (of_diffuse, of_specular, share) in
        [(Vec3::ONE, black, 0.0), (black, Vec3::ONE, 1.0), (Vec3::splat(0.1), Vec3::splat(0.3), 0.75)]
    {
        let pdf: f32 = phong(of_diffuse, of_specular, 5.0).pdf(Vec3::Z.into(), wi.into());
        let want = share * glossy + (1.0 - share) * diffuse;
        assert!((pdf - want).abs() < 1e-5 * want, "{pdf}, not {want}");
    }
}
