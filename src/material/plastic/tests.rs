use glam::Vec3;

use super::*;
use crate::material::{Bsdf, diffuse_reflectance, proof};

fn plastic<R: Real>(diffuse: Vec3, eta: f32, specular: Vec3, nonlinear: bool) -> Bsdf<'static, R> {
    Bsdf::Plastic(Plastic {
        base: Base {
            diffuse: Vector3::splat(diffuse),
            eta: R::splat(eta),
            internal: R::splat(diffuse_reflectance(1.0 / eta)),
            nonlinear,
        },
        specular: Vector3::splat(specular),
    })
}

fn blue<R: Real>(nonlinear: bool) -> Bsdf<'static, R> {
    plastic(Vec3::new(0.1, 0.27, 0.9), 1.49, Vec3::ONE, nonlinear)
}

#[test]
fn lanes_equal_scalar() {
    for nonlinear in [false, true] {
        proof::lanes_equal_scalar(&blue(nonlinear), &blue(nonlinear));
    }
}

#[test]
fn it_is_reciprocal_and_black_from_behind() {
    proof::is_reciprocal(&blue(false));
    proof::is_black_from_behind(&blue(true));
}

#[test]
fn coat_and_base_share_the_light() {
    for (bsdf, least) in [
        (blue::<f32>(false), 0.0),
        (blue(true), 0.0),
        // A white base under a coat gives back everything: what goes in comes out.
        (plastic(Vec3::ONE, 1.5, Vec3::ONE, false), 0.998),
    ] {
        for degrees in [0.0, 45.0, 80.0] {
            let wo = proof::at(degrees);
            let [mirrored, none] = bsdf.branches(wo.into());
            let total = proof::albedo(&bsdf, wo).map(|diffuse| diffuse + f64::from(mirrored.weight.x));
            assert!(!none.valid && total.iter().all(|t| (least..1.002).contains(t)), "{degrees}: {total:?}");
        }
    }
}

#[test]
fn both_lobes_are_sampled_with_their_shares() {
    let mut random = proof::Random::new(1);
    for degrees in [0.0, 60.0, 85.0] {
        let (bsdf, wo) = (blue::<f32>(false), proof::at(degrees));
        let total = proof::hemisphere(|wi| f64::from(bsdf.pdf(wo.into(), wi)));
        let (count, mut mirrors) = (200_000, 0.0);
        for _ in 0..count {
            let sample = bsdf.sample(wo.into(), random.unit(), (random.unit(), random.unit()));
            if sample.delta {
                mirrors += 1.0;
                let [branch, _] = bsdf.branches(wo.into());
                assert!((sample.weight.x * sample.pdf - branch.weight.x).abs() < 1e-6);
            } else if sample.valid {
                let eval = Vec3::from(bsdf.eval(wo.into(), sample.wi));
                let got = Vec3::from(sample.weight) * bsdf.pdf(wo.into(), sample.wi);
                assert!((got - eval).abs().max_element() <= 1e-5 * eval.max_element());
            }
        }
        let share = mirrors / f64::from(count);
        let noise = 4.0 * (share * (1.0 - share) / f64::from(count)).sqrt();
        assert!((1.0 - share - total).abs() < noise + 1e-4, "{degrees}: {share} {total}");
    }
}

/// What Mitsuba 3.9.1 gives for the same parameters; its F_dr is a fit.
#[test]
fn it_is_that_of_mitsuba() {
    proof::has_values(&blue(false), &proof::ABOVE, &PLAIN, 3e-3);
    let rgb = Vec3::new(0.1, 0.27, 0.9);
    let saturated = plastic(rgb, 1.9, Vec3::new(0.5, 0.6, 0.7), true);
    proof::has_values(&saturated, &proof::ABOVE, &NONLINEAR, 1.5e-2);
}

const PLAIN: [[f32; 4]; 6] = [
    [0.03041115, 0.08211011, 0.2737004, f32::NAN],
    [0.02639285, 0.07126069, 0.2375356, f32::NAN],
    [0.02095532, 0.05657937, 0.1885979, f32::NAN],
    [0.0119689, 0.03231603, 0.1077201, f32::NAN],
    [0.02450695, 0.06616877, 0.2205626, f32::NAN],
    [0.001609491, 0.004345626, 0.01448542, f32::NAN],
];
const NONLINEAR: [[f32; 4]; 6] = [
    [0.007323266, 0.02300677, 0.1947009, f32::NAN],
    [0.006346993, 0.01993971, 0.1687451, f32::NAN],
    [0.005010718, 0.01574167, 0.1332181, f32::NAN],
    [0.00284004, 0.008922268, 0.07550704, f32::NAN],
    [0.005882969, 0.01848193, 0.1564082, f32::NAN],
    [0.0003879918, 0.001218915, 0.01031539, f32::NAN],
];
