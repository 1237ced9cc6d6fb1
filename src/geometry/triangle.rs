//! Ray against triangle \[MT97\].
//!
//! With s = org − v₀, p = dir × e₂, q = s × e₁ and det = e₁·p, Cramer's rule on
//! org + t·dir = v₀ + u·e₁ + v·e₂ gives
//!
//! ```text
//! u = s·p / det     v = dir·q / det     t = e₂·q / det
//! ```
//!
//! A hit has u ≥ 0, v ≥ 0 and u + v ≤ 1. Only det = 0 is parallel: a small triangle has a small
//! determinant and is no less a triangle. Unlike the paper there is no culling and no epsilon, and t is
//! clamped to the triangle's own slabs (see [`geometry`](super)).

use glam::Vec3;

use super::{Aabb, Ray, RayLanes, aabb};
use crate::simd::{Mask, Real, Vector3};

/// A vertex and two edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// First vertex.
    pub v0: Vec3,
    /// v₁ − v₀.
    pub e1: Vec3,
    /// v₂ − v₀.
    pub e2: Vec3,
}

impl Triangle {
    /// From three vertices.
    #[inline]
    pub fn new(v0: Vec3, v1: Vec3, v2: Vec3) -> Self {
        Self { v0, e1: v1 - v0, e2: v2 - v0 }
    }

    /// The box that decides hits: of v₀, v₀ + e₁ and v₀ + e₂ as they round.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points([self.v0, self.v0 + self.e1, self.v0 + self.e2])
    }

    /// One ray: (t, u, v).
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<(f32, f32, f32)> {
        let p = ray.dir.cross(self.e2);
        let det = self.e1.dot(p);
        if det == 0.0 {
            return None;
        }
        let inverse = 1.0 / det;
        let s = ray.org - self.v0;
        let u = s.dot(p) * inverse;
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let q = s.cross(self.e1);
        let v = ray.dir.dot(q) * inverse;
        let inside = v >= 0.0 && u + v <= 1.0;
        if !inside {
            return None;
        }
        let t = self.e2.dot(q) * inverse;
        let (low, high) =
            self.bounds().interval(&Ray { t_near: f32::NEG_INFINITY, t_far: f32::INFINITY, ..*ray });
        let t = Real::min(high, Real::max(low, t));
        (low <= high && ray.t_near < t && t <= ray.t_far).then_some((t, u, v))
    }
}

/// Triangles in lanes: eight of a block, or one in all of them.
#[derive(Clone, Copy, Debug)]
pub struct TriangleLanes<R> {
    /// First vertices.
    pub v0: Vector3<R>,
    /// v₁ − v₀.
    pub e1: Vector3<R>,
    /// v₂ − v₀.
    pub e2: Vector3<R>,
}

impl<R: Real> TriangleLanes<R> {
    /// Eight rays, eight triangles, or eight of each: (hit, t, u, v) of the lanes in `active`.
    #[inline]
    pub fn intersect(&self, ray: &RayLanes<R>, active: R::Mask) -> (R::Mask, R, R, R) {
        let zero = R::zero();
        let p = ray.dir.cross(self.e2);
        let det = self.e1.dot(p);
        let inverse = R::one() / det;
        let s = ray.org - self.v0;
        let u = s.dot(p) * inverse;
        let q = s.cross(self.e1);
        let v = ray.dir.dot(q) * inverse;
        let t = self.e2.dot(q) * inverse;
        // det = 0 gives an infinite or NaN inverse: u or v fails its comparison, or both numerators are
        // zero too and the products are NaN.
        let inside = u.ge(zero) & v.ge(zero) & (u + v).le(R::one()) & active & !det.equal(zero);
        if inside.none() {
            return (inside, t, u, v);
        }
        let (v1, v2) = (self.v0 + self.e1, self.v0 + self.e2);
        let bounds = (self.v0.min(v1).min(v2), self.v0.max(v1).max(v2));
        let all = (R::splat(f32::NEG_INFINITY), R::splat(f32::INFINITY));
        let (low, high) = aabb::interval(bounds, (ray.org, ray.rdir), all);
        let t = high.min(low.max(t));
        (inside & low.le(high) & ray.t_near.lt(t) & t.le(ray.t_far), t, u, v)
    }
}

#[cfg(test)]
mod tests;
