//! Microfacets: how the normals of a rough surface are distributed, and which of them are seen.
//!
//! With the slopes x̃ = m_x/(α_u m_z), ỹ = m_y/(α_v m_z) of a microfacet normal m,
//!
//! ```text
//! D(m) = exp(−x̃² − ỹ²)/(π α_u α_v m_z⁴)            Beckmann
//! D(m) = 1/(π α_u α_v m_z⁴ (1 + x̃² + ỹ²)²)         GGX [WML07]
//! ∫ D(m) cos θ_m dm = 1
//! ```
//!
//! and Smith's masking G1 makes ∫ G1(w) D(m) ⟨w·m⟩ dm = cos θ_w (the weak white furnace, \[Hei14\]). For
//! GGX, G1 = 2/(1 + √(1 + α²tan²θ)). For Beckmann, reflection uses the rational function of \[WML07\], as
//! most renderers do, and densities the exact one, so that they are densities to the last digit.

use crate::math::{erf, erf_inv, exp, pow, warp};
use crate::simd::{Real, Vector3, vector3};

/// Which distribution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Distribution {
    /// Gaussian slopes.
    #[default]
    Beckmann,
    /// Trowbridge and Reitz 1975, with its long tails.
    Ggx,
}

/// A distribution of normals over the hemisphere about +z.
#[derive(Clone, Copy, Debug)]
pub struct Microfacet<R> {
    kind: Distribution,
    alpha_u: R,
    alpha_v: R,
}

/// Smoother than this, f32 can't tell a lobe from a mirror.
const MIN_ALPHA: f32 = 1e-4;

impl<R: Real> Microfacet<R> {
    /// Roughness along the tangents; at least 10⁻⁴.
    #[inline]
    pub fn new(kind: Distribution, alpha_u: R, alpha_v: R) -> Self {
        let least = R::splat(MIN_ALPHA);
        Self { kind, alpha_u: alpha_u.max(least), alpha_v: alpha_v.max(least) }
    }

    /// D(m), per steradian.
    #[inline]
    pub fn d(&self, m: Vector3<R>) -> R {
        let (x, y) = (m.x / self.alpha_u, m.y / self.alpha_v);
        let area = R::splat(std::f32::consts::PI) * self.alpha_u * self.alpha_v;
        let z2 = m.z * m.z;
        let d = match self.kind {
            Distribution::Beckmann => exp(-((x * x + y * y) / z2)) / (area * z2 * z2),
            Distribution::Ggx => {
                let sum = x * x + y * y + z2;
                R::one() / (area * sum * sum)
            }
        };
        // Beckmann at m_z = 0 is 0/0, and what is next to nothing overflows in quotients.
        R::select((d * m.z).gt(R::splat(1e-20)), d, R::zero())
    }

    /// Smith's G1(w, m): 0 where w sees the back of m.
    #[inline]
    pub fn g1(&self, w: Vector3<R>, m: Vector3<R>) -> R {
        let g = match self.kind {
            Distribution::Beckmann => {
                let a = self.steepness(w);
                let rational = (R::splat(3.535) * a + R::splat(2.181) * a * a)
                    / (R::one() + R::splat(2.276) * a + R::splat(2.577) * a * a);
                R::select(a.lt(R::splat(1.6)), rational, R::one())
            }
            Distribution::Ggx => self.g1_ggx(w),
        };
        g.only((w.dot(m) * w.z).gt(R::zero()))
    }

    /// G1(wi) G1(wo), the separable form.
    #[inline]
    pub fn g(&self, wo: Vector3<R>, wi: Vector3<R>, m: Vector3<R>) -> R {
        self.g1(wo, m) * self.g1(wi, m)
    }

    /// A normal as `wo` sees them. `wo` is above.
    #[inline]
    pub fn sample_visible(&self, wo: Vector3<R>, (u, v): (R, R)) -> Vector3<R> {
        // The surface is stretched to unit roughness, and the normal back.
        let stretched = vector3(wo.x * self.alpha_u, wo.y * self.alpha_v, wo.z).normalize();
        match self.kind {
            Distribution::Beckmann => {
                let (x, y) = beckmann_slopes(stretched, (u, v));
                vector3(-(x * self.alpha_u), -(y * self.alpha_v), R::one()).normalize()
            }
            Distribution::Ggx => {
                let n = visible_hemisphere(stretched, (u, v));
                vector3(n.x * self.alpha_u, n.y * self.alpha_v, n.z.max(R::zero())).normalize()
            }
        }
    }

