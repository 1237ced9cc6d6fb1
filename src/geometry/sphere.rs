//! Ray against sphere.
//!
//! With f = org − c: a t² − 2 b t + (f·f − r²) = 0, a = dir·dir, b = −f·dir. The discriminant is taken
//! from the distance of the centre to the line, r² − |f + (b/a) dir|², which does not cancel far away,
//! and the roots are q/a and (f·f − r²)/q with q = b + sign(b)·√(a·discriminant), which do not cancel
//! near the surface \[HGA19\].

use glam::Vec3;

use super::{Aabb, Ray, RayLanes, aabb};
use crate::simd::{Mask, Real, Vector3};

/// A sphere; hit from inside and outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre.
    pub center: Vec3,
    /// Radius, positive.
    pub radius: f32,
}

impl Sphere {
    /// The box that decides hits.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        Aabb { min: self.center - Vec3::splat(self.radius), max: self.center + Vec3::splat(self.radius) }
    }

    /// One ray: the nearest t in the ray's range.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<f32> {
        let f = ray.org - self.center;
        let a = ray.dir.dot(ray.dir);
        let b = -f.dot(ray.dir);
        let nearest = f + ray.dir * (b / a);
        let discriminant = self.radius * self.radius - nearest.dot(nearest);
        let touches = discriminant >= 0.0;
        if !touches {
            return None;
        }
        let root = (a * discriminant).sqrt();
        let q = if b < 0.0 { b - root } else { b + root };
        let (t0, t1) = ((f.dot(f) - self.radius * self.radius) / q, q / a);
        let (first, second) = (Real::min(t0, t1), Real::max(t0, t1));
        let (low, high) =
            self.bounds().interval(&Ray { t_near: f32::NEG_INFINITY, t_far: f32::INFINITY, ..*ray });
        let clamp = |t: f32| Real::min(high, Real::max(low, t));
        let in_range = |t: &f32| low <= high && ray.t_near < *t && *t <= ray.t_far;
        Some(clamp(first)).filter(in_range).or(Some(clamp(second)).filter(in_range))
    }
}

/// Spheres in lanes: eight of a block, or one in all of them.
#[derive(Clone, Copy, Debug)]
pub struct SphereLanes<R> {
    /// Centres.
    pub center: Vector3<R>,
    /// Radii.
    pub radius: R,
}

impl<R: Real> SphereLanes<R> {
    /// Eight rays, eight spheres, or eight of each: (hit, t) of the lanes in `active`.
    #[inline]
    pub fn intersect(&self, ray: &RayLanes<R>, active: R::Mask) -> (R::Mask, R) {
        let f = ray.org - self.center;
        let a = ray.dir.dot(ray.dir);
        let b = -f.dot(ray.dir);
        let nearest = f + ray.dir.scale(b / a);
        let discriminant = self.radius * self.radius - nearest.dot(nearest);
        let touches = discriminant.ge(R::zero()) & active;
        if touches.none() {
            return (touches, discriminant);
        }
        let root = (a * discriminant).sqrt();
        let q = R::select(b.lt(R::zero()), b - root, b + root);
        let (t0, t1) = ((f.dot(f) - self.radius * self.radius) / q, q / a);
        let (first, second) = (t0.min(t1), t0.max(t1));
        let extent = Vector3 { x: self.radius, y: self.radius, z: self.radius };
        let all = (R::splat(f32::NEG_INFINITY), R::splat(f32::INFINITY));
        let (low, high) =
            aabb::interval((self.center - extent, self.center + extent), (ray.org, ray.rdir), all);
        let (first, second) = (high.min(low.max(first)), high.min(low.max(second)));
        let in_range = |t: R| low.le(high) & ray.t_near.lt(t) & t.le(ray.t_far);
        let (near, far) = (in_range(first), in_range(second));
        (touches & (near | far), R::select(near, first, second))
    }
}

#[cfg(test)]
mod tests;
