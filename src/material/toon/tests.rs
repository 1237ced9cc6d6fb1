use glam::Vec3;

use super::*;
use crate::material::{Bsdf, proof};

const RHO: Vec3 = Vec3::new(0.9, 0.5, 1.0);

fn toon<R: Real>(bands: f32) -> Bsdf<'static, R> {
    Bsdf::Toon(Toon { reflectance: Vector3::splat(RHO), bands: R::splat(bands) })
}

#[test]
fn lanes_equal_scalar() {
    proof::lanes_equal_scalar(&toon(3.0), &toon(3.0));
}

#[test]
fn light_comes_in_bands() {
    let full = RHO.x * INV_PI;
    let at = |degrees: f32| toon::<f32>(3.0).eval(Vec3::Z.into(), proof::at(degrees).into()).x / full;
    // cos θ of 1/3 and 2/3 are at 70.5 and 48.2 degrees.
    for (degrees, want) in [(0.0, 1.0), (48.0, 1.0), (49.0, 0.5), (70.0, 0.5), (71.0, 0.0), (89.0, 0.0)] {
        assert!((at(degrees) - want).abs() < 1e-6, "{degrees}: {}", at(degrees));
    }
}

#[test]
fn it_reflects_rho_and_samples_rightly() {
    for bands in [2.0, 3.0, 7.0] {
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
    let f = |wo: Vec3, wi: Vec3| toon::<f32>(3.0).eval(wo.into(), wi.into()).x / wi.z;
    assert!((f(a, b) - f(b, a)).abs() > 0.1 * f(a, b), "{} {}", f(a, b), f(b, a));
}
