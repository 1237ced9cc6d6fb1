//! Toon: light in steps, as cartoons are painted.
//!
//! ```text
//! f cos θ_i = ρ/π ⌊n cos θ_i⌋/(n − 1), at most ρ/π     n bands from black to full light
//! ```
//!
//! The ramp stands in place of the cosine, not beside it: divided by cos θ_i it is not reciprocal, and no
//! surface is like that. ∫ ramp = ½ over the cosine, so the albedo is ρ all the same.

use super::{Sample, lambert::above};
use crate::math::{INV_PI, warp};
use crate::simd::{Mask, Real, Vector3};

/// Bands of light, black from behind.
#[derive(Clone, Copy, Debug)]
pub struct Toon<R> {
    /// ρ.
    pub reflectance: Vector3<R>,
    /// n, a whole number of at least 2.
    pub bands: R,
}

impl<R: Real> Toon<R> {
    /// ρ/π times the ramp.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        let top = self.bands - R::one();
        let ramp = (self.bands * wi.z).floor().min(top) / top;
        self.reflectance.scale((ramp * R::splat(INV_PI)).only(above(wo, wi)))
    }

    /// cos θ_i/π.
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        warp::cosine_hemisphere_pdf(wi.z).only(above(wo, wi))
    }

    /// A cosine-distributed direction.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, (u, v): (R, R)) -> Sample<R> {
        let wi = warp::cosine_hemisphere(u, v);
        Sample::quotient(wi, self.eval(wo, wi), self.pdf(wo, wi), R::Mask::splat(true))
    }
}

#[cfg(test)]
mod tests;
