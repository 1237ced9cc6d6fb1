//! Ward's anisotropic reflection, bounded \[GD10\].
//!
//! With the half vector h = wo + wi, not normalised,
//!
//! ```text
//! f = ρ_d/π + ρ_s/(π α_u α_v) exp(−((h_x/α_u)² + (h_y/α_v)²)/h_z²) (h·h)/h_z⁴
//! ```
//!
//! Reciprocal. Ward's own form \[War92\] divides by √(cos θ_i cos θ_o) and loses light at grazing angles;
//! dividing by cos θ_i cos θ_o keeps it, without a bound. This one has an albedo of at most ρ_d + ρ_s.
//! Sampled by the half vector's slopes \[Wal05\].

use super::{Sample, lambert::above, rough_conductor::reflect};
use crate::math::{INV_PI, exp, ln, sin_cos_turns, warp};
use crate::simd::{Real, Vector3, vector3};

/// Diffuse plus a Gaussian of slopes, black from behind.
#[derive(Clone, Copy, Debug)]
pub struct Ward<R> {
    /// ρ_d.
    pub diffuse: Vector3<R>,
    /// ρ_s.
    pub specular: Vector3<R>,
    /// Standard deviation of slopes along the first tangent, times √2.
    pub alpha_u: R,
    /// Along the second.
    pub alpha_v: R,
}

/// Smoother than this, the Gaussian overflows.
const MIN_ALPHA: f32 = 1e-3;

impl<R: Real> Ward<R> {
    /// Roughness of at least 10⁻³.
    #[inline]
    pub fn new(diffuse: Vector3<R>, specular: Vector3<R>, alpha_u: R, alpha_v: R) -> Self {
        let least = R::splat(MIN_ALPHA);
        Self { diffuse, specular, alpha_u: alpha_u.max(least), alpha_v: alpha_v.max(least) }
    }

    /// f cos θ_i.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        let h = wo + wi;
        let z2 = h.z * h.z;
        let lobe = self.gaussian(h) * h.dot(h) / (z2 * z2);
        let f = self.diffuse.scale(R::splat(INV_PI)) + self.specular.scale(lobe);
        f.scale(wi.z).only(above(wo, wi))
    }

    /// The mixture of the slopes' density, over 4 wo·m m_z³, and of cos θ/π.
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        let h = wo + wi;
        let m = h.normalize();
        let glossy = self.gaussian(h) / (R::splat(4.0) * wo.dot(m) * m.z * m.z * m.z);
        let share = self.specular_share();
        let diffuse = warp::cosine_hemisphere_pdf(wi.z);
        (share * glossy + (R::one() - share) * diffuse).only(above(wo, wi))
    }

    /// A direction of one of the lobes.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, lobe: R, (u, v): (R, R)) -> Sample<R> {
        let radius = (-ln(R::one() - u)).max(R::zero()).sqrt();
        let (sin, cos) = sin_cos_turns(v);
        let slopes = vector3(self.alpha_u * radius * cos, self.alpha_v * radius * sin, R::one());
        let m = slopes.normalize();
        let mirrored = reflect(wo, m);
        let glossy = lobe.lt(self.specular_share());
        let wi = Vector3::select(glossy, mirrored, warp::cosine_hemisphere(u, v));
        // A half vector seen from behind reflects to where its density does not reach.
        let faces = wo.dot(m).gt(R::zero()) | !glossy;
        Sample::quotient(wi, self.eval(wo, wi), self.pdf(wo, wi), faces)
    }

    /// exp(−tan² …)/(π α_u α_v).
    #[inline]
    fn gaussian(&self, h: Vector3<R>) -> R {
        let (x, y) = (h.x / (self.alpha_u * h.z), h.y / (self.alpha_v * h.z));
        exp(-(x * x + y * y)) * R::splat(INV_PI) / (self.alpha_u * self.alpha_v)
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
