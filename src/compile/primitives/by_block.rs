//! Rays that each have a leaf to themselves: eight lanes a ray, the triangles of a block in them.

use super::{INSTANCE, Primitives, TRIANGLE, accept_single, triangle_block::TriangleBlock};
use crate::bvh::{BLOCK, Leaves};
use crate::geometry::{Hit, RayLanes, Rayx8};
use crate::simd::{Eights, LANES, Mask, Mask8, Real, f32x8};

impl Primitives {
    /// As [`Leaves::intersect_blocks`](crate::bvh::Leaves::intersect_blocks).
    // Always: as a call, rays would go through memory.
    #[inline(always)]
    pub(super) fn rays_against_blocks<const ANY: bool, R: Eights>(
        &self,
        leaves: [(u32, u32); 2],
        rays: impl Fn() -> RayLanes<R>,
        hits: [&mut Hit; 2],
    ) {
        let at = leaves.map(|(first, _)| first as usize / BLOCK);
        let (Some(one), Some(other)) = (self.triangles.get(at[0]), self.triangles.get(at[1])) else {
            for ((i, hit), (first, count)) in hits.into_iter().enumerate().zip(leaves).take(R::LANES / LANES)
            {
                *hit = self.intersect_rarely::<ANY>(first, count, rays().eight(i), *hit);
            }
            return;
        };
        // The other triangles of a block are hit or missed as truly as the leaf's: no lane is masked.
        let (lanes, every) = (TriangleBlock::eights::<R>([one, other]), R::Mask::splat(true));
        let rays = RayLanes { t_far: R::of_eights(|i| f32x8::splat(hits[i].t)), ..rays() };
        let aspect = lanes.aspect(rays.org);
        let margin = aspect.margin(lanes.edges, rays.margin);
        let Some((found, t, u, v)) = lanes.intersect_ahead(&aspect, margin, &rays, every) else {
            for ((i, hit), block) in hits.into_iter().enumerate().zip(at).take(R::LANES / LANES) {
                *hit = self.intersect_carefully::<ANY>(block, rays.eight(i), *hit);
            }
            return;
        };
        let mut found = found.to_bitmask();
        if ANY {
            for (i, hit) in hits.into_iter().enumerate().take(R::LANES / LANES) {
                if found >> (i * LANES) & 0xff != 0 {
                    hit.t = f32::NEG_INFINITY;
                }
            }
            return;
        }
        while found != 0 {
            let lane = found.trailing_zeros() as usize % R::LANES;
            found &= found - 1;
            let which = lane / LANES;
            let id = self.triangle_ids[at[which] * BLOCK + lane % LANES];
            accept_single::<ANY>(hits[which], (t.lane(lane), u.lane(lane), v.lane(lane)), id);
        }
    }

    /// A leaf that is not of triangles, or goes with one that is not: out of the way, and by value, so that the ray and
    /// the hits of those that are stay in registers.
    #[cold]
    #[inline(never)]
    fn intersect_rarely<const ANY: bool>(&self, first: u32, count: u32, ray: Rayx8, mut hit: Hit) -> Hit {
        match self.place(first) {
            (TRIANGLE, block, _) => hit = self.intersect_carefully::<ANY>(block, ray, hit),
            (INSTANCE, block, lane) => {
                let slot = block * BLOCK + lane;
                self.instances.intersect_alone::<ANY>(slot, count as usize, &ray.lane(0), &mut hit);
            }
            _ => self.intersect_single::<ANY>(first, count, &ray.lane(0), &mut hit),
        }
        hit
    }

    /// A block of triangles of which one has an edge next to the ray.
    #[cold]
    #[inline(never)]
    fn intersect_carefully<const ANY: bool>(&self, block: usize, ray: Rayx8, mut hit: Hit) -> Hit {
        let ray = RayLanes { t_far: f32x8::splat(hit.t), ..ray };
        let (found, t, u, v) = self.triangles[block].lanes().intersect(&ray, Mask8::splat(true));
        for lane in (0..BLOCK).filter(|&lane| found.lane(lane)) {
            let id = self.triangle_ids[block * BLOCK + lane];
            accept_single::<ANY>(&mut hit, (t.lane(lane), u.lane(lane), v.lane(lane)), id);
        }
        hit
    }
}
