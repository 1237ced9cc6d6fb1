//! Rays that each have a leaf to themselves, and a group of lanes with triangles of its block in them.

use std::hint::select_unpredictable;

use super::{
    INSTANCE, Primitives, TRIANGLE, accept::accept_nearest, accept_single, triangle_block::TriangleBlock,
};
use crate::bvh::{BLOCK, Leaves};
use crate::geometry::{Hit, RayLanes, Rayx8};
use crate::simd::{Groups, LANES, Mask, Mask8, Real, f32x8};

impl Primitives {
    /// As [`Leaves::intersect_blocks`](crate::bvh::Leaves::intersect_blocks).
    // Always: as a call, rays would go through memory. And nothing is called from here: what lives across a call,
    // however rare, is kept in memory from the start.
    #[inline(always)]
    pub(super) fn rays_against_blocks<const ANY: bool, const N: usize, R: Groups<N>>(
        &self,
        slots: [u32; N],
        rays: RayLanes<R>,
        hits: [&mut Hit; N],
    ) -> bool {
        let mut blocks = [&TriangleBlock::EMPTY; N];
        let mut from = [0; N];
        for i in 0..N {
            let Some(block) = self.triangles.get(slots[i] as usize / BLOCK) else { return false };
            (blocks[i], from[i]) = (block, (slots[i] as usize % BLOCK).min(LANES - R::WIDTH));
        }
        // The other triangles of a block are hit or missed as truly as the leaf's: no lane is masked.
        let (lanes, every) = (TriangleBlock::windows::<N, R>(blocks, from), R::Mask::splat(true));
        let aspect = lanes.aspect(rays.org);
        let margin = aspect.margin(lanes.edges, rays.margin);
        let Some((found, t, u, v)) = lanes.intersect_ahead(&aspect, margin, &rays, every) else {
            return false;
        };
        if ANY {
            let found = found.to_bitmask();
            for (i, hit) in hits.into_iter().enumerate() {
                let blocked = found >> (i * R::WIDTH) & ((1 << R::WIDTH) - 1) != 0;
                hit.t = select_unpredictable(blocked, f32::NEG_INFINITY, hit.t);
            }
            return true;
        }
        if found.none() {
            return true;
        }
        let (ids, _) = self.triangle_ids.as_chunks::<BLOCK>();
        let mut rows = [&[0; BLOCK]; N];
        for i in 0..N {
            let Some(row) = ids.get(slots[i] as usize / BLOCK) else { return false };
            rows[i] = row;
        }
        accept_nearest::<N, R>(hits, (found, t, u, v), rays.t_far, R::word_windows(rows, from))
    }

    /// As [`Leaves::intersect_alone`](crate::bvh::Leaves::intersect_alone).
    #[cold]
    #[inline(never)]
    pub(super) fn ray_against_leaf<const ANY: bool>(
        &self,
        (first, count): (u32, u32),
        ray: &Rayx8,
        hit: &mut Hit,
    ) -> u32 {
        match self.place(first) {
            (TRIANGLE, block, _) => {
                self.intersect_carefully::<ANY>(block, ray, hit);
                return 1;
            }
            (INSTANCE, block, lane) => {
                let slot = block * BLOCK + lane;
                self.instances.intersect_alone::<ANY>(slot, count as usize, &ray.lane(0), hit);
            }
            _ => self.intersect_single::<ANY>(first, count, &ray.lane(0), hit),
        }
        count
    }

    /// A block of triangles of which one has an edge next to the ray, or is hit where another was.
    fn intersect_carefully<const ANY: bool>(&self, block: usize, ray: &Rayx8, hit: &mut Hit) {
        let ray = RayLanes { t_far: f32x8::splat(hit.t), ..*ray };
        let (found, t, u, v) = self.triangles[block].lanes().intersect(&ray, Mask8::splat(true));
        for lane in (0..BLOCK).filter(|&lane| found.lane(lane)) {
            let id = self.triangle_ids[block * BLOCK + lane];
            accept_single::<ANY>(hit, (t.lane(lane), u.lane(lane), v.lane(lane)), id);
        }
    }
}
