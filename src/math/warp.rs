//! Maps from the unit square to other domains, uniform unless said otherwise.

use std::f32::consts::TAU;

use super::sin_cos_turns;
use crate::simd::{Real, Vector3, vector3};

/// The unit disc, by the concentric map \[SC97\]: adjacent squares stay adjacent.
#[inline]
pub fn disk<R: Real>(u: R, v: R) -> (R, R) {
    let (a, b) = (u + u - R::one(), v + v - R::one());
    let wide = b.abs().lt(a.abs());
    let (radius, other) = (R::select(wide, a, b), R::select(wide, b, a));
    // other/radius in [-1, 1] is an eighth of a turn at most; the centre of the square is the centre.
    let ratio = R::select(radius.equal(R::zero()), R::zero(), other / radius);
    let (sin, cos) = sin_cos_turns(ratio * R::splat(0.125));
    (radius * R::select(wide, cos, sin), radius * R::select(wide, sin, cos))
}

/// The hemisphere about +z with density cos θ/π per solid angle: the disc, lifted (Malley's method).
#[inline]
pub fn cosine_hemisphere<R: Real>(u: R, v: R) -> Vector3<R> {
    let (x, y) = disk(u, v);
    let z = (R::one() - x * x - y * y).max(R::zero()).sqrt();
    vector3(x, y, z)
}

/// Unit vectors within an angle θ of +z, density 1/(2π(1 − cos θ)) per solid angle. `one_minus_cos_max` is
/// 1 − cos θ; 2 is the whole sphere.
#[inline]
pub fn cone<R: Real>(u: R, v: R, one_minus_cos_max: R) -> Vector3<R> {
    // 1 − z is kept, not z: a narrow cone has no bits left in its cosine.
    let below = u * one_minus_cos_max;
    let (sin, cos) = sin_cos_turns(v);
    let r = (below * (R::splat(2.0) - below)).max(R::zero()).sqrt();
    vector3(r * cos, r * sin, R::one() - below)
}

/// The unit sphere, density 1/4π per solid angle.
#[inline]
pub fn sphere<R: Real>(u: R, v: R) -> Vector3<R> {
    cone(u, v, R::splat(2.0))
}

/// Barycentric coordinates (b1, b2), uniform over a triangle's area: the unit square folded over its
/// diagonal (Heitz 2019, "A Low-Distortion Map Between Triangle and Square").
#[inline]
pub fn triangle<R: Real>(u: R, v: R) -> (R, R) {
    let half = R::splat(0.5);
    let upper = u.lt(v);
    let (small, large) = (R::select(upper, u, v), R::select(upper, v, u));
    let (a, b) = (small * half, large - small * half);
    (R::select(upper, a, b), R::select(upper, b, a))
}

/// The density per solid angle of [`cosine_hemisphere`] at a cosine ≥ 0.
#[inline]
pub fn cosine_hemisphere_pdf<R: Real>(cos: R) -> R {
    cos.max(R::zero()) * R::splat(super::INV_PI)
}

/// The density per solid angle of [`cone`].
#[inline]
pub fn cone_pdf<R: Real>(one_minus_cos_max: R) -> R {
    R::one() / (R::splat(TAU) * one_minus_cos_max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// The mean of f over a grid of midpoints.
    fn mean(mut f: impl FnMut(f32, f32) -> f64) -> f64 {
        let n = 256;
        let at = |i: u32| (i as f32 + 0.5) / n as f32;
        (0..n * n).map(|i| f(at(i % n), at(i / n))).sum::<f64>() / f64::from(n * n)
    }

    #[test]
    fn disk_has_the_moments_of_the_uniform_disc() {
        assert!(
            (mean(|u, v| {
                let (x, y) = disk(u, v);
                f64::from(x * x + y * y)
            }) - 0.5)
                .abs()
                < 1e-4
        );
        assert!(mean(|u, v| f64::from(disk(u, v).0)).abs() < 1e-4);
        assert!(
            (mean(|u, v| {
                let (x, _) = disk(u, v);
                f64::from(x * x)
            }) - 0.25)
                .abs()
                < 1e-4
        );
    }

    #[test]
    fn hemisphere_is_cosine_weighted() {
        // E[cos² θ] = 1/2 under cos θ/π; even powers are smooth at the rim, so the grid converges.
        let second = mean(|u, v| {
            let z = f64::from(cosine_hemisphere(u, v).z);
            z * z
        });
        assert!((second - 0.5).abs() < 1e-4, "{second}");
        assert!((mean(|u, v| f64::from(Vec3::from(cosine_hemisphere(u, v)).length())) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn cones_are_uniform_in_their_cosine() {
        for cos_max in [-1.0f32, 0.0, 0.9, 0.999_999] {
            let want = f64::from(0.5 + 0.5 * cos_max);
            let got = mean(|u, v| f64::from(cone(u, v, 1.0 - cos_max).z));
            assert!((got - want).abs() < 1e-6, "{cos_max}: {got} {want}");
            assert!(
                (mean(|u, v| f64::from(Vec3::from(cone(u, v, 1.0 - cos_max)).length())) - 1.0).abs() < 1e-6
            );
        }
    }

    #[test]
    fn triangle_has_the_moments_of_the_uniform_triangle() {
        assert!((mean(|u, v| f64::from(triangle(u, v).0)) - 1.0 / 3.0).abs() < 1e-5);
        assert!((mean(|u, v| f64::from(triangle(u, v).1)) - 1.0 / 3.0).abs() < 1e-5);
        let second = mean(|u, v| {
            let (b, c) = triangle(u, v);
            f64::from(b * c)
        });
        assert!((second - 1.0 / 12.0).abs() < 1e-5, "{second}");
    }
}
