//! Ideal diffuse reflection (Lambert 1760).
//!
//! ```text
//! f = ρ/π                       both directions on the side of the normal
//! ∫ f cos θ dω = ρ              so ρ in [0, 1] is the albedo
//! ```
//!
//! Sampled by the cosine: the weight is ρ.

use super::Sample;
use crate::math::{INV_PI, warp};
use crate::simd::{Mask, Real, Vector3};

/// f = ρ/π, black from behind.
#[derive(Clone, Copy, Debug)]
pub struct Lambert<R> {
    /// ρ, the share of light that is reflected, in [0, 1].
    pub reflectance: Vector3<R>,
}

impl<R: Real> Lambert<R> {
    /// ρ cos θ_i / π.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        self.reflectance.scale((wi.z * R::splat(INV_PI)).only(above(wo, wi)))
    }

    /// cos θ_i / π.
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        warp::cosine_hemisphere_pdf(wi.z).only(above(wo, wi))
    }

    /// A cosine-distributed direction.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, (u, v): (R, R)) -> Sample<R> {
        let wi = warp::cosine_hemisphere(u, v);
        let pdf = warp::cosine_hemisphere_pdf(wi.z);
        Sample {
            wi,
            weight: self.reflectance,
            pdf,
            eta: R::one(),
            delta: R::Mask::splat(false),
            valid: wo.z.gt(R::zero()) & pdf.gt(R::zero()),
        }
    }

    /// The weight of [`sample`](Self::sample) where it is valid, else 0.
    #[inline]
    pub(super) fn sampled_weight(&self, wo: Vector3<R>, (u, v): (R, R)) -> Vector3<R> {
        // Only next to the rim of the square can a cosine be rounded to 0: elsewhere the direction is not needed.
        let rim = |x: R| (x + x - R::one()).abs().ge(R::splat(0.999));
        if (rim(u) | rim(v)).none() {
            return self.reflectance.only(wo.z.gt(R::zero()));
        }
        let sample = self.sample(wo, (u, v));
        sample.weight.only(sample.valid)
    }
}

#[inline]
pub(super) fn above<R: Real>(wo: Vector3<R>, wi: Vector3<R>) -> R::Mask {
    wo.z.gt(R::zero()) & wi.z.gt(R::zero())
}

#[cfg(test)]
mod tests;
