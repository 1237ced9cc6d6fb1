//! Boxes as the builder computes with them.

use glam::{Vec3A, Vec3Swizzles, Vec4};

use crate::geometry::Aabb;
use crate::simd::{Mask, Real, f32x8, transpose, u32x8};

/// A box in one register: −min and max, so that a union is one instruction, and after each a lane to spare.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds(pub(super) f32x8);

impl Bounds {
    /// That of an absent child, too.
    pub(super) const EMPTY: Self = Self(f32x8::new([f32::NEG_INFINITY; 8]));

    /// What a row of a reference or a node has in its lanes, but for what is in those to spare: as floats, numbers may
    /// be so small that arithmetic gets slow. By lanes: taken apart, rows would be read and moved in parts.
    #[inline]
    pub(super) fn of_row(row: u32x8) -> Self {
        let corners = Mask::from_bitmask(0b0111_0111);
        Self(f32x8::select(corners, f32x8::from_bits(row), Self::EMPTY.0))
    }

    /// A row with words in the lanes to spare.
    #[inline]
    pub(super) fn row(self, words: [u32; 2]) -> [u32; 8] {
        let [x0, y0, z0, _, x1, y1, z1, _] = self.0.to_bits().to_array();
        [x0, y0, z0, words[0], x1, y1, z1, words[1]]
    }

    /// The box of its centre ([`Bounds::centre`]) alone.
    #[inline]
    pub(super) fn shrunk(self) -> Self {
        Self(self.0 - f32x8::of_halves(self.0.half(1), self.0.half(0)))
    }

    #[inline]
    fn half(self, i: usize) -> Vec3A {
        Vec3A::from_vec4(Vec4::from_array(self.0.half(i)))
    }

    #[inline]
    pub(super) fn min(self) -> Vec3A {
        -self.half(0)
    }

    #[inline]
    pub(super) fn max(self) -> Vec3A {
        self.half(1)
    }

    #[inline]
    pub(super) fn union(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    /// The union if there is one to be made, without a branch.
    #[inline]
    pub(super) fn union_if(self, other: Self, does: bool) -> Self {
        Self(f32x8::select(Mask::splat(does), self.0.max(other.0), self.0))
    }

    /// Half of the surface area, 0 for the empty box.
    #[inline]
    pub(super) fn half_area(self) -> f32 {
        let d = (self.max() - self.min()).max(Vec3A::ZERO);
        let faces = d * d.yzx();
        faces.x + faces.y + faces.z
    }

    /// The same of eight boxes, to the bit.
    #[inline]
    pub(super) fn half_areas(boxes: &[Self; 8]) -> f32x8 {
        let [x0, y0, z0, _, x1, y1, z1, _] = transpose(boxes.map(|bounds| bounds.0));
        let zero = f32x8::zero();
        let [dx, dy, dz] = [(x1 + x0).max(zero), (y1 + y0).max(zero), (z1 + z0).max(zero)];
        dx * dy + dy * dz + dz * dx
    }

    /// Eight boxes as a [`Node`](crate::bvh::Node) has them.
    #[inline]
    pub(super) fn columns(boxes: [Self; 8]) -> [[[f32; 8]; 2]; 3] {
        let [x0, y0, z0, _, x1, y1, z1, _] = transpose(boxes.map(|bounds| bounds.0));
        [[-x0, x1], [-y0, y1], [-z0, z1]].map(|sides| sides.map(f32x8::to_array))
    }

    /// Twice the middle: order and ratios are the same, and it costs one instruction.
    #[inline]
    pub(super) fn centre(self) -> Vec3A {
        self.max() - self.half(0)
    }

    pub(super) fn aabb(self) -> Aabb {
        Aabb { min: self.min().into(), max: self.max().into() }
    }
}

impl From<Aabb> for Bounds {
    #[inline]
    fn from(aabb: Aabb) -> Self {
        Self(f32x8::of_halves((-aabb.min).extend(0.0).to_array(), aabb.max.extend(0.0).to_array()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{Child, Node};
    use glam::vec3;

    #[test]
    fn eight_half_areas_are_each_ones() {
        let mut boxes = [Bounds::EMPTY; 8];
        for (i, place) in boxes.iter_mut().enumerate().skip(1) {
            // Sums of these products depend on their order.
            let scale = [0.0, 1.0, 1e-3, 1e17][i % 4];
            let size = vec3(0.1, 1.0 / 3.0, 0.7) * scale + vec3(0.37, 1.9, 0.77) * i as f32;
            *place = Aabb { min: vec3(-1.0, 0.5, 3.0), max: vec3(-1.0, 0.5, 3.0) + size }.into();
        }
        let one_by_one = boxes.map(|bounds| bounds.half_area().to_bits());
        assert_eq!(Bounds::half_areas(&boxes).to_array().map(f32::to_bits), one_by_one);
        assert_eq!(one_by_one[0], 0);
    }

    #[test]
    fn columns_are_what_a_node_has_that_is_filled_box_by_box() {
        let mut node = Node::EMPTY;
        let mut boxes = [Bounds::EMPTY; 8];
        for (place, bounds) in boxes.iter_mut().enumerate().take(5) {
            let min = vec3(0.0, -0.0, 0.5) * place as f32;
            let aabb = Aabb { min, max: min + vec3(0.0, 1.0, 2.0) };
            *bounds = aabb.into();
            node.set(place, aabb, Child::leaf(0, 1));
        }
        let bits = |bounds: [[[f32; 8]; 2]; 3]| bounds.map(|sides| sides.map(|row| row.map(f32::to_bits)));
        assert_eq!(bits(Bounds::columns(boxes)), bits(node.bounds));
    }

    #[test]
    fn a_row_keeps_the_box_and_a_shrunk_one_is_its_centre() {
        let aabb = Aabb { min: vec3(-1.0, 0.5, 3.0), max: vec3(2.0, 0.5, 7.0) };
        let row = Bounds::from(aabb).row([7, 0x7fc0_0001]);
        assert_eq!((row[3], row[7]), (7, 0x7fc0_0001));
        let bounds = Bounds::of_row(u32x8::new(row));
        assert_eq!(bounds.aabb(), aabb);
        let shrunk = bounds.shrunk();
        assert_eq!((shrunk.min(), shrunk.max()), (bounds.centre(), bounds.centre()));
        assert_eq!(bounds.centre(), Vec3A::new(1.0, 1.0, 10.0));
    }
}
