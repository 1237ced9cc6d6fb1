//! Axis-aligned boxes and the slab test.
//!
//! Per axis, the ray is between the two planes for t in [(near − org)·rdir, (far − org)·rdir], where
//! *near* is the plane that the direction meets first \[Ize13\]. Rounded subtraction and multiplication are
//! monotone, so a larger box never has a smaller computed interval. An axis that gives NaN (the origin
//! in a plane and the direction along it) does not constrain. The upper end is widened by two ulps,
//! against the rounding of both operations, so a box that the ray touches is never missed.

use glam::Vec3;

use super::Ray;
use crate::simd::{Real, Vector3};

/// A closed box along the axes of the world, or of a group's space; [`Aabb::EMPTY`] holds nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least coordinates.
    pub min: Vec3,
    /// Greatest coordinates.
    pub max: Vec3,
}

/// 1 + 4·2⁻²⁴·2: the factor on the upper end of an interval.
pub const WIDEN: f32 = 1.0 + 4.0 * f32::EPSILON;

impl Aabb {
    /// The identity of [`Aabb::union`]; no ray meets it.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box with these points.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The smallest box around both.
    #[inline]
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Half of the surface area, 0 for the empty box.
    #[inline]
    pub fn half_area(self) -> f32 {
        let d = (self.max - self.min).max(Vec3::ZERO);
        d.x * (d.y + d.z) + d.y * d.z
    }

    /// The middle, without overflow.
    #[inline]
    pub fn centre(self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// Is any part of `other` in this box?
    #[inline]
    pub fn contains(self, other: Self) -> bool {
        self.min.cmple(other.min).all() && self.max.cmpge(other.max).all()
    }

    /// The interval of t within all three slabs, met with the ray's own; empty if low > high.
    #[inline]
    pub fn interval(&self, ray: &Ray) -> (f32, f32) {
        let negative = ray.rdir.cmplt(Vec3::ZERO);
        let near = (Vec3::select(negative, self.max, self.min) - ray.org) * ray.rdir;
        let far = (Vec3::select(negative, self.min, self.max) - ray.org) * ray.rdir;
        let (mut low, mut high) = (ray.t_near, ray.t_far);
        for axis in 0..3 {
            low = Real::max(near[axis], low);
            high = Real::min(far[axis] * WIDEN, high);
        }
        (low, high)
    }
}

/// The same for lanes of boxes and rays: (low, high) of each lane, empty where low > high.
#[inline]
pub fn interval<R: Real>(
    (min, max): (Vector3<R>, Vector3<R>),
    (org, rdir): (Vector3<R>, Vector3<R>),
    (t_near, t_far): (R, R),
) -> (R, R) {
    let axis = |min: R, max: R, org: R, rdir: R| {
        let negative = rdir.lt(R::zero());
        let (near, far) = (R::select(negative, max, min), R::select(negative, min, max));
        ((near - org) * rdir, (far - org) * rdir * R::splat(WIDEN))
    };
    let (x0, x1) = axis(min.x, max.x, org.x, rdir.x);
    let (y0, y1) = axis(min.y, max.y, org.y, rdir.y);
    let (z0, z1) = axis(min.z, max.z, org.z, rdir.z);
    (z0.max(y0.max(x0.max(t_near))), z1.min(y1.min(x1.min(t_far))))
}

/// The t within all three slabs of boxes, by distances from the rays' common origin to the planes that are met first
/// along each axis, and last: [`interval`] where all signs are known.
#[inline]
pub fn within_slabs<R: Real>(near: Vector3<R>, far: Vector3<R>, rdir: Vector3<R>) -> (R, R) {
    let (near, far) = (near * rdir, (far * rdir).scale(R::splat(WIDEN)));
    let low = near.z.max(near.y.max(near.x.max(R::splat(f32::NEG_INFINITY))));
    (low, far.z.min(far.y.min(far.x.min(R::splat(f32::INFINITY)))))
}

#[cfg(test)]
mod tests;
