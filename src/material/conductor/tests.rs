use glam::Vec3;

use super::*;
use crate::material::{Bsdf, proof};

fn gold<R: Real>() -> Bsdf<'static, R> {
    Bsdf::Conductor(Conductor {
        eta: Vector3::splat(Vec3::new(0.143, 0.375, 1.442)),
        k: Vector3::splat(Vec3::new(3.983, 2.386, 1.603)),
        reflectance: Vector3::splat(Vec3::new(1.0, 0.9, 0.5)),
    })
}

#[test]
fn lanes_equal_scalar() {
    proof::lanes_equal_scalar(&gold(), &gold());
}

#[test]
fn it_reflects_by_the_law_of_reflection_and_never_more_than_all() {
    let mut random = proof::Random::new(1);
    for _ in 0..20_000 {
        let wo = random.direction(true);
        let [Branch { wi, weight, valid }, none] = gold::<f32>().branches(wo.into());
        let (wi, weight) = (Vec3::from(wi), Vec3::from(weight));
        assert_eq!(valid, wo.z > 0.0);
        assert!(!none.valid);
        if !valid {
            continue;
        }
        // In the plane of wo and the normal, at the same angle, on the other side.
        assert_eq!(wi.z, wo.z);
        assert!((wi + wo - Vec3::Z * 2.0 * wo.z).length() < 1e-6);
        assert!(
            weight.min_element() > 0.0 && weight.cmple(Vec3::new(1.0, 0.9, 0.5) + 1e-6).all(),
            "{weight}"
        );
        let sample = gold::<f32>().sample(wo.into(), random.unit(), (random.unit(), random.unit()));
        assert!(sample.valid && sample.delta && sample.eta == 1.0);
        assert_eq!((Vec3::from(sample.wi), Vec3::from(sample.weight)), (wi, weight));
        // Helmholtz: the way back has the same share.
        let [back, _] = gold::<f32>().branches(wi.into());
        assert_eq!(Vec3::from(back.weight), weight);
    }
}

#[test]
fn smooth_verbs_are_zero() {
    let (wo, wi) = (proof::at(30.0).into(), mirror(proof::at(30.0).into()));
    assert_eq!(Vec3::from(gold::<f32>().eval(wo, wi)), Vec3::ZERO);
    assert_eq!(gold::<f32>().pdf(wo, wi), 0.0);
}
