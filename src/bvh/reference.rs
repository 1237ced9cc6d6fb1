//! What the builder sees of a primitive: a box, a number, a class.

use glam::{Vec3A, Vec3Swizzles, Vec4, Vec4Swizzles};

use crate::geometry::Aabb;

/// A primitive, as the builder sees it: 32 bytes, half a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Reference {
    /// Its box; no coordinate beyond half of the greatest float.
    pub bounds: Aabb,
    /// Its number, handed back in [`Bvh::slots`](super::Bvh::slots).
    pub index: u32,
    /// Leaves hold references of one class.
    pub class: u8,
}

impl Reference {
    /// The box in two registers. Each is one load of what stands side by side in memory, a coordinate
    /// too many.
    #[inline]
    pub(super) fn bounds(&self) -> Bounds {
        let Aabb { min, max } = self.bounds;
        Bounds {
            min: Vec3A::from_vec4(Vec4::new(min.x, min.y, min.z, max.x)),
            max: Vec3A::from_vec4(Vec4::new(min.z, max.x, max.y, max.z).yzww()),
        }
    }

    /// Twice the middle of the box along an axis: what [`Bounds::centre`] has there, to the bit.
    #[inline]
    pub(super) fn centre(&self, axis: usize) -> f32 {
        self.bounds.min[axis] + self.bounds.max[axis]
    }
}

/// A box whose corners are registers: a union is two instructions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) min: Vec3A,
    pub(super) max: Vec3A,
}

impl Bounds {
    pub(super) const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    /// The box of a point.
    #[inline]
    pub(super) fn point(p: Vec3A) -> Self {
        Self { min: p, max: p }
    }

    #[inline]
    pub(super) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Half of the surface area, 0 for the empty box.
    #[inline]
    pub(super) fn half_area(self) -> f32 {
        let d = (self.max - self.min).max(Vec3A::ZERO);
        let faces = d * d.yzx();
        faces.x + faces.y + faces.z
    }

    /// Twice the middle: order and ratios are the same, and it costs one instruction.
    #[inline]
    pub(super) fn centre(self) -> Vec3A {
        self.min + self.max
    }

    pub(super) fn aabb(self) -> Aabb {
        Aabb { min: self.min.into(), max: self.max.into() }
    }
}

impl From<Aabb> for Bounds {
    #[inline]
    fn from(aabb: Aabb) -> Self {
        Self { min: aabb.min.into(), max: aabb.max.into() }
    }
}
