//! Ideal glass: a smooth interface between two dielectrics.
//!
//! With F from Fresnel's equations and η = n(far)/n(near), Snell's law gives the refracted direction
//! wi = −wo/η with its normal part replaced by ∓cos θ_t, and
//!
//! ```text
//! L(wo) = F L(reflected) + (1 − F) L(refracted) / η²
//! ```
//!
//! The 1/η² is the change of radiance with the width of the beam \[Nic77\]: radiance over n² is constant.

use super::{Branch, Sample, conductor::mirror, fresnel};
use crate::simd::{Mask, Real, Vector3, vector3};

/// Two delta lobes; the exterior is on the side of the normal.
#[derive(Clone, Copy, Debug)]
pub struct Dielectric<R> {
    /// n_int/n_ext.
    pub eta: R,
    /// Factor on what is reflected.
    pub reflectance: Vector3<R>,
    /// Factor on what is refracted.
    pub transmittance: Vector3<R>,
}

impl<R: Real> Dielectric<R> {
    /// Reflection and refraction, each with its share.
    #[inline]
    pub fn branches(&self, wo: Vector3<R>) -> [Branch<R>; 2] {
        let (reflectance, refracted, eta) = self.interface(wo);
        let there = !wo.z.equal(R::zero());
        let through = (R::one() - reflectance) / (eta * eta);
        [
            Branch {
                wi: mirror(wo),
                weight: self.reflectance.scale(reflectance),
                valid: there & reflectance.gt(R::zero()),
            },
            Branch {
                wi: refracted,
                weight: self.transmittance.scale(through),
                valid: there & reflectance.lt(R::one()),
            },
        ]
    }

    /// One of the two, by Fresnel's reflectance.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, lobe: R) -> Sample<R> {
        let (reflectance, refracted, eta) = self.interface(wo);
        let reflects = lobe.lt(reflectance);
        let through = self.transmittance.scale(R::one() / (eta * eta));
        Sample {
            wi: Vector3::select(reflects, mirror(wo), refracted),
            weight: Vector3::select(reflects, self.reflectance, through),
            pdf: R::select(reflects, reflectance, R::one() - reflectance),
            eta: R::select(reflects, R::one(), eta),
            delta: R::Mask::splat(true),
            valid: !wo.z.equal(R::zero()),
        }
    }

    /// (F, refracted direction, η).
    #[inline]
    fn interface(&self, wo: Vector3<R>) -> (R, Vector3<R>, R) {
        let (reflectance, cos_t, eta) = fresnel::dielectric(wo.z, self.eta);
        let scale = -(R::one() / eta);
        let z = R::select(wo.z.ge(R::zero()), -cos_t, cos_t);
        (reflectance, vector3(wo.x * scale, wo.y * scale, z), eta)
    }
}

#[cfg(test)]
mod tests;
