//! Ray against triangle \[MT97\].
//!
//! With s = org − v₀, p = dir × e₂, q = s × e₁ and det = e₁·p, Cramer's rule on
//! org + t·dir = v₀ + u·e₁ + v·e₂ gives
//!
//! ```text
//! u = s·p / det     v = dir·q / det     t = e₂·q / det
//! ```
//!
//! A hit has u ≥ 0, v ≥ 0 and w = 1 − u − v ≥ 0: det and the numerators of all three have one sign. Unlike
//! the paper there is no culling and no epsilon, and t is clamped to the triangle's own slabs (see
//! [`geometry`](super)).
//!
//! Numerators are rounded by less than a margin that grows with the edges and the distance. Beyond it their
//! signs are certain. Within it two neighbours might both say that the ray is on the other's side of their
//! edge; there, and for hardly any ray, [`crossing`] decides, which can't.

use glam::Vec3;

use super::{Aabb, Ray, RayLanes, aabb, crossing::crossing};
use crate::simd::{Mask, Real, Vector3};

/// Bound on the rounding of a numerator, in units of |dir|·e·(|s| + e) with e = |e₁| + |e₂| and sums of
/// absolute components as lengths. Differences, two products and a sum in each of p and q, and three more
/// roundings on top: at most 8 ulps for u and v; w has the sum of three.
const ULPS: f32 = 16.0 * f32::EPSILON;
/// Against products that underflow.
const LEAST: f32 = 1e-34;

/// Three vertices: all that neighbours share to the bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// First vertex.
    pub v0: Vec3,
    /// Second vertex.
    pub v1: Vec3,
    /// Third vertex.
    pub v2: Vec3,
}

impl Triangle {
    /// From three vertices.
    #[inline]
    pub fn new(v0: Vec3, v1: Vec3, v2: Vec3) -> Self {
        Self { v0, v1, v2 }
    }

    /// v₁ − v₀.
    #[inline]
    pub fn e1(&self) -> Vec3 {
        self.v1 - self.v0
    }

    /// v₂ − v₀.
    #[inline]
    pub fn e2(&self) -> Vec3 {
        self.v2 - self.v0
    }

    /// |e₁| + |e₂| by sums of absolute components: kept beside the vertices, it is what the bound on rounding
    /// needs.
    #[inline]
    pub fn edges(&self) -> f32 {
        size(self.e1()) + size(self.e2())
    }

    /// The box that decides hits.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points([self.v0, self.v1, self.v2])
    }

    /// One ray: (t, u, v).
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<(f32, f32, f32)> {
        let (e1, e2) = (self.e1(), self.e2());
        let p = ray.dir.cross(e2);
        let det = e1.dot(p);
        let s = ray.org - self.v0;
        let u = s.dot(p);
        let q = s.cross(e1);
        let v = ray.dir.dot(q);
        let w = det - u - v;
        let least = Real::min(Real::min(u, v), w);
        let greatest = Real::max(Real::max(u, v), w);
        let inside = Real::max(least, -greatest);
        let edges = self.edges();
        let margin = size(ray.dir) * edges * (size(s) + edges) * ULPS + LEAST;
        let (t, u, v) = if inside > margin {
            let inverse = 1.0 / det;
            (e2.dot(q) * inverse, u * inverse, v * inverse)
        } else if inside >= -margin {
            crossing(ray.org, ray.dir, [self.v0, self.v1, self.v2])?
        } else {
            return None;
        };
        let (low, high) =
            self.bounds().interval(&Ray { t_near: f32::NEG_INFINITY, t_far: f32::INFINITY, ..*ray });
        let t = Real::min(high, Real::max(low, t));
        (low <= high && ray.t_near < t && t <= ray.t_far).then_some((t, u, v))
    }
}

/// |x| + |y| + |z|.
fn size(v: Vec3) -> f32 {
    let v = v.abs();
    v.x + v.y + v.z
}

