//! The clear coat of the principled model: GTR1 \[Bur12\], and Schlick's approximation.
//!
//! ```text
//! D(m) = (α² − 1)/(π ln α² (1 + (α² − 1) cos²θ_m))       α from 0.1 to 0.001 by gloss
//! ```
//!
//! Its tails are longer than those of GGX. Masking is that of GGX with α = ¼, and the normal's reflectance
//! 0.04. The quotient by 4 cos θ_i cos θ_o is left out, as Burley has it.

use super::microfacet::{Distribution, Microfacet};
use crate::math::{INV_PI, ln, pow, sin_cos_turns};
use crate::simd::{Real, Vector3, vector3};

/// ¼ F D G cos θ_i of the coat, for directions above.
#[inline]
pub(super) fn eval<R: Real>(wo: Vector3<R>, wi: Vector3<R>, m: Vector3<R>, eta: R, gloss: R) -> R {
    let quarter = R::splat(0.25);
    let normal = R::splat(0.04);
    let reflectance = schlick(vector3(normal, normal, normal), wo.dot(m), eta).x;
    let g = Microfacet::new(Distribution::Ggx, quarter, quarter).g(wo, wi, m);
    quarter * reflectance * d(m, alpha2(gloss)) * g * wi.z.abs()
}

/// D(m) cos θ_m.
#[inline]
pub(super) fn normal_pdf<R: Real>(m: Vector3<R>, gloss: R) -> R {
    d(m, alpha2(gloss)) * m.z
}

/// A normal with density D(m) cos θ_m.
#[inline]
pub(super) fn sample_normal<R: Real>(gloss: R, (u, v): (R, R)) -> Vector3<R> {
    let alpha2 = alpha2(gloss);
    let cos2 = (R::one() - pow(alpha2, R::one() - v)) / (R::one() - alpha2);
    let (sin, cos) = ((R::one() - cos2).max(R::zero()).sqrt(), cos2.max(R::zero()).sqrt());
    let (s, c) = sin_cos_turns(u);
    vector3(c * sin, s * sin, cos)
}

/// F₀ + (1 − F₀)(1 − cos)⁵, with the refracted cosine where light leaves the denser side.
#[inline]
pub(super) fn schlick<R: Real>(normal: Vector3<R>, cos: R, eta: R) -> Vector3<R> {
    let eta = R::select(cos.ge(R::zero()), eta, R::one() / eta);
    let refracted = (R::one() - (R::one() - cos * cos) / (eta * eta)).max(R::zero()).sqrt();
    let weight = schlick_weight(R::select(eta.gt(R::one()), cos.abs(), refracted));
    normal.map(|f| f * (R::one() - weight) + weight)
}

/// (1 − cos)⁵.
#[inline]
pub(super) fn schlick_weight<R: Real>(cos: R) -> R {
    let x = (R::one() - cos).clamp(0.0, 1.0);
    let x2 = x * x;
    x2 * x2 * x
}

#[inline]
fn alpha2<R: Real>(gloss: R) -> R {
    let alpha = R::splat(0.1) + (R::splat(0.001) - R::splat(0.1)) * gloss;
    alpha * alpha
}

#[inline]
fn d<R: Real>(m: Vector3<R>, alpha2: R) -> R {
    let less = alpha2 - R::one();
    // 1 − cos² from the tangents: near the pole the difference would have no bits left.
    let sin2 = m.x * m.x + m.y * m.y;
    less * R::splat(INV_PI) / (ln(alpha2) * (alpha2 - less * sin2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::proof;

    #[test]
    fn the_normals_are_a_density() {
        let total = proof::hemisphere(|m| f64::from(normal_pdf(m, 0.0)));
        assert!((total - 1.0).abs() < 2e-3, "{total}");
    }

    #[test]
    fn half_of_the_samples_are_within_the_median() {
        // The distribution of cos²: (1 − α^(2(1−v)))/(1 − α²) at v = ½.
        let m = sample_normal(0.0f32, (0.3, 0.5));
        assert!((m.z * m.z - (1.0 - 0.1) / (1.0 - 0.01)).abs() < 1e-5, "{m:?}");
        assert!((m.length() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn schlick_has_its_ends() {
        let f = |cos: f32, eta: f32| schlick(vector3(0.04, 0.5, 1.0), cos, eta);
        assert_eq!((f(1.0, 1.5).x, f(1.0, 1.5).y, f(0.0, 1.5).x), (0.04, 0.5, 1.0));
        // From inside, all is reflected from the critical angle on.
        assert_eq!(f(-0.2, 1.5).x, 1.0);
    }
}
