//! Rays and hits.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::triangle;
use crate::simd::{Eights, Real, Vector3, f32x8, f32x16, vector3};

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
    /// Bound on the rounding in tests of triangles, for each unit of their size: see
    /// [`Aspect::margin`](super::Aspect::margin).
    pub margin: R,
}

/// A packet of eight rays.
pub type Rayx8 = RayLanes<f32x8>;

/// Two packets side by side.
pub type Rayx16 = RayLanes<f32x16>;

impl<R: Real> RayLanes<R> {
    /// Rays with their reciprocal directions.
    #[inline]
    pub fn new(org: Vector3<R>, dir: Vector3<R>, t_near: R, t_far: R) -> Self {
        Self { org, dir, rdir: dir.map(|d| R::one() / d), t_near, t_far, margin: triangle::rounding(dir) }
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
            margin: triangle::rounding(Vector3::splat(ray.dir)),
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

impl Rayx16 {
    /// Lanes 4i to 4i + 3 become the lower or the upper half of a packet.
    #[inline(always)]
    pub fn put_quarter(&mut self, i: usize, rays: &Rayx8, half: usize) {
        let put = |to: &mut Vector3<f32x16>, from: &Vector3<f32x8>| {
            to.x.put_quarter(i, from.x.half(half));
            to.y.put_quarter(i, from.y.half(half));
            to.z.put_quarter(i, from.z.half(half));
        };
        put(&mut self.org, &rays.org);
        put(&mut self.dir, &rays.dir);
        put(&mut self.rdir, &rays.rdir);
        self.t_near.put_quarter(i, rays.t_near.half(half));
        self.t_far.put_quarter(i, rays.t_far.half(half));
        self.margin.put_quarter(i, rays.margin.half(half));
    }
}

impl<R: Eights> RayLanes<R> {
    /// Lanes 8i to 8i + 7.
    #[inline(always)]
    pub fn eight(&self, i: usize) -> Rayx8 {
        let of = |v: &Vector3<R>| vector3(v.x.eight(i), v.y.eight(i), v.z.eight(i));
        RayLanes {
            org: of(&self.org),
            dir: of(&self.dir),
            rdir: of(&self.rdir),
            t_near: self.t_near.eight(i),
            t_far: self.t_far.eight(i),
            margin: self.margin.eight(i),
        }
    }
}

/// Which primitive of the scene, in the order of the description: those of its shapes, then its instances, one
/// number each. The order decides ties.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Pod, Zeroable)]
#[repr(transparent)]
pub struct PrimitiveId(pub u32);

impl PrimitiveId {
    /// No primitive: the ray left the scene.
    pub const NONE: Self = Self(u32::MAX);
}

/// Where a ray met a primitive.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
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

    /// From (t, u, v, the primitive's number as bits): what four stores would be is one.
    #[inline]
    pub fn of_row(row: [f32; 4]) -> Self {
        bytemuck::must_cast(row)
    }

    /// (t, u, v, the primitive's number as bits).
    #[inline]
    pub fn to_row(self) -> [f32; 4] {
        bytemuck::must_cast(self)
    }

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
