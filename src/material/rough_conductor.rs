//! A rough conductor \[TS67\], isotropic or brushed.
//!
//! ```text
//! f = ρ F(wo·m) D(m) G(wo, wi)/(4 cos θ_i cos θ_o)        m = (wo + wi)/|wo + wi|
//! ```
//!
//! F is the exact reflectance of η + ik per channel. Light that would be reflected by a second
//! microfacet is lost, so the albedo falls below F with roughness. Normals are sampled as they are seen
//! \[Hei18\], which leaves the weight F G1(wi).

use super::{Sample, fresnel, lambert::above, microfacet::Microfacet};
use crate::simd::{Mask, Real, Vector3};

/// Microfacets of metal, black from behind.
#[derive(Clone, Copy, Debug)]
pub struct RoughConductor<R> {
    /// The microfacets.
    pub surface: Microfacet<R>,
    /// Real part of the index of refraction.
    pub eta: Vector3<R>,
    /// Imaginary part of the index of refraction.
    pub k: Vector3<R>,
    /// Factor on what is reflected.
    pub reflectance: Vector3<R>,
}

impl<R: Real> RoughConductor<R> {
    /// f cos θ_i.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        let m = (wo + wi).normalize();
        let shape = self.surface.d(m) * self.surface.g(wo, wi, m) / (R::splat(4.0) * wo.z);
        let f = self.reflectance * fresnel::conductor_rgb(wo.dot(m), self.eta, self.k);
        f.scale(shape).only(above(wo, wi))
    }

    /// G1(wo) D(m)/(4 cos θ_o).
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        reflection_pdf(&self.surface, wo, wi).only(above(wo, wi))
    }

    /// The mirror direction about a visible normal.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, u: (R, R)) -> Sample<R> {
        let m = self.surface.sample_visible(wo, u);
        let wi = reflect(wo, m);
        Sample::quotient(wi, self.eval(wo, wi), self.pdf(wo, wi), R::Mask::splat(true))
    }
}

/// wo mirrored at m.
#[inline]
pub(super) fn reflect<R: Real>(wo: Vector3<R>, m: Vector3<R>) -> Vector3<R> {
    let twice = wo.dot(m) + wo.dot(m);
    (m.scale(twice) - wo).normalize()
}

/// Density of a reflection about a visible normal: the normal's over 4 wo·m.
#[inline]
pub(super) fn reflection_pdf<R: Real>(surface: &Microfacet<R>, wo: Vector3<R>, wi: Vector3<R>) -> R {
    let m = (wo + wi).normalize();
    surface.pdf_visible(wo, m) / (R::splat(4.0) * wo.dot(m))
}

#[cfg(test)]
mod tests;
