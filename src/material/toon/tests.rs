use glam::Vec3;

use super::*;
use crate::material::{Bsdf, proof};

const RHO: Vec3 = Vec3::new(0.9, 0.5, 1.0);

fn toon<R: Real>(bands: u32) -> Bsdf<'static, R> {
    painted(Ramp::Bands(bands))
}

/// Ramps live as long as the table of a scene; those of tests, as long as the tests.
fn painted<R: Real>(ramp: Ramp) -> Bsdf<'static, R> {
    Bsdf::Toon(Toon { reflectance: Vector3::splat(RHO), ramp: Box::leak(Box::new(ramp)) })
}

fn stops() -> Vec<Stop> {
    let stop = |cos, color: [f32; 3]| Stop { cos, color: color.into() };
    vec![stop(0.1, [0.1, 0.0, 0.3]), stop(0.5, [0.5, 0.2, 0.1]), stop(0.9, [1.0, 0.9, 0.5])]
}

#[test]
fn a_free_ramp_has_its_colours() {
    let value = |bsdf: &Bsdf<f32>, cos: f32| {
        let wi = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        Vec3::from(bsdf.eval(Vec3::Z.into(), wi.into())) / (RHO * INV_PI)
    };
    let (steps, smooth) = (painted(Ramp::Steps(stops())), painted(Ramp::Smooth(stops())));
    for (cos, color) in
        [(0.05, [0.0; 3]), (0.3, [0.1, 0.0, 0.3]), (0.5, [0.5, 0.2, 0.1]), (1.0, [1.0, 0.9, 0.5])]
    {
        assert!((value(&steps, cos) - Vec3::from(color)).abs().max_element() < 1e-6, "{cos}");
    }
    for (cos, color) in [(0.05, [0.1, 0.0, 0.3]), (0.3, [0.3, 0.1, 0.2]), (0.95, [1.0, 0.9, 0.5])] {
        assert!((value(&smooth, cos) - Vec3::from(color)).abs().max_element() < 1e-6, "{cos}");
    }
}

#[test]
fn the_albedo_of_a_ramp_is_its_integral_and_lanes_equal_scalar() {
    for ramp in
        [Ramp::Steps(stops()), Ramp::Smooth(stops()), Ramp::Bands(4), Ramp::Steps(stops()[..1].to_vec())]
    {
        let (want, bsdf) = (ramp.albedo() * RHO, painted(ramp.clone()));
        let albedo = proof::albedo(&bsdf, proof::at(30.0));
        for i in 0..3 {
            assert!((albedo[i] - f64::from(want[i])).abs() < 3e-3, "{ramp:?}: {albedo:?}, not {want}");
        }
        proof::lanes_equal_scalar(&bsdf, &painted(ramp));
    }
}

#[test]
fn lanes_equal_scalar() {
    proof::lanes_equal_scalar(&toon(3), &toon(3));
}

#[test]
fn light_comes_in_bands() {
    let full = RHO.x * INV_PI;
    let at = |degrees: f32| toon::<f32>(3).eval(Vec3::Z.into(), proof::at(degrees).into()).x / full;
    // cos θ of 1/3 and 2/3 are at 70.5 and 48.2 degrees.
    for (degrees, want) in [(0.0, 1.0), (48.0, 1.0), (49.0, 0.5), (70.0, 0.5), (71.0, 0.0), (89.0, 0.0)] {
        assert!((at(degrees) - want).abs() < 1e-6, "{degrees}: {}", at(degrees));
    }
}

#[test]
fn it_reflects_rho_and_samples_rightly() {
    for bands in [2, 3, 7] {
        let albedo = proof::albedo(&toon(bands), proof::at(30.0));
        for i in 0..3 {
            assert!((albedo[i] - f64::from(RHO[i])).abs() < 3e-3, "{bands}: {albedo:?}");
        }
        proof::is_black_from_behind(&toon(bands));
        proof::samples_are_right(&toon(bands), &[0.0, 60.0]);
    }
}

#[test]
fn it_is_not_reciprocal() {
    let (a, b) = (proof::at(10.0), proof::at(65.0));
    let f = |wo: Vec3, wi: Vec3| toon::<f32>(3).eval(wo.into(), wi.into()).x / wi.z;
    assert!((f(a, b) - f(b, a)).abs() > 0.1 * f(a, b), "{} {}", f(a, b), f(b, a));
}
