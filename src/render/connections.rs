//! Shadow rays, and the light that each brings if nothing blocks it.

use bumpalo::{Bump, collections::Vec as BumpVec};

use super::rows::{Octants, Rows, gather, reserve};
use crate::geometry::RayLanes;
use crate::simd::{LANES, Real, Vec3x8, compress, f32x8, transpose, u32x8, vector3};

/// Rows in the order in which the rays were asked for.
pub(super) struct Connections<'a> {
    /// Origin, direction, end; slot of the vertex.
    rays: Rows<'a>,
    /// Red, green and blue, and nothing.
    light: BumpVec<'a, [f32; 4]>,
    /// In which order they are traced.
    octants: Octants<'a>,
    pub(super) len: usize,
}

impl<'a> Connections<'a> {
    pub(super) fn new(arena: &'a Bump) -> Self {
        Self {
            rays: BumpVec::new_in(arena),
            light: BumpVec::new_in(arena),
            octants: Octants::new(arena),
            len: 0,
        }
    }

    /// None, and room for so many.
    pub(super) fn clear(&mut self, most: usize) {
        self.len = 0;
        // A packet is written whole, wherever it begins.
        reserve(&mut self.rays, most + LANES, f32x8::zero());
        reserve(&mut self.light, most + LANES, [0.0; 4]);
    }

    /// Appends the `lanes` of a packet.
    #[inline]
    pub(super) fn push(
        &mut self,
        lanes: u32,
        (org, dir, t_far): (Vec3x8, Vec3x8, f32x8),
        radiance: Vec3x8,
        slots: u32x8,
    ) {
        let Self { rays, light, len, .. } = self;
        let chosen = |values: f32x8| f32x8::from_bits(compress(values.to_bits(), lanes as u8));
        let slots = f32x8::from_bits(slots);
        let rows = transpose([org.x, org.y, org.z, dir.x, dir.y, dir.z, t_far, slots].map(chosen));
        rays[*len..*len + LANES].copy_from_slice(&rows);
        let (zero, [r, g, b]) = (f32x8::zero(), [radiance.x, radiance.y, radiance.z].map(chosen));
        let rows = transpose([r, g, b, zero, zero, zero, zero, zero]);
        for (light, row) in light[*len..*len + LANES].iter_mut().zip(rows) {
            let [r, g, b, nothing, ..] = row.to_array();
            *light = [r, g, b, nothing];
        }
        *len += lanes.count_ones() as usize;
    }

    /// No more rays are asked for: those into one octant are traced together, whichever light they go to.
    pub(super) fn order_by_octant(&mut self) {
        self.octants.sort(self.rays[..self.len].iter());
    }

    /// The packet that starts at a place in the order.
    #[inline]
    pub(super) fn rays(&self, first: usize) -> RayLanes<f32x8> {
        let numbers: [u32; LANES] = self.octants.order()[first..].first_chunk().copied().unwrap_or_default();
        let [ox, oy, oz, dx, dy, dz, t_far, _] = gather(&self.rays, &numbers);
        RayLanes::new(vector3(ox, oy, oz), vector3(dx, dy, dz), f32x8::zero(), t_far)
    }

    /// What the ray at a place in the order would have brought is nothing.
    #[inline]
    pub(super) fn block(&mut self, place: usize) {
        self.light[self.octants.order()[place] as usize] = [0.0; 4];
    }

    /// Slots and light, each slot's rays in the order in which they were asked for.
    #[inline]
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, &[f32; 4])> {
        let slot = |row: &f32x8| row.lane(7).to_bits() as usize;
        self.rays[..self.len].iter().map(slot).zip(&self.light)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::Bits;

    #[test]
    fn light_arrives_at_its_vertex_unless_it_is_blocked() {
        let arena = Bump::new();
        let mut connections = Connections::new(&arena);
        connections.clear(16);
        let numbers = f32x8::from_fn(|i| i as f32);
        let light = |scale: f32| vector3(numbers, numbers, numbers).scale(f32x8::splat(scale));
        let zero = Vec3x8::zero();
        connections.push(0b1010_0100, (zero, light(-1.0), numbers), light(1.0), u32x8::splat(3));
        connections.push(0b0000_0001, (zero, light(2.0), numbers), light(10.0), u32x8::splat(8));
        connections.push(0b0000_0110, (zero, light(2.0), numbers), light(10.0), u32x8::splat(3));
        assert_eq!(connections.len, 6);
        connections.order_by_octant();
        // The first three point into another octant, and are traced last.
        let rays = connections.rays(0);
        // Lanes behind the last hold it, too.
        assert_eq!(rays.t_far.to_array(), [0.0, 1.0, 2.0, 2.0, 5.0, 7.0, 7.0, 7.0]);
        assert_eq!((rays.dir.lane(2), rays.dir.lane(5)), (glam::Vec3::splat(4.0), glam::Vec3::splat(-7.0)));
        connections.block(2);
        connections.block(4);
        let arrived: Vec<_> = connections.iter().map(|(slot, light)| (slot, light[2])).collect();
        assert_eq!(arrived, [(3, 2.0), (3, 0.0), (3, 7.0), (8, 0.0), (3, 10.0), (3, 0.0)]);
        assert!(connections.iter().all(|(_, light)| light[..3] == [light[0]; 3] && light[3] == 0.0));
    }
}
