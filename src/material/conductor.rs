//! Ideal mirror: a smooth conductor.
//!
//! L(wo) = F(cos θ) L(wi), wi = (−wo_x, −wo_y, wo_z), F the exact reflectance of η + ik per channel.

use super::{Branch, Sample, fresnel};
use crate::simd::{Mask, Real, Vector3, vector3};

/// A delta lobe in the mirror direction, black from behind.
#[derive(Clone, Copy, Debug)]
pub struct Conductor<R> {
    /// Real part of the index of refraction.
    pub eta: Vector3<R>,
    /// Imaginary part of the index of refraction.
    pub k: Vector3<R>,
    /// Factor on what is reflected.
    pub reflectance: Vector3<R>,
}

impl<R: Real> Conductor<R> {
    /// The mirror direction.
    #[inline]
    pub fn reflect(&self, wo: Vector3<R>) -> Branch<R> {
        Branch {
            wi: mirror(wo),
            weight: self.reflectance * fresnel::conductor_rgb(wo.z, self.eta, self.k),
            valid: wo.z.gt(R::zero()),
        }
    }

    /// The mirror direction, always.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>) -> Sample<R> {
        let Branch { wi, weight, valid } = self.reflect(wo);
        Sample { wi, weight, pdf: R::one(), eta: R::one(), delta: R::Mask::splat(true), valid }
    }
}

#[inline]
pub(super) fn mirror<R: Real>(wo: Vector3<R>) -> Vector3<R> {
    vector3(-wo.x, -wo.y, wo.z)
}

#[cfg(test)]
mod tests;
