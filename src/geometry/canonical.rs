//! Ray against disk and cylinder: canonical surfaces under an affine map.
//!
//! The ray is taken to the surface's own space, where t is the same: o' = M org + m, d' = M dir.
//! The **disk** is x² + y² ≤ 1, z = 0: t = −o'_z / d'_z. The **cylinder** is x² + y² = 1, 0 ≤ z ≤ 1,
//! without caps, hit from both sides: the roots of the quadratic in xy, nearest first.

use super::{Aabb, Affine, AffineLanes, Ray, RayLanes, aabb};
use crate::simd::{Mask, Real, Vector3};

/// Which surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CanonicalKind {
    /// x² + y² ≤ 1, z = 0.
    Disk,
    /// x² + y² = 1, 0 ≤ z ≤ 1.
    Cylinder,
}

/// A disk or a cylinder in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Canonical {
    /// Which surface.
    pub kind: CanonicalKind,
    /// World → canonical.
    pub to_canonical: Affine,
    /// The box that decides hits, world space.
    pub bounds: Aabb,
}

impl Canonical {
    /// A world point in canonical space.
    #[inline]
    pub fn to_canonical<R: Real>(&self, p: Vector3<R>) -> Vector3<R> {
        AffineLanes::splat(&self.to_canonical).point(p)
    }

    /// One ray or eight: (hit, t) of the lanes in `active`.
    #[inline]
    pub fn intersect<R: Real>(&self, ray: &RayLanes<R>, active: R::Mask) -> (R::Mask, R) {
        let to_canonical = AffineLanes::splat(&self.to_canonical);
        let (o, d) = (to_canonical.point(ray.org), to_canonical.direction(ray.dir));
        let bounds = (Vector3::splat(self.bounds.min), Vector3::splat(self.bounds.max));
        let all = (R::splat(f32::NEG_INFINITY), R::splat(f32::INFINITY));
        let (low, high) = aabb::interval(bounds, (ray.org, ray.rdir), all);
        let active = active & low.le(high);
        let in_range = |t: R| ray.t_near.lt(t) & t.le(ray.t_far);
        let clamp = |t: R| high.min(low.max(t));
        match self.kind {
            CanonicalKind::Disk => {
                let t = -o.z / d.z;
                let (x, y) = (o.x + t * d.x, o.y + t * d.y);
                let inside = (x * x + y * y).le(R::one());
                let t = clamp(t);
                (inside & active & in_range(t), t)
            }
            CanonicalKind::Cylinder => {
                let a = d.x * d.x + d.y * d.y;
                let b = -(o.x * d.x + o.y * d.y);
                let (nx, ny) = (o.x + d.x * (b / a), o.y + d.y * (b / a));
                let discriminant = R::one() - (nx * nx + ny * ny);
                let touches = discriminant.ge(R::zero()) & active;
                let root = (a * discriminant).sqrt();
                let q = R::select(b.lt(R::zero()), b - root, b + root);
                let (t0, t1) = ((o.x * o.x + o.y * o.y - R::one()) / q, q / a);
                let hit = |t: R| {
                    let z = o.z + t * d.z;
                    let clamped = clamp(t);
                    (z.ge(R::zero()) & z.le(R::one()) & in_range(clamped), clamped)
                };
                let ((near, first), (far, second)) = (hit(t0.min(t1)), hit(t0.max(t1)));
                (touches & (near | far), R::select(near, first, second))
            }
        }
    }

    /// One ray: the nearest t in the ray's range.
    #[inline]
    pub fn intersect_ray(&self, ray: &Ray) -> Option<f32> {
        let (hit, t) = self.intersect::<f32>(&RayLanes::splat(ray), true);
        hit.any().then_some(t)
    }
}

#[cfg(test)]
mod tests;
