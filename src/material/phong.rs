//! Energy-normalised modified Phong \[LW94\].
//!
//! ```text
//! f = ρ_d/π + ρ_s (n + 2)/2π cosⁿα       α between wi and the mirror direction of wo
//! ```
//!
//! Reciprocal, since α is the same with wo and wi exchanged; ρ_d + ρ_s ≤ 1 conserves energy, because
//! ∫ cosⁿα cos θ dω ≤ 2π/(n + 2), with equality at normal incidence. The form on Phong's own slide has
//! no cos θ_i beside cosⁿα: divided by the cosine it is not reciprocal.

use super::{Sample, conductor::mirror, lambert::above};
use crate::math::{Frame, INV_PI, INV_TWO_PI, pow, sin_cos_turns, warp};
use crate::simd::{Mask, Real, Vector3, vector3};

/// Diffuse plus a cosine lobe, black from behind.
#[derive(Clone, Copy, Debug)]
pub struct Phong<R> {
    /// ρ_d.
    pub diffuse: Vector3<R>,
    /// ρ_s.
    pub specular: Vector3<R>,
    /// n ≥ 0.
    pub exponent: R,
}

impl<R: Real> Phong<R> {
    /// f cos θ_i.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        let lobe = self.lobe(wo, wi) * (self.exponent + R::splat(2.0)) * R::splat(INV_TWO_PI);
        let f = self.diffuse.scale(R::splat(INV_PI)) + self.specular.scale(lobe);
        f.scale(wi.z.only(above(wo, wi)))
    }

    /// The mixture of both lobes' densities: (n + 1)/2π cosⁿα and cos θ/π.
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        let lobe = self.lobe(wo, wi) * (self.exponent + R::one()) * R::splat(INV_TWO_PI);
        let choose = self.specular_share();
        let pdf = choose * lobe + (R::one() - choose) * warp::cosine_hemisphere_pdf(wi.z);
        pdf.only(above(wo, wi))
    }

    /// A direction of one of the lobes.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, lobe: R, (u, v): (R, R)) -> Sample<R> {
        // cos α = u^(1/(n+1)) about the mirror direction.
        let cos = pow(u, R::one() / (self.exponent + R::one()));
        let sin = (R::one() - cos * cos).max(R::zero()).sqrt();
        let (s, c) = sin_cos_turns(v);
        let glossy = Frame::around(mirror(wo)).to_world(vector3(sin * c, sin * s, cos));
        let wi = Vector3::select(lobe.lt(self.specular_share()), glossy, warp::cosine_hemisphere(u, v));
        let pdf = self.pdf(wo, wi);
        let valid = pdf.gt(R::zero());
        let weight = self.eval(wo, wi).scale(R::one() / R::select(valid, pdf, R::one()));
        Sample { wi, weight, pdf, eta: R::one(), delta: R::Mask::splat(false), valid }
    }

    #[inline]
    fn lobe(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        let cos = mirror(wo).dot(wi);
        // Nothing beyond a right angle, for n = 0 either: 0⁰ is 1.
        pow(cos.max(R::zero()), self.exponent).only(cos.gt(R::zero()))
    }

    /// Probability of the glossy lobe: its part of the albedos' sum.
    #[inline]
    fn specular_share(&self) -> R {
        let sum = |c: Vector3<R>| c.x + c.y + c.z;
        let (s, d) = (sum(self.specular), sum(self.diffuse));
        R::select((s + d).gt(R::zero()), s / (s + d), R::zero())
    }
}

#[cfg(test)]
mod tests;
