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

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3, Vec3};

    use super::*;
    use crate::geometry::Ray;

    /// Twice as large, at (10, 0, 0): a cube from 8 to 12.
    fn placed() -> Placement {
        let to_world =
            DAffine3::from_scale_rotation_translation(DVec3::splat(2.0), Default::default(), DVec3::X * 10.0);
        let bounds = Aabb { min: Vec3::new(8.0, -2.0, -2.0), max: Vec3::new(12.0, 2.0, 2.0) };
        Placement { to_group: (&to_world.inverse()).into(), to_world: (&to_world).into(), bounds }
    }

    fn enter(org: [f32; 3], dir: [f32; 3], ends: [f32; 2]) -> Option<Entered<f32>> {
        let ray = Ray::new(org.into(), dir.into(), ends[0], ends[1]);
        placed().enter(&RayLanes::splat(&ray), true)
    }

    #[test]
    fn a_ray_enters_within_its_range_and_keeps_its_t() {
        let inside = [0.0, 1.0, 1.0];
        let entered = enter(inside, [2.0, 0.0, 0.0], [1.0, 5.0]).expect("from 4 on");
        assert!(entered.lanes);
        assert_eq!(Vec3::from(entered.ray.org), Vec3::new(-5.0, 0.5, 0.5));
        assert_eq!(Vec3::from(entered.ray.dir), Vec3::X);
        // Its end is inside: behind it nothing has to be looked for. Another is behind the box, and says nothing.
        assert_eq!((entered.ray.t_near, entered.ray.t_far), (1.0, 5.0));
        assert_eq!(enter(inside, [2.0, 0.0, 0.0], [1.0, 7.0]).expect("through").ray.t_far, f32::INFINITY);
        let clamped = [3.0, 4.0, 5.0, 7.0].map(|t| entered.clamp(t));
        assert_eq!([clamped[0], clamped[1], clamped[2]], [4.0, 4.0, 5.0]);
        assert!((6.0..6.0001).contains(&clamped[3]), "{clamped:?}");
        // It ends before the box, begins behind it, passes beside it.
        assert!(enter(inside, [2.0, 0.0, 0.0], [0.0, 3.9]).is_none());
        assert!(enter(inside, [2.0, 0.0, 0.0], [6.1, 9.0]).is_none());
        assert!(enter([0.0, 3.0, 0.0], [2.0, 0.0, 0.0], [0.0, 9.0]).is_none());
        let ray = Ray::new(inside.into(), Vec3::X, 0.0, 99.0);
        assert!(placed().enter::<f32>(&RayLanes::splat(&ray), false).is_none());
    }

    #[test]
    fn a_ray_that_the_groups_space_is_too_small_for_finds_nothing() {
        let mut tiny = placed();
        tiny.to_group.rows = tiny.to_group.rows.map(|row| row * 1e30);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            // The origin overflows, or the direction.
            for (org, dir) in [(Vec3::X * 10.0 - axis * 1e10, axis), (Vec3::X * 10.0 - axis, axis * 1e20)] {
                let ray = Ray::new(org, dir, 0.0, f32::INFINITY);
                let entered = tiny.enter::<f32>(&RayLanes::splat(&ray), true);
                assert!(entered.is_none_or(|entered| !entered.lanes), "{ray:?}");
            }
        }
    }
}
