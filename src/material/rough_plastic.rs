//! Rough plastic: microfacets of a dielectric over a diffuse base.
//!
//! ```text
//! f = F(wo·m) D(m) G(wo, wi)/(4 cos θ_i cos θ_o) + ρ/π T(θ_i) T(θ_o)/(η² (1 − R_int))
//! ```
//!
//! T(θ) is what single scattering lets through the coat, R_int what it reflects of diffuse light from
//! below. Both come from a table, one a material; where α is a texture, from several over α.

use super::{
    Sample,
    coat::CoatAt,
    fresnel,
    lambert::above,
    microfacet::Microfacet,
    plastic::Base,
    rough_conductor::{reflect, reflection_pdf},
};
use crate::math::{INV_PI, warp};
use crate::simd::{Mask, Real, Vector3};

/// A glossy lobe over a diffuse one, black from behind.
#[derive(Clone, Copy, Debug)]
pub struct RoughPlastic<'t, R> {
    /// The coat's microfacets.
    pub surface: Microfacet<R>,
    /// What the coat lets through.
    pub coat: CoatAt<'t, R>,
    /// The base.
    pub base: Base<R>,
    /// Factor on what the coat reflects.
    pub specular: Vector3<R>,
}

impl<R: Real> RoughPlastic<'_, R> {
    /// f cos θ_i.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        let m = (wo + wi).normalize();
        let (reflectance, ..) = fresnel::dielectric(wo.dot(m), self.base.eta);
        let lobe = reflectance * self.surface.d(m) * self.surface.g(wo, wi, m) / (R::splat(4.0) * wo.z);
        let through = self.coat.transmittance(wo.z) * self.coat.transmittance(wi.z);
        let diffuse = self.base.reflectance().scale(through * wi.z * R::splat(INV_PI));
        (self.specular.scale(lobe) + diffuse).only(above(wo, wi))
    }

    /// The mixture of the visible normals' reflections and the cosine.
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        let share = self.glossy_share(wo);
        let glossy = reflection_pdf(&self.surface, wo, wi);
        let diffuse = warp::cosine_hemisphere_pdf(wi.z);
        (share * glossy + (R::one() - share) * diffuse).only(above(wo, wi))
    }

    /// A direction of one of the lobes.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, lobe: R, u: (R, R)) -> Sample<R> {
        let glossy = reflect(wo, self.surface.sample_visible(wo, u));
        let diffuse = warp::cosine_hemisphere(u.0, u.1);
        let wi = Vector3::select(lobe.lt(self.glossy_share(wo)), glossy, diffuse);
        Sample::quotient(wi, self.eval(wo, wi), self.pdf(wo, wi), R::Mask::splat(true))
    }

    #[inline]
    fn glossy_share(&self, wo: Vector3<R>) -> R {
        self.base.coat_share(self.specular, R::one() - self.coat.transmittance(wo.z))
    }
}

#[cfg(test)]
mod tests;
