use glam::Vec3;

use super::*;
use crate::material::{Bsdf, proof};

fn ward<R: Real>(alpha_u: f32, alpha_v: f32) -> Bsdf<'static, R> {
    Bsdf::Ward(Ward::new(
        Vector3::splat(Vec3::new(0.5, 0.2, 0.0)),
        Vector3::splat(Vec3::new(0.5, 0.3, 1.0)),
        R::splat(alpha_u),
        R::splat(alpha_v),
    ))
}

#[test]
fn lanes_equal_scalar() {
    for (u, v) in [(0.3, 0.3), (0.05, 0.5), (0.0, 0.0)] {
        proof::lanes_equal_scalar(&ward(u, v), &ward(u, v));
    }
}

#[test]
fn it_is_sound() {
    for (u, v) in [(0.3, 0.3), (0.2, 0.5)] {
        proof::is_sound(&ward(u, v), &[0.0, 40.0, 75.0]);
    }
}

#[test]
fn it_is_isotropic_only_where_both_roughnesses_are_one() {
    assert!(proof::anisotropy(&ward(0.3, 0.3)) < 1e-2);
    assert!(proof::anisotropy(&ward(0.2, 0.4)) > 0.5);
}

/// The bound that is lacking where the form divides by both cosines.
#[test]
fn grazing_angles_gain_no_light() {
    let [_, _, bounded] = proof::albedo(&ward(0.4, 0.4), proof::at(89.0));
    assert!(bounded < 1.001, "{bounded}");
    let unbounded = |wo: Vec3, wi: Vec3| -> f64 {
        let h = (wo + wi).normalize();
        let (tan2, alpha2) = ((1.0 - h.z * h.z) / (h.z * h.z), 0.16);
        f64::from((-tan2 / alpha2).exp() / (4.0 * std::f32::consts::PI * alpha2) / wo.z)
    };
    let wo = proof::at(89.0);
    let total = proof::hemisphere(|wi| unbounded(wo, wi.into()));
    assert!(total > 1.1, "{total}");
}
