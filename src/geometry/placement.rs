//! Where a group of surfaces stands: a ray is taken to the group's own space, and what it hits there back.
//!
//! With o' = M o + m and d' = M d, M the inverse of where the group stands, o' + t·d' is the image of
//! o + t·d: **t is the same**, as long as d' is left at the length it has. What the group's own tree finds at
//! t is a hit of the instance if t, clamped, is in the slabs of the instance's box and in the ray's range, as
//! for every surface (see [`geometry`](super)).
//!
//! The clamp never changes what is nearest, since it is monotone; so the nearest hit of the group is all that
//! has to be known. Its tree may be left at the ray's end, if that is within the box. If the end is beyond it,
//! whatever the ray hits is clamped to something within reach, and the tree is searched without an end.

use super::{Aabb, Affine, AffineLanes, RayLanes, aabb};
use crate::simd::{Mask, Real, Vector3};

/// Where a group stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// World → group.
    pub to_group: Affine,
    /// Group → world.
    pub to_world: Affine,
    /// The box that decides hits, world space: all of the group is inside, however its corners rounded.
    pub bounds: Aabb,
}

/// Rays that enter an instance's box, in the group's space.
#[derive(Clone, Copy, Debug)]
pub struct Entered<R: Real> {
    /// `t_near` is the ray's; `t_far` as far as hits have to be looked for.
    pub ray: RayLanes<R>,
    /// Which of them enter.
    pub lanes: R::Mask,
    low: R,
    high: R,
}

impl Placement {
    /// The rays in `active` that enter the box within their range; `None` if none does. A ray that the
    /// group's space is too small for, so that a coordinate overflows, does not.
    #[inline]
    pub fn enter<R: Real>(&self, ray: &RayLanes<R>, active: R::Mask) -> Option<Entered<R>> {
        let bounds = (Vector3::splat(self.bounds.min), Vector3::splat(self.bounds.max));
        let all = (R::splat(f32::NEG_INFINITY), R::splat(f32::INFINITY));
        let (low, high) = aabb::interval(bounds, (ray.org, ray.rdir), all);
        let lanes = active & low.le(high) & ray.t_near.lt(high) & low.le(ray.t_far);
        if lanes.none() {
            return None;
        }
        let to_group = AffineLanes::splat(&self.to_group);
        let (org, dir) = (to_group.point(ray.org), to_group.direction(ray.dir));
        let sum = |v: Vector3<R>| v.x + v.y + v.z;
        let finite = (sum(org.abs()) + sum(dir.abs())).lt(R::splat(f32::INFINITY));
        let t_far = R::select(high.le(ray.t_far), R::splat(f32::INFINITY), ray.t_far);
        Some(Entered { ray: RayLanes::new(org, dir, ray.t_near, t_far), lanes: lanes & finite, low, high })
    }
}

impl<R: Real> Entered<R> {
    /// The t of a hit within the group as that of the instance.
    #[inline]
    pub fn clamp(&self, t: R) -> R {
        self.high.min(self.low.max(t))
    }
}
