use glam::Vec3;

use super::*;
use crate::material::{Bsdf, proof};

fn glass<R: Real>(eta: f32) -> Bsdf<'static, R> {
    let one = Vector3::splat(Vec3::ONE);
    Bsdf::Dielectric(Dielectric { eta: R::splat(eta), reflectance: one, transmittance: one })
}

const ETAS: [f32; 5] = [1.5, 1.0 / 1.5, 1.33, 2.4, 1.001];

#[test]
fn lanes_equal_scalar() {
    for eta in ETAS.into_iter().chain([1.0]) {
        proof::lanes_equal_scalar(&glass(eta), &glass(eta));
    }
}

/// η = n(far)/n(near) for a direction.
fn relative(wo: Vec3, eta: f32) -> f32 {
    if wo.z >= 0.0 { eta } else { 1.0 / eta }
}

#[test]
fn no_energy_is_lost_and_radiance_scales_with_the_square_of_the_index() {
    let mut random = proof::Random::new(1);
    for i in 0..100_000 {
        let (wo, eta) = (random.direction(true), ETAS[i % ETAS.len()]);
        let [reflected, refracted] = glass::<f32>(eta).branches(wo.into());
        let n = relative(wo, eta);
        let share = |branch: &Branch<f32>| if branch.valid { branch.weight.x } else { 0.0 };
        let (r, t) = (share(&reflected), share(&refracted));
        // The transmitted power is t·n²: radiance was divided by n².
        assert!((r + t * n * n - 1.0).abs() < 1e-5, "{wo} {eta}: {r} {t}");
        assert!((0.0..=1.0).contains(&r) && t >= 0.0);
        if refracted.valid {
            // There and back through the surface nothing has changed but the two losses.
            let [_, back] = glass::<f32>(eta).branches(refracted.wi);
            // Near grazing, the cosine is the square root of what is left of 1 − sin²θ.
            assert!(back.valid || wo.z.abs() < 2e-3, "{wo} {eta}");
            if wo.z.abs() > 0.05 && refracted.wi.z.abs() > 0.05 {
                assert!((t * back.weight.x - (1.0 - r) * (1.0 - r)).abs() < 1e-3, "{wo} {eta}");
                assert!((Vec3::from(back.wi) - wo).length() < 1e-4, "{wo} {eta}");
            }
        }
    }
}

#[test]
fn it_refracts_by_snell() {
    let mut random = proof::Random::new(2);
    for i in 0..100_000 {
        let (wo, eta) = (random.direction(true), ETAS[i % ETAS.len()]);
        let [reflected, refracted] = glass::<f32>(eta).branches(wo.into());
        assert_eq!(Vec3::from(reflected.wi), Vec3::new(-wo.x, -wo.y, wo.z));
        if refracted.valid {
            let wi = Vec3::from(refracted.wi);
            assert!(wi.z * wo.z <= 0.0, "{wo} {wi}: on the other side");
            assert!((wi.length() - 1.0).abs() < 1e-5, "{wo} {eta}: {}", wi.length());
            // n_i sin θ_i = n_t sin θ_t, to the opposite side.
            let n = relative(wo, eta);
            assert!((wi.truncate() * n + wo.truncate()).length() < 1e-6, "{wo} {wi}");
        }
    }
}

#[test]
fn total_internal_reflection_begins_at_the_critical_angle() {
    let critical = (1.0f64 / 1.5).asin().to_degrees();
    for (degrees, total) in [(10.0, false), (critical - 0.01, false), (critical + 0.01, true), (80.0, true)] {
        let wo = -proof::at(degrees as f32);
        let [reflected, refracted] = glass::<f32>(1.5).branches(wo.into());
        assert_eq!((refracted.valid, reflected.weight.x == 1.0), (!total, total), "{degrees}");
        for lobe in [0.0, 0.5, 0.999_999_94] {
            let sample = glass::<f32>(1.5).sample(wo.into(), lobe, (0.5, 0.5));
            assert!(
                !total || sample.valid && sample.wi.z < 0.0 && sample.weight.x == 1.0 && sample.eta == 1.0
            );
        }
    }
    // From outside there is none.
    assert!(glass::<f32>(1.5).branches(proof::at(89.9).into())[1].valid);
}

#[test]
fn sampling_chooses_by_fresnel_and_weighs_by_what_is_left() {
    let mut random = proof::Random::new(3);
    for (degrees, inside) in [(0.0, false), (60.0, false), (80.0, false), (20.0, true), (40.0, true)] {
        let wo = if inside { -proof::at(degrees) } else { proof::at(degrees) };
        let branches = glass::<f32>(1.5).branches(wo.into());
        let count = 200_000;
        let mut reflected = 0;
        for _ in 0..count {
            let sample = glass::<f32>(1.5).sample(wo.into(), random.unit(), (random.unit(), random.unit()));
            assert!(sample.valid && sample.delta);
            let reflects = sample.wi.z * wo.z > 0.0;
            reflected += u32::from(reflects);
            let branch = &branches[usize::from(!reflects)];
            assert_eq!(Vec3::from(sample.wi), Vec3::from(branch.wi));
            assert!((sample.weight.x * sample.pdf - branch.weight.x).abs() < 1e-6);
            assert_eq!(sample.eta, if reflects { 1.0 } else { relative(wo, 1.5) });
        }
        let (share, want) = (f64::from(reflected) / f64::from(count), f64::from(branches[0].weight.x));
        let noise = 3.5 * (want * (1.0 - want) / f64::from(count)).sqrt();
        assert!((share - want).abs() < noise, "{degrees}: {share} {want}");
    }
}

#[test]
fn an_index_matched_surface_is_not_there() {
    let [reflected, refracted] = glass::<f32>(1.0).branches(proof::at(50.0).into());
    assert!(!reflected.valid && refracted.valid);
    assert!((Vec3::from(refracted.wi) + proof::at(50.0)).length() < 1e-6);
    assert_eq!(refracted.weight.x, 1.0);
}
