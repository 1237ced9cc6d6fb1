//! Shadow rays, and the light that each brings if nothing blocks it.

use bumpalo::{Bump, collections::Vec as BumpVec};

use super::rows::reserve;
use crate::geometry::RayLanes;
use crate::simd::{LANES, Real, Vec3x8, compress, f32x8, transpose, u32x8, vector3};

/// Columns in the order in which the rays were asked for.
pub(super) struct Connections<'a> {
    /// Origin, direction, end.
    rays: [BumpVec<'a, f32>; 7],
    /// Red, green and blue, and nothing.
    light: BumpVec<'a, [f32; 4]>,
    /// Slot of the vertex.
    slot: BumpVec<'a, u32>,
    pub(super) len: usize,
}

impl<'a> Connections<'a> {
    pub(super) fn new(arena: &'a Bump) -> Self {
        Self {
            rays: std::array::from_fn(|_| BumpVec::new_in(arena)),
            light: BumpVec::new_in(arena),
            slot: BumpVec::new_in(arena),
            len: 0,
        }
    }

    /// None, and room for so many.
    pub(super) fn clear(&mut self, most: usize) {
        self.len = 0;
        // A packet is written whole, wherever it begins.
        for column in &mut self.rays {
            reserve(column, most + LANES, 0.0);
        }
        reserve(&mut self.light, most + LANES, [0.0; 4]);
        reserve(&mut self.slot, most + LANES, 0);
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
        let lanes = lanes as u8;
        let Self { rays: [ox, oy, oz, dx, dy, dz, end], light, slot, len } = self;
        let chosen = |values: f32x8| f32x8::from_bits(compress(values.to_bits(), lanes));
        let append = |column: &mut [f32], values: f32x8| {
            column[*len..*len + LANES].copy_from_slice(&chosen(values).to_array());
        };
        append(ox, org.x);
        append(oy, org.y);
        append(oz, org.z);
        append(dx, dir.x);
        append(dy, dir.y);
        append(dz, dir.z);
        append(end, t_far);
        let (zero, [r, g, b]) = (f32x8::zero(), [radiance.x, radiance.y, radiance.z].map(chosen));
        let rows = transpose([r, g, b, zero, zero, zero, zero, zero]);
        for (light, row) in light[*len..*len + LANES].iter_mut().zip(rows) {
            let [r, g, b, nothing, ..] = row.to_array();
            *light = [r, g, b, nothing];
        }
        slot[*len..*len + LANES].copy_from_slice(&compress(slots, lanes).to_array());
        *len += lanes.count_ones() as usize;
    }

    /// The packet that starts at a ray.
    #[inline]
    pub(super) fn rays(&self, first: usize) -> RayLanes<f32x8> {
        let column = |k: usize| f32x8::new(self.rays[k][first..].first_chunk().copied().unwrap_or_default());
        RayLanes::new(
            vector3(column(0), column(1), column(2)),
            vector3(column(3), column(4), column(5)),
            f32x8::zero(),
            column(6),
        )
    }

    /// What a ray would have brought is nothing.
    #[inline]
    pub(super) fn block(&mut self, ray: usize) {
        self.light[ray] = [0.0; 4];
    }

    /// Slots and light, each slot's rays in the order in which they were asked for.
    #[inline]
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, &[f32; 4])> {
        self.slot[..self.len].iter().map(|&slot| slot as usize).zip(&self.light)
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
        connections.push(0b1010_0100, (zero, light(1.0), numbers), light(1.0), u32x8::splat(3));
        connections.push(0b0000_0001, (zero, light(2.0), numbers), light(10.0), u32x8::splat(8));
        connections.push(0b0000_0110, (zero, light(2.0), numbers), light(10.0), u32x8::splat(3));
        assert_eq!(connections.len, 6);
        let rays = connections.rays(0);
        assert_eq!([0, 1, 2, 4, 5].map(|i| rays.t_far.lane(i)), [2.0, 5.0, 7.0, 1.0, 2.0]);
        assert_eq!(rays.dir.lane(5), glam::Vec3::splat(4.0));
        connections.block(1);
        connections.block(4);
        let arrived: Vec<_> = connections.iter().map(|(slot, light)| (slot, light[2])).collect();
        assert_eq!(arrived, [(3, 2.0), (3, 0.0), (3, 7.0), (8, 0.0), (3, 0.0), (3, 20.0)]);
        assert!(connections.iter().all(|(_, light)| light[..3] == [light[0]; 3] && light[3] == 0.0));
    }
}
