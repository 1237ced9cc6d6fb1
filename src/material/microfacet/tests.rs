use glam::Vec3;

use super::*;
use crate::material::proof;

const KINDS: [Distribution; 2] = [Distribution::Beckmann, Distribution::Ggx];
const ALPHAS: [(f32, f32); 4] = [(0.5, 0.5), (0.25, 0.25), (0.2, 0.6), (1.0, 1.0)];

#[test]
fn projected_areas_of_the_normals_add_up_to_one() {
    for kind in KINDS {
        for (u, v) in ALPHAS {
            let surface = Microfacet::new(kind, u, v);
            let total = proof::hemisphere(|m| f64::from(surface.d(m) * m.z));
            assert!((total - 1.0).abs() < 1e-3, "{kind:?} {u} {v}: {total}");
        }
    }
}

/// ∫ G1(w) D(m) ⟨w·m⟩ dm = cos θ_w.
#[test]
fn what_is_seen_of_the_normals_is_the_projected_area() {
    for kind in KINDS {
        for (u, v) in ALPHAS {
            let surface = Microfacet::new(kind, u, v);
            for degrees in [0.0, 30.0, 60.0, 80.0] {
                let w: Vector3<f32> = proof::at(degrees).into();
                let seen = |g1: fn(&Microfacet<f32>, Vector3<f32>, Vector3<f32>) -> f32| {
                    proof::hemisphere(|m| f64::from(g1(&surface, w, m) * surface.d(m) * w.dot(m).max(0.0)))
                };
                // The rational function is within 0.35 % of Beckmann's G1 \[WML07\].
                let total = seen(Microfacet::g1) / f64::from(w.z);
                let tolerance = if kind == Distribution::Beckmann { 5e-3 } else { 1.5e-3 };
                assert!((total - 1.0).abs() < tolerance, "{kind:?} {u} {v} at {degrees}: {total}");
                let total = proof::hemisphere(|m| f64::from(surface.pdf_visible(w, m)));
                assert!((total - 1.0).abs() < 1.5e-3, "{kind:?} {u} {v} at {degrees}: {total}");
            }
        }
    }
}

#[test]
fn nothing_is_seen_of_a_back() {
    for kind in KINDS {
        let surface = Microfacet::new(kind, 0.4f32, 0.4);
        let (w, m) =
            (Vec3::new(0.9, 0.0, 0.4).normalize().into(), Vec3::new(-0.9, 0.0, 0.3).normalize().into());
        assert_eq!((surface.g1(w, m), surface.pdf_visible(w, m)), (0.0, 0.0));
    }
}

#[test]
fn the_roughness_has_a_floor_and_the_mirror_is_its_limit() {
    for kind in KINDS {
        let surface = Microfacet::new(kind, 0.0f32, -1.0);
        let wo = proof::at(40.0);
        let m = Vec3::from(surface.sample_visible(wo.into(), (0.3, 0.6)));
        assert!((m - Vec3::Z).length() < 1e-3, "{kind:?} {m}");
        assert!(surface.d(Vec3::Z.into()).is_finite());
        assert_eq!(surface.g1(wo.into(), Vec3::Z.into()), 1.0);
    }
}
