//! Rays and hits.

use glam::Vec3;

use super::triangle;
use crate::simd::{Real, Vector3, f32x8};

/// A half-open segment org + t·dir, t in (`t_near`, `t_far`], in the space of what it is traced through: the
/// world, or a group's. `dir` need not be of unit length.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin.
    pub org: Vec3,
    /// Direction; finite, not zero.
    pub dir: Vec3,
    /// 1/dir, ±∞ where a component is ±0.
    pub rdir: Vec3,
    /// Excluded lower end, in units of `dir`.
    pub t_near: f32,
    /// Included upper end, in units of `dir`.
    pub t_far: f32,
}

impl Ray {
    /// A ray with its reciprocal direction.
    #[inline]
    pub fn new(org: Vec3, dir: Vec3, t_near: f32, t_far: f32) -> Self {
        Self { org, dir, rdir: dir.recip(), t_near, t_far }
    }
}

/// Rays in lanes: as many as `R` has. [`Rayx8`] is a packet.
#[derive(Clone, Copy, Debug)]
pub struct RayLanes<R> {
    /// Origins.
    pub org: Vector3<R>,
    /// Directions.
    pub dir: Vector3<R>,
    /// 1/dir.
    pub rdir: Vector3<R>,
    /// Excluded lower ends.
    pub t_near: R,
    /// Included upper ends.
    pub t_far: R,
    /// Bound on the rounding in tests of triangles, for each unit of their edges; see
    /// [`RayLanes::within`].
    pub margin: R,
}

/// A packet of eight rays.
pub type Rayx8 = RayLanes<f32x8>;

impl<R: Real> RayLanes<R> {
    /// Rays with their reciprocal directions.
    #[inline]
    pub fn new(org: Vector3<R>, dir: Vector3<R>, t_near: R, t_far: R) -> Self {
        let margin = R::splat(f32::INFINITY);
        Self { org, dir, rdir: dir.map(|d| R::one() / d), t_near, t_far, margin }
    }

    /// The same rays, among triangles whose coordinates are at most `reach` in magnitude. Without knowing
    /// that, every test is as careful as one next to an edge: the answer is the same, but takes longer.
    #[inline]
    #[must_use]
    pub fn within(&self, reach: Vec3) -> Self {
        Self { margin: triangle::margin_within(self.org, self.dir, reach), ..*self }
    }

    /// The same ray in every lane.
    #[inline]
    pub fn splat(ray: &Ray) -> Self {
        Self {
            org: Vector3::splat(ray.org),
            dir: Vector3::splat(ray.dir),
            rdir: Vector3::splat(ray.rdir),
            t_near: R::splat(ray.t_near),
            t_far: R::splat(ray.t_far),
            margin: R::splat(f32::INFINITY),
        }
    }

    /// The ray of a lane.
    #[inline]
    pub fn lane(&self, i: usize) -> Ray {
        Ray {
            org: self.org.lane(i),
            dir: self.dir.lane(i),
            rdir: self.rdir.lane(i),
            t_near: self.t_near.lane(i),
            t_far: self.t_far.lane(i),
        }
    }
}

/// Which primitive of the scene, in the order of the description: those of its shapes, then its instances, one
/// number each. The order decides ties.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PrimitiveId(pub u32);

impl PrimitiveId {
    /// No primitive: the ray left the scene.
    pub const NONE: Self = Self(u32::MAX);
}

/// Where a ray met a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray in units of its direction; +∞ for a miss.
    pub t: f32,
    /// Barycentric weight of the second vertex; 0 for curved surfaces. In an instance, the number of what was
    /// hit within its group, as bits.
    pub u: f32,
    /// Barycentric weight of the third vertex; 0 for curved surfaces and in instances.
    pub v: f32,
    /// What was hit.
    pub primitive: PrimitiveId,
}

impl Hit {
    /// Nothing.
    pub const MISS: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, primitive: PrimitiveId::NONE };

    /// Something, somewhere: the answer of an occlusion query.
    pub const BLOCKED: Self = Self { t: f32::NEG_INFINITY, ..Self::MISS };

    /// The order that makes the answer unique: nearest t, then lowest id.
    #[inline]
    pub fn closer_than(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.primitive < other.primitive)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_hits_is_strict() {
        let hit = |t, primitive| Hit { t, u: 0.5, v: 0.25, primitive: PrimitiveId(primitive) };
        let ordered = [hit(1.0, 7), hit(2.0, 3), hit(2.0, 4), hit(3.0, 0), Hit::MISS];
        for (i, a) in ordered.iter().enumerate() {
            for (j, b) in ordered.iter().enumerate() {
                assert_eq!(a.closer_than(b), i < j, "{a:?} {b:?}");
            }
        }
    }
}
