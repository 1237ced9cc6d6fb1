//! Triangles as the leaves hold them: eight in columns.

use rayon::prelude::*;

use super::accept;
use crate::bvh::{BLOCK, HitLanes, Hitx16};
use crate::compile::{corners::Corners, surfaces::Surfaces};
use crate::geometry::{Aspect, AspectColumns, RayLanes, Rayx16, Triangle, TriangleLanes};
use crate::simd::{
    Bits, Groups, Mask, Mask8, Mask16, ONE_REGISTER, Real, Vector3, f32x8, f32x16, u32x8, u32x16, vector3,
};

/// Memory is asked for the vertices of triangles so many blocks on, and for their numbers twice as far.
const AHEAD: usize = 4;

/// Eight triangles: 320 bytes, all that a test reads. Padding is nowhere: NaN is never hit.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct TriangleBlock {
    v0: [[f32; 8]; 3],
    v1: [[f32; 8]; 3],
    v2: [[f32; 8]; 3],
    edges: [f32; 8],
}

impl TriangleBlock {
    pub(super) const EMPTY: Self = {
        let nowhere = [[f32::NAN; 8]; 3];
        Self { v0: nowhere, v1: nowhere, v2: nowhere, edges: [f32::NAN; 8] }
    };

    /// Fills blocks with triangles, in slots that hold ids. Memory is asked for those of blocks to come.
    pub(super) fn all(blocks: &[[u32; BLOCK]], surfaces: &Surfaces) -> Vec<Self> {
        let fill = |corners: &mut Corners, (i, ids): (usize, &[u32; BLOCK])| {
            if let Some(later) = blocks.get(i + 2 * AHEAD) {
                corners.ask_for_indices(later);
            }
            if let Some(later) = blocks.get(i + AHEAD) {
                corners.ask_for_vertices(later);
            }
            Self::new(ids, corners)
        };
        blocks.par_iter().enumerate().map_init(|| Corners::new(surfaces), fill).collect()
    }

    fn new(ids: &[u32; BLOCK], corners: &mut Corners) -> Self {
        let mut block = Self::EMPTY;
        for (lane, &id) in ids.iter().enumerate() {
            if let Some([v0, v1, v2]) = corners.of(id) {
                set(&mut block.v0, lane, v0);
                set(&mut block.v1, lane, v1);
                set(&mut block.v2, lane, v2);
                block.edges[lane] = Triangle::new(v0, v1, v2).edges();
            }
        }
        block
    }

    #[inline]
    pub(super) fn lanes(&self) -> TriangleLanes<f32x8> {
        Self::windows([self], [0])
    }

    /// Of each block the triangles from a lane on, a group of them.
    #[inline(always)]
    pub(super) fn windows<const N: usize, R: Groups<N>>(
        blocks: [&Self; N],
        from: [usize; N],
    ) -> TriangleLanes<R> {
        let rows = |of: fn(&Self) -> &[[f32; 8]; 3]| {
            let row = |axis: usize| R::windows(blocks.map(|block| &of(block)[axis]), from);
            vector3(row(0), row(1), row(2))
        };
        TriangleLanes {
            v0: rows(|block| &block.v0),
            v1: rows(|block| &block.v1),
            v2: rows(|block| &block.v2),
            edges: R::windows(blocks.map(|block| &block.edges), from),
        }
    }

    /// The triangle in a lane, in all lanes.
    #[inline]
    pub(super) fn splat<R: Real>(&self, lane: usize) -> TriangleLanes<R> {
        let splat = |rows| Vector3::splat(row(rows, lane));
        let (v0, v1, v2) = (splat(&self.v0), splat(&self.v1), splat(&self.v2));
        TriangleLanes { v0, v1, v2, edges: R::splat(self.edges[lane]) }
    }

    /// A packet against the triangle in a lane, seen from the packet's origins.
    // Always: as a call, rays and triangles would go through memory.
    #[inline(always)]
    pub(super) fn intersect<const ANY: bool, R: Real>(
        &self,
        (lane, id): (usize, &u32),
        (aspect, margin): (&Aspect<R>, R),
        ray: &RayLanes<R>,
        active: R::Mask,
        hit: &mut HitLanes<R>,
    ) {
        let limited = RayLanes { t_far: hit.t, ..*ray };
        match self.splat(lane).intersect_seen(aspect, margin, &limited, active) {
            Some((found, t, u, v)) => {
                if found.any() {
                    accept::<ANY, R>(hit, found, (t, u, v), || R::Bits::splat(*id));
                }
            }
            None => self.intersect_carefully::<ANY, R>((lane, *id), ray, active.to_bitmask(), hit),
        }
    }

    /// A bundle of rays from one origin against the triangle in a lane. Returns whether anything may have been found.
    #[inline(always)]
    pub(super) fn intersect_bundle<const ANY: bool>(
        &self,
        (lane, id): (usize, &u32),
        (aspects, margin): (&AspectColumns, f32),
        ray: &Rayx16,
        hit: &mut Hitx16,
    ) -> bool {
        let mut any = false;
        if ONE_REGISTER {
            let limited = RayLanes { t_far: hit.t, ..*ray };
            if let Some((found, t, u, v)) = aspects.intersect(lane, margin, &limited, Mask16::splat(true)) {
                accept::<ANY, f32x16>(hit, found, (t, u, v), || u32x16::splat(*id));
                return found.any();
            }
        } else {
            for half in 0..2 {
                let limited = RayLanes { t_far: hit.t.half(half), ..ray.eight(half) };
                let Some((found, t, u, v)) = aspects.intersect(lane, margin, &limited, Mask8::splat(true))
                else {
                    break;
                };
                if found.any() {
                    any = true;
                    let mut hits = hit.half(half);
                    accept::<ANY, f32x8>(&mut hits, found, (t, u, v), || u32x8::splat(*id));
                    hit.put_half(half, &hits);
                }
                if half == 1 {
                    return any;
                }
            }
        }
        // Whole: a hit that is found again changes nothing.
        let every = Mask16::splat(true).to_bitmask();
        self.intersect_carefully::<ANY, f32x16>((lane, *id), ray, every, hit);
        true
    }

    /// The same next to an edge.
    #[cold]
    #[inline(never)]
    fn intersect_carefully<const ANY: bool, R: Real>(
        &self,
        (lane, id): (usize, u32),
        ray: &RayLanes<R>,
        active: u32,
        hit: &mut HitLanes<R>,
    ) {
        let limited = RayLanes { t_far: hit.t, ..*ray };
        let active = R::Mask::from_bitmask(active);
        let (found, t, u, v) = self.splat(lane).intersect(&limited, active);
        accept::<ANY, R>(hit, found, (t, u, v), || R::Bits::splat(id));
    }

    #[inline]
    pub(super) fn triangle(&self, lane: usize) -> Triangle {
        Triangle { v0: row(&self.v0, lane), v1: row(&self.v1, lane), v2: row(&self.v2, lane) }
    }
}

/// Puts a vector into a lane.
pub(super) fn set(rows: &mut [[f32; 8]; 3], lane: usize, v: glam::Vec3) {
    for axis in 0..3 {
        rows[axis][lane] = v[axis];
    }
}

/// The vector in a lane.
pub(super) fn row(rows: &[[f32; 8]; 3], lane: usize) -> glam::Vec3 {
    glam::vec3(rows[0][lane], rows[1][lane], rows[2][lane])
}
