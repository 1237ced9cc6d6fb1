//! Smooth plastic: a dielectric coat over a diffuse base.
//!
//! The coat mirrors F of the light; what it lets in is scattered, and some of that is reflected back
//! down from below, again and again. With η = n_int/n_ext and the internal reflectance of diffuse light
//! F_dr = 2 ∫ F(cos θ, 1/η) cos θ d(cos θ),
//!
//! ```text
//! f = δ F + ρ/π (1 − F(θ_i)) (1 − F(θ_o)) / (η² (1 − F_dr))
//! ```
//!
//! Where `nonlinear`, ρ F_dr stands in place of F_dr: colours saturate as they bounce below the coat.

use super::{Branch, Sample, conductor::mirror, fresnel, lambert::above};
use crate::math::{INV_PI, warp};
use crate::simd::{Mask, Real, Vector3};

/// A delta lobe over a diffuse one, black from behind.
#[derive(Clone, Copy, Debug)]
pub struct Plastic<R> {
    /// The base.
    pub base: Base<R>,
    /// Factor on what the coat reflects.
    pub specular: Vector3<R>,
}

/// The diffuse base below a coat.
#[derive(Clone, Copy, Debug)]
pub struct Base<R> {
    /// ρ.
    pub diffuse: Vector3<R>,
    /// n_int/n_ext.
    pub eta: R,
    /// Reflectance of the coat for diffuse light from below.
    pub internal: R,
    /// Does colour saturate with each bounce below the coat?
    pub nonlinear: bool,
}

impl<R: Real> Base<R> {
    /// ρ/(η² (1 − F_dr)), with ρ F_dr in place of F_dr where nonlinear.
    #[inline]
    pub(super) fn reflectance(&self) -> Vector3<R> {
        let kept = |rho: R| {
            let again = if self.nonlinear { rho * self.internal } else { self.internal };
            rho / ((R::one() - again) * self.eta * self.eta)
        };
        self.diffuse.map(kept)
    }

    /// Probability of the coat's lobe, where the coat reflects `coat` in [0, 1] of the light: by both
    /// lobes' share of the energy.
    #[inline]
    pub(super) fn coat_share(&self, specular: Vector3<R>, coat: R) -> R {
        let sum = |c: Vector3<R>| c.x + c.y + c.z;
        let (s, d) = (sum(specular) * coat, sum(self.diffuse) * (R::one() - coat));
        R::select((s + d).gt(R::zero()), s / (s + d), R::zero())
    }
}

impl<R: Real> Plastic<R> {
    /// f cos θ_i of the diffuse part.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        let through = self.transmitted(wo) * self.transmitted(wi);
        self.base.reflectance().scale((through * wi.z * R::splat(INV_PI)).only(above(wo, wi)))
    }

    /// cos θ_i/π times the probability of the diffuse part.
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        let share = R::one() - self.mirror_share(wo);
        (share * warp::cosine_hemisphere_pdf(wi.z)).only(above(wo, wi))
    }

    /// The mirror direction or a cosine-distributed one.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, lobe: R, (u, v): (R, R)) -> Sample<R> {
        let share = self.mirror_share(wo);
        let mirrors = lobe.lt(share);
        let diffuse = warp::cosine_hemisphere(u, v);
        let smooth =
            Sample::quotient(diffuse, self.eval(wo, diffuse), self.pdf(wo, diffuse), R::Mask::splat(true));
        let Branch { wi, weight, valid } = self.reflect(wo);
        let scale = R::one() / R::select(mirrors, share, R::one());
        Sample {
            wi: Vector3::select(mirrors, wi, smooth.wi),
            weight: Vector3::select(mirrors, weight.scale(scale), smooth.weight),
            pdf: R::select(mirrors, share, smooth.pdf),
            eta: R::one(),
            delta: mirrors,
            valid: (mirrors & valid) | (!mirrors & smooth.valid),
        }
    }

    /// The coat's mirror image.
    #[inline]
    pub fn reflect(&self, wo: Vector3<R>) -> Branch<R> {
        let (reflectance, ..) = fresnel::dielectric(wo.z, self.base.eta);
        Branch { wi: mirror(wo), weight: self.specular.scale(reflectance), valid: wo.z.gt(R::zero()) }
    }

    #[inline]
    fn transmitted(&self, w: Vector3<R>) -> R {
        R::one() - fresnel::dielectric(w.z, self.base.eta).0
    }

    #[inline]
    fn mirror_share(&self, wo: Vector3<R>) -> R {
        self.base.coat_share(self.specular, fresnel::dielectric(wo.z, self.base.eta).0)
    }
}

#[cfg(test)]
mod tests;
