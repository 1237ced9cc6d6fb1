use glam::Vec3;

use super::*;
use crate::material::{Bsdf, Distribution, proof};

const KINDS: [Distribution; 2] = [Distribution::Beckmann, Distribution::Ggx];

fn gold<R: Real>(kind: Distribution, u: f32, v: f32) -> Bsdf<'static, R> {
    Bsdf::RoughConductor(RoughConductor {
        surface: Microfacet::new(kind, R::splat(u), R::splat(v)),
        eta: Vector3::splat(Vec3::new(0.143, 0.375, 1.442)),
        k: Vector3::splat(Vec3::new(3.983, 2.386, 1.603)),
        reflectance: Vector3::splat(Vec3::ONE),
    })
}

#[test]
fn lanes_equal_scalar() {
    for kind in KINDS {
        for (u, v) in [(0.3, 0.3), (0.05, 0.4), (1e-4, 1e-4)] {
            proof::lanes_equal_scalar(&gold(kind, u, v), &gold(kind, u, v));
        }
    }
}

#[test]
fn it_is_sound() {
    for kind in KINDS {
        for (u, v) in [(0.3, 0.3), (0.2, 0.5), (0.9, 0.9)] {
            proof::is_sound(&gold(kind, u, v), &[0.0, 40.0, 75.0]);
        }
    }
}

#[test]
fn it_is_isotropic_only_where_both_roughnesses_are_one() {
    for kind in KINDS {
        assert!(proof::anisotropy(&gold(kind, 0.3, 0.3)) < 1e-2);
        assert!(proof::anisotropy(&gold(kind, 0.2, 0.4)) > 0.5);
    }
}

/// A perfect mirror loses only what a second microfacet would get: next to nothing when smooth.
#[test]
fn a_smooth_mirror_loses_next_to_nothing() {
    for kind in KINDS {
        let mirror = |alpha: f32| {
            Bsdf::RoughConductor(RoughConductor {
                surface: Microfacet::new(kind, alpha, alpha),
                eta: Vector3::zero(),
                k: Vector3::splat(Vec3::ONE),
                reflectance: Vector3::splat(Vec3::ONE),
            })
        };
        for degrees in [0.0, 50.0] {
            let [albedo, ..] = proof::albedo(&mirror(0.1), proof::at(degrees));
            assert!((0.975..1.002).contains(&albedo), "{kind:?} {degrees}: {albedo}");
            let [rough, ..] = proof::albedo(&mirror(0.8), proof::at(degrees));
            assert!(rough < 0.97, "{kind:?} {degrees}: {rough}");
        }
    }
}

/// What Mitsuba 3.9.1 gives for the same parameters.
#[test]
fn it_is_that_of_mitsuba() {
    use Distribution::{Beckmann, Ggx};
    proof::has_values(&gold(Ggx, 0.3, 0.3), &proof::ABOVE, &GGX, 1e-4);
    proof::has_values(&gold(Beckmann, 0.3, 0.3), &proof::ABOVE, &BECKMANN, 1e-4);
    proof::has_values(&gold(Ggx, 0.05, 0.4), &proof::ABOVE, &BRUSHED_GGX, 1e-4);
    proof::has_values(&gold(Beckmann, 0.15, 0.4), &proof::ABOVE, &BRUSHED_BECKMANN, 1e-4);
}

const GGX: [[f32; 4]; 6] = [
    [0.5004926, 0.4153321, 0.1677781, 0.5192802],
    [0.8785904, 0.7289214, 0.2971841, 0.9191255],
    [1.184895, 0.9839752, 0.4193041, 1.261405],
    [1.507174, 1.27857, 0.6480888, 1.669608],
    [0.5103186, 0.4233698, 0.1742815, 0.5365379],
    [1.557258, 1.427099, 0.9935583, 2.709408],
];
const BECKMANN: [[f32; 4]; 6] = [
    [0.6432742, 0.5338188, 0.2156422, f32::NAN],
    [0.9428593, 0.7822419, 0.3189231, f32::NAN],
    [1.293349, 1.074039, 0.4576833, f32::NAN],
    [2.434999, 2.065665, 1.047056, f32::NAN],
    [0.7239234, 0.6005804, 0.2472308, f32::NAN],
    [3.119724, 2.858972, 1.99044, f32::NAN],
];
const BRUSHED_GGX: [[f32; 4]; 6] = [
    [0.05812421, 0.04823417, 0.01948474, 0.06026167],
    [0.8581526, 0.7119652, 0.290271, 0.8888424],
    [1.645247, 1.366267, 0.582211, 1.780669],
    [0.6722025, 0.5702446, 0.2890489, 0.7069933],
    [0.846993, 0.7026812, 0.289261, 0.8832488],
    [0.8107893, 0.7430222, 0.5172982, 1.456099],
];
const BRUSHED_BECKMANN: [[f32; 4]; 6] = [
    [0.5590919, 0.4639604, 0.1874221, f32::NAN],
    [1.283237, 1.064636, 0.4340561, f32::NAN],
    [1.819087, 1.510629, 0.6437286, f32::NAN],
    [3.107145, 2.635862, 1.336081, f32::NAN],
    [1.210454, 1.004216, 0.4133886, f32::NAN],
    [3.790675, 3.473844, 2.418519, f32::NAN],
];
