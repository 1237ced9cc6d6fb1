//! Rough glass \[WML07\]: microfacets that reflect and refract.
//!
//! With η = n(wi)/n(wo), the normal m ∥ wo + wi for reflection and m ∥ wo + η wi for refraction,
//!
//! ```text
//! f_r = F D(m) G/(4 |cos θ_i cos θ_o|)
//! f_t = (1 − F) D(m) G |wo·m| |wi·m| / (|cos θ_i cos θ_o| (wo·m + η wi·m)²)
//! ```
//!
//! f_t is that of radiance: the η² of the solid angles' ratio and the 1/η² of radiance cancel. A normal
//! is drawn as it is seen, and F decides what it does.

use super::{Sample, fresnel, microfacet::Microfacet, rough_conductor::reflect};
use crate::simd::{Real, Vector3};

/// Microfacets of glass; the exterior is on the side of the normal.
#[derive(Clone, Copy, Debug)]
pub struct RoughDielectric<R> {
    /// The microfacets.
    pub surface: Microfacet<R>,
    /// n_int/n_ext, not 1.
    pub eta: R,
    /// Factor on what is reflected.
    pub reflectance: Vector3<R>,
    /// Factor on what is refracted.
    pub transmittance: Vector3<R>,
}

impl<R: Real> RoughDielectric<R> {
    /// f |cos θ_i|.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        let h = Half::new(wo, wi, self.eta);
        let (reflectance, ..) = fresnel::dielectric(h.wo_m, self.eta);
        let shape = self.surface.d(h.m) * self.surface.g(wo, wi, h.m) / wo.z.abs();
        let reflected = reflectance * shape * R::splat(0.25);
        let refracted = (R::one() - reflectance) * shape * (h.wo_m * h.wi_m).abs() / h.denominator;
        let value = Vector3::select(
            h.reflects,
            self.reflectance.scale(reflected),
            self.transmittance.scale(refracted),
        );
        value.only(h.possible)
    }

    /// Density of the visible normal times F/(4 |wi·m|) or (1 − F) η² |wi·m|/(wo·m + η wi·m)².
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        let h = Half::new(wo, wi, self.eta);
        let (reflectance, ..) = fresnel::dielectric(h.wo_m, self.eta);
        let normal = self.surface.pdf_visible(upward(wo), h.m);
        let jacobian = R::select(
            h.reflects,
            reflectance / (R::splat(4.0) * h.wi_m.abs()),
            (R::one() - reflectance) * h.eta * h.eta * h.wi_m.abs() / h.denominator,
        );
        (normal * jacobian).only(h.possible)
    }

    /// Reflection or refraction at a visible normal, by Fresnel's reflectance.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, lobe: R, u: (R, R)) -> Sample<R> {
        let m = self.surface.sample_visible(upward(wo), u);
        let (reflectance, refracted, eta) = refract(wo, m, self.eta);
        let reflects = lobe.lt(reflectance);
        let wi = Vector3::select(reflects, reflect(wo, m), refracted);
        // A direction on the wrong side of the surface is lost.
        let stays = (wi.z * wo.z).gt(R::zero());
        let right = (reflects & stays) | (!reflects & (wi.z * wo.z).lt(R::zero()));
        let sample = Sample::quotient(wi, self.eval(wo, wi), self.pdf(wo, wi), right);
        Sample { eta: R::select(reflects, R::one(), eta), ..sample }
    }
}

/// The microfacet that takes wo to wi.
pub(super) struct Half<R: Real> {
    /// Its normal, upward.
    pub(super) m: Vector3<R>,
    pub(super) wo_m: R,
    pub(super) wi_m: R,
    /// n(wi)/n(wo) if it refracts.
    pub(super) eta: R,
    /// (wo·m + η wi·m)².
    pub(super) denominator: R,
    pub(super) reflects: R::Mask,
    /// Both directions are on the sides of the microfacet on which they are of the surface.
    pub(super) possible: R::Mask,
}

impl<R: Real> Half<R> {
    #[inline]
    pub(super) fn new(wo: Vector3<R>, wi: Vector3<R>, eta: R) -> Self {
        let zero = R::zero();
        let sides = wo.z * wi.z;
        let reflects = sides.gt(zero);
        let eta = R::select(wo.z.gt(zero), eta, R::one() / eta);
        let m = (wo + wi.scale(R::select(reflects, R::one(), eta))).normalize();
        let m = Vector3::select(m.z.lt(zero), -m, m);
        let (wo_m, wi_m) = (wo.dot(m), wi.dot(m));
        let sum = wo_m + eta * wi_m;
        let possible = (wo_m * wo.z).gt(zero) & (wi_m * wi.z).gt(zero) & !sides.equal(zero);
        Self { m, wo_m, wi_m, eta, denominator: sum * sum, reflects, possible }
    }
}

/// On the side of the normal.
#[inline]
pub(super) fn upward<R: Real>(w: Vector3<R>) -> Vector3<R> {
    Vector3::select(w.z.lt(R::zero()), -w, w)
}

/// (F, refracted direction, n(far)/n(near)) at a microfacet.
#[inline]
pub(super) fn refract<R: Real>(wo: Vector3<R>, m: Vector3<R>, eta: R) -> (R, Vector3<R>, R) {
    let cos = wo.dot(m);
    let (reflectance, cos_t, eta) = fresnel::dielectric(cos, eta);
    let inverse = R::one() / eta;
    let along = cos * inverse - R::select(cos.ge(R::zero()), cos_t, -cos_t);
    let wi = m.scale(along) - wo.scale(inverse);
    (reflectance, wi.normalize(), eta)
}

#[cfg(test)]
mod tests;