/// Triangles in lanes: eight of a block, or one in all of them.
#[derive(Clone, Copy, Debug)]
pub struct TriangleLanes<R> {
    /// First vertices.
    pub v0: Vector3<R>,
    /// Second vertices.
    pub v1: Vector3<R>,
    /// Third vertices.
    pub v2: Vector3<R>,
    /// [`Triangle::edges`].
    pub edges: R,
}

impl<R: Real> TriangleLanes<R> {
    /// Eight rays, eight triangles, or eight of each: (hit, t, u, v) of the lanes in `active`.
    // Always: as a call, rays and triangles would go through memory.
    #[inline(always)]
    pub fn intersect(&self, ray: &RayLanes<R>, active: R::Mask) -> (R::Mask, R, R, R) {
        let (e1, e2) = (self.v1 - self.v0, self.v2 - self.v0);
        let p = ray.dir.cross(e2);
        let det = e1.dot(p);
        let s = ray.org - self.v0;
        let u = s.dot(p);
        let q = s.cross(e1);
        let v = ray.dir.dot(q);
        let w = det - u - v;
        let inside = u.min(v).min(w).max(-u.max(v).max(w));
        let margin = size_lanes(ray.dir) * self.edges * (size_lanes(s) + self.edges) * R::splat(ULPS)
            + R::splat(LEAST);
        let possible = (-margin).le(inside) & active;
        if possible.none() {
            return (possible, u, u, v);
        }
        let certain = margin.lt(inside);
        let inverse = R::one() / det;
        let mut found = (possible & certain, e2.dot(q) * inverse, u * inverse, v * inverse);
        let doubtful = possible & !certain;
        if doubtful.any() {
            // Copies, so that the originals need not be in memory for this.
            let (triangle, ray) = (*self, *ray);
            found = triangle.ask_again(&ray, doubtful, found);
        }
        let (hit, t, u, v) = found;
        let bounds = (self.v0.min(self.v1).min(self.v2), self.v0.max(self.v1).max(self.v2));
        let all = (R::splat(f32::NEG_INFINITY), R::splat(f32::INFINITY));
        let (low, high) = aabb::interval(bounds, (ray.org, ray.rdir), all);
        let t = high.min(low.max(t));
        (hit & low.le(high) & ray.t_near.lt(t) & t.le(ray.t_far), t, u, v)
    }

    /// Replaces the answers of some lanes by those of [`crossing`].
    #[cold]
    #[inline(never)]
    fn ask_again(
        &self,
        ray: &RayLanes<R>,
        lanes: R::Mask,
        (hit, t, u, v): (R::Mask, R, R, R),
    ) -> (R::Mask, R, R, R) {
        let (mut bits, lanes) = (hit.to_bitmask(), lanes.to_bitmask());
        let mut answers = [(0.0, 0.0, 0.0); 8];
        for (lane, answer) in answers.iter_mut().enumerate().take(R::LANES) {
            *answer = (t.lane(lane), u.lane(lane), v.lane(lane));
            if lanes >> lane & 1 != 0 {
                let vertices = [self.v0.lane(lane), self.v1.lane(lane), self.v2.lane(lane)];
                let crossed = crossing(ray.org.lane(lane), ray.dir.lane(lane), vertices);
                bits |= u32::from(crossed.is_some()) << lane;
                *answer = crossed.unwrap_or_default();
            }
        }
        let row = |of: fn(&(f32, f32, f32)) -> f32| R::from_fn(|lane| of(&answers[lane]));
        (R::Mask::from_bitmask(bits), row(|a| a.0), row(|a| a.1), row(|a| a.2))
    }
}

/// |x| + |y| + |z|.
#[inline]
fn size_lanes<R: Real>(v: Vector3<R>) -> R {
    let v = v.abs();
    v.x + v.y + v.z
}

#[cfg(test)]
mod tests;
