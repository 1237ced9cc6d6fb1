use glam::Vec3;

use super::*;
use crate::material::{Bsdf, Coat, CoatRange, Distribution, proof};

fn plastic<R: Real>(
    coat: &CoatRange,
    kind: Distribution,
    alpha: f32,
    eta: f32,
    colored: bool,
) -> Bsdf<'_, R> {
    let specular = if colored { Vec3::new(0.5, 0.6, 0.7) } else { Vec3::ONE };
    Bsdf::RoughPlastic(RoughPlastic {
        surface: Microfacet::new(kind, R::splat(alpha), R::splat(alpha)),
        coat: coat.at(R::splat(alpha)),
        base: Base {
            diffuse: Vector3::splat(Vec3::new(0.1, 0.27, 0.9)),
            eta: R::splat(eta),
            internal: coat.at(R::splat(alpha)).internal(),
            nonlinear: colored,
        },
        specular: Vector3::splat(specular),
    })
}

#[test]
fn lanes_equal_scalar() {
    for kind in [Distribution::Beckmann, Distribution::Ggx] {
        let coat = CoatRange::from(Coat::new(kind, 0.2, 1.49));
        let one = plastic(&coat, kind, 0.2, 1.49, false);
        proof::lanes_equal_scalar(&one, &plastic(&coat, kind, 0.2, 1.49, false));
    }
}

#[test]
fn it_is_sound() {
    for kind in [Distribution::Beckmann, Distribution::Ggx] {
        let coat = CoatRange::from(Coat::new(kind, 0.3, 1.5));
        let bsdf = plastic(&coat, kind, 0.3, 1.5, false);
        proof::is_sound(&bsdf, &[0.0, 50.0, 80.0]);
        assert!(proof::anisotropy(&bsdf) < 1e-2);
    }
}

/// What Mitsuba 3.9.1 gives for the same parameters.
#[test]
fn it_is_that_of_mitsuba() {
    use Distribution::{Beckmann, Ggx};
    let coat = CoatRange::from(Coat::new(Ggx, 0.2, 1.49));
    proof::has_values(&plastic(&coat, Ggx, 0.2, 1.49, false), &proof::ABOVE, &GGX, 2e-3);
    let coat = CoatRange::from(Coat::new(Beckmann, 0.4, 1.7));
    proof::has_values(&plastic(&coat, Beckmann, 0.4, 1.7, true), &proof::ABOVE, &BECKMANN, 2e-3);
}

const GGX: [[f32; 4]; 6] = [
    [0.04967948, 0.09009413, 0.239866, f32::NAN],
    [0.09480882, 0.1296242, 0.2586461, f32::NAN],
    [0.1598044, 0.1871202, 0.2883491, f32::NAN],
    [0.3456623, 0.3625526, 0.425146, f32::NAN],
    [0.0445698, 0.0767336, 0.1959289, f32::NAN],
    [1.670274, 1.67386, 1.687148, f32::NAN],
];
const BECKMANN: [[f32; 4]; 6] = [
    [0.02417318, 0.04641058, 0.1939946, f32::NAN],
    [0.02779696, 0.04830114, 0.1764479, f32::NAN],
    [0.0388652, 0.05826787, 0.1614351, f32::NAN],
    [0.1380683, 0.1732077, 0.2625523, f32::NAN],
    [0.02681368, 0.0459392, 0.1641937, f32::NAN],
    [0.3417752, 0.4119187, 0.494944, f32::NAN],
];

/// Between the coats of a range the table is linear; at the range's own roughnesses nothing changes.
#[test]
fn a_range_of_coats_is_near_the_coat_of_each_roughness() {
    let range = CoatRange::of_any_roughness(Distribution::Ggx, 1.5);
    for alpha in [0.02, 0.1, 0.25, 0.33, 0.7, 1.0] {
        let coat = CoatRange::from(Coat::new(Distribution::Ggx, alpha, 1.5));
        for cos in [0.1f32, 0.4, 0.8, 1.0] {
            let (got, want) = (range.at(alpha).transmittance(cos), coat.at(alpha).transmittance(cos));
            assert!((got - want).abs() < 4e-3, "{alpha} {cos}: {got}, not {want}");
        }
        let (got, want) = (range.at(alpha).internal(), coat.at(alpha).internal());
        assert!((got - want).abs() < 4e-3, "{alpha}: {got}, not {want}");
    }
    let one = plastic(&range, Distribution::Ggx, 0.33, 1.5, false);
    proof::lanes_equal_scalar(&one, &plastic(&range, Distribution::Ggx, 0.33, 1.5, false));
    proof::is_sound(&one, &[40.0]);
}
