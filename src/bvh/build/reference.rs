//! What the builder sees of a primitive: a box, a number, a class.

use glam::{Vec3A, Vec3Swizzles, Vec4, Vec4Swizzles};
use rayon::prelude::*;

use crate::geometry::Aabb;
use crate::simd::{Mask, Real, f32x8};

/// A primitive, as the builder sees it: 32 bytes, half a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Reference {
    /// Its box; no coordinate beyond half of the greatest float.
    pub bounds: Aabb,
    /// Its number, handed back in [`Bvh::slots`](crate::bvh::Bvh::slots).
    pub index: u32,
    /// Leaves hold references of one class.
    pub class: u8,
}

impl Reference {
    /// The box in a register: two loads of what stands side by side in memory, a coordinate too many.
    #[inline]
    pub(super) fn bounds(&self) -> Bounds {
        let Aabb { min, max } = self.bounds;
        let low = Vec4::new(min.x, min.y, min.z, max.x);
        let high = Vec4::new(min.z, max.x, max.y, max.z).yzww();
        Bounds::halves(-low, high)
    }

    /// Twice the middle of the box along an axis: what [`Bounds::centre`] has there, to the bit.
    #[inline]
    pub(super) fn centre(&self, axis: usize) -> f32 {
        self.bounds.min[axis] + self.bounds.max[axis]
    }
}

/// What is left of references when their boxes are in a tree, in leaf order: 5 bytes each.
#[derive(Default)]
pub(super) struct Names {
    pub(super) indices: Vec<u32>,
    pub(super) classes: Vec<u8>,
}

impl Names {
    /// Gives the boxes' memory back.
    pub(super) fn new(references: Vec<Reference>) -> Self {
        let mut names = Self::default();
        let both = references.par_iter().map(|reference| (reference.index, reference.class));
        both.unzip_into_vecs(&mut names.indices, &mut names.classes);
        names
    }
}

/// A box in one register: −min and max, a lane to spare after each. A union is one instruction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds(f32x8);

impl Bounds {
    pub(super) const EMPTY: Self = Self(f32x8::new([f32::NEG_INFINITY; 8]));

    #[inline]
    fn halves(low: Vec4, high: Vec4) -> Self {
        let ([a, b, c, d], [e, f, g, h]) = (low.to_array(), high.to_array());
        Self(f32x8::new([a, b, c, d, e, f, g, h]))
    }

    /// The box of a point.
    #[inline]
    pub(super) fn point(p: Vec3A) -> Self {
        Self::halves((-p).extend(0.0), p.extend(0.0))
    }

    #[inline]
    pub(super) fn min(self) -> Vec3A {
        let [x, y, z, ..] = self.0.to_array();
        -Vec3A::new(x, y, z)
    }

    #[inline]
    pub(super) fn max(self) -> Vec3A {
        let [.., x, y, z, _] = self.0.to_array();
        Vec3A::new(x, y, z)
    }

    #[inline]
    pub(super) fn union(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    /// The empty box instead, without a branch.
    #[inline]
    pub(super) fn or_empty(self, empty: bool) -> Self {
        Self(f32x8::select(Mask::splat(empty), Self::EMPTY.0, self.0))
    }

    /// Half of the surface area, 0 for the empty box.
    #[inline]
    pub(super) fn half_area(self) -> f32 {
        let d = (self.max() - self.min()).max(Vec3A::ZERO);
        let faces = d * d.yzx();
        faces.x + faces.y + faces.z
    }

    /// Twice the middle: order and ratios are the same, and it costs one instruction.
    #[inline]
    pub(super) fn centre(self) -> Vec3A {
        self.min() + self.max()
    }

    pub(super) fn aabb(self) -> Aabb {
        Aabb { min: self.min().into(), max: self.max().into() }
    }
}

impl From<Aabb> for Bounds {
    #[inline]
    fn from(aabb: Aabb) -> Self {
        Self::halves((-aabb.min).extend(0.0), aabb.max.extend(0.0))
    }
}