    /// Density of [`sample_visible`](Self::sample_visible) per solid angle of m:
    /// G1(wo) D(m) ⟨wo·m⟩/cos θ_o.
    #[inline]
    pub fn pdf_visible(&self, wo: Vector3<R>, m: Vector3<R>) -> R {
        let g = match self.kind {
            Distribution::Beckmann => self.g1_beckmann(wo),
            Distribution::Ggx => self.g1_ggx(wo),
        };
        (self.d(m) * g * wo.dot(m) / wo.z).only(wo.dot(m).gt(R::zero()) & wo.z.gt(R::zero()))
    }

    /// 1/(α tan θ), α in the direction of w.
    #[inline]
    fn steepness(&self, w: Vector3<R>) -> R {
        let (x, y) = (w.x * self.alpha_u, w.y * self.alpha_v);
        w.z.abs() / (x * x + y * y).max(R::splat(f32::MIN_POSITIVE)).sqrt()
    }

    #[inline]
    fn g1_ggx(&self, w: Vector3<R>) -> R {
        let (x, y) = (w.x * self.alpha_u, w.y * self.alpha_v);
        let tan2 = (x * x + y * y) / (w.z * w.z);
        R::splat(2.0) / (R::one() + (R::one() + tan2).sqrt())
    }

    /// 2/(1 + erf a + exp(−a²)/(a√π)).
    #[inline]
    fn g1_beckmann(&self, w: Vector3<R>) -> R {
        let a = self.steepness(w).min(R::splat(1e3));
        let tail = exp(-(a * a)) / (a * R::splat(SQRT_PI));
        R::splat(2.0) / (R::one() + erf(a) + tail)
    }
}

const SQRT_PI: f32 = 1.772_453_9;

/// Visible normals of the unit hemisphere, that is, of GGX with α = 1: the hemisphere projected along
/// the view is half a disc and half an ellipse \[Hei18\].
#[inline]
fn visible_hemisphere<R: Real>(wo: Vector3<R>, (u, v): (R, R)) -> Vector3<R> {
    let across = wo.x * wo.x + wo.y * wo.y;
    let usable = across.gt(R::zero());
    let scale = R::one() / R::select(usable, across, R::one()).sqrt();
    let t1 = vector3(
        R::select(usable, -(wo.y * scale), R::one()),
        R::select(usable, wo.x * scale, R::zero()),
        R::zero(),
    );
    let t2 = wo.cross(t1);
    let (a, b) = warp::disk(u, v);
    let s = R::splat(0.5) * (R::one() + wo.z);
    let b = (R::one() - s) * (R::one() - a * a).max(R::zero()).sqrt() + s * b;
    let c = (R::one() - a * a - b * b).max(R::zero()).sqrt();
    t1.scale(a) + t2.scale(b) + wo.scale(c)
}

/// Visible slopes of Beckmann with α = 1 \[Jak14\]: the one across the view is Gaussian; the one along it
/// has the cumulative distribution
///
/// ```text
/// C(x) ∝ 1 + erf x + tan θ exp(−x²)/√π        x ≤ cot θ
/// ```
///
/// inverted in b = erf x by three steps of Newton's method, held between brackets.
#[inline]
fn beckmann_slopes<R: Real>(wo: Vector3<R>, (u, v): (R, R)) -> (R, R) {
    let sin = (wo.x * wo.x + wo.y * wo.y).sqrt();
    let usable = sin.gt(R::splat(1e-7));
    let rcp = R::one() / R::select(usable, sin, R::one());
    let (cos_phi, sin_phi) =
        (R::select(usable, wo.x * rcp, R::one()), R::select(usable, wo.y * rcp, R::zero()));

    let tan = sin / wo.z.max(R::splat(1e-6));
    let cot = wo.z * rcp;
    let (top, tail) = (erf(cot), tan * R::splat(1.0 / SQRT_PI));
    let (top, tail) = (R::select(usable, top, R::one()), tail);
    let norm = R::one() + top + tail * exp(-(cot * cot)).only(usable);
    // A fit in the angle of view of where the root lies; the cosine stands for the angle.
    let theta = crate::math::acos(wo.z);
    let fit = R::one() + theta * (R::splat(-0.876) + theta * (R::splat(0.4265) - theta * R::splat(0.0594)));
    let mut b = top - (R::one() + top) * pow(R::one() - u, fit);
    let (mut low, mut high) = (-R::one(), top);
    for _ in 0..3 {
        let x = erf_inv(b);
        let f = R::one() + b + tail * exp(-(x * x)) - u * norm;
        let above = f.gt(R::zero());
        (low, high) = (R::select(above, low, b), R::select(above, b, high));
        let next = b - f / (R::one() - x * tan);
        let inside = next.ge(low) & next.le(high);
        b = R::select(inside, next, R::splat(0.5) * (low + high));
    }
    let along = erf_inv(b);
    let across = erf_inv(v + v - R::one());
    (cos_phi * along - sin_phi * across, sin_phi * along + cos_phi * across)
}

#[cfg(test)]
mod tests;
