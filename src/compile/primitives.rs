//! What can be hit, in leaf order: eight triangles or spheres to a block, in columns; what is rare, one by
//! one.

mod accept;
mod by_block;
mod triangle_block;

use rayon::prelude::*;

pub(super) use self::accept::{accept, accept_single};
use self::triangle_block::{TriangleBlock, row, set};
use super::{instances::Instances, surfaces::Surfaces};
use crate::bvh::{BLOCK, HitLanes, Hitx8, Hitx16, Leaves};
use crate::geometry::{
    AspectColumns, Canonical, Hit, Pencils, PrimitiveId, Ray, RayLanes, Rayx8, Rayx16, Sphere, SphereLanes,
    Triangle,
};
use crate::simd::{Bits, Groups, Mask, Mask8, Mask16, Real, Vector3, f32x8, f32x16};

/// Classes of references, in the order of their blocks.
pub(super) const TRIANGLE: u8 = 0;
pub(super) const SPHERE: u8 = 1;
pub(super) const CANONICAL: u8 = 2;
pub(super) const INSTANCE: u8 = 3;

/// For up to so many bundles of a tile, the planes of a block's triangles cost more than they spare.
const FEW: u32 = 3;

/// Something that can be hit.
#[derive(Clone, Copy, Debug)]
pub(super) enum Primitive {
    Triangle(Triangle),
    Sphere(Sphere),
    Canonical(Canonical),
    Instance,
}

/// Eight spheres. Padding is never asked for: leaves have counts.
#[derive(Clone, Copy, Debug)]
struct SphereBlock {
    center: [[f32; 8]; 3],
    radius: [f32; 8],
    id: [u32; 8],
}

/// All primitives of a scene, in slots as the tree assigned them.
#[derive(Debug, Default)]
pub struct Primitives {
    triangles: Vec<TriangleBlock>,
    /// For each slot of their blocks.
    triangle_ids: Vec<u32>,
    spheres: Vec<SphereBlock>,
    /// One a slot; `None` is padding.
    canonicals: Vec<Option<(Canonical, u32)>>,
    pub(super) instances: Instances,
}

impl SphereBlock {
    const EMPTY: Self = Self { center: [[0.0; 8]; 3], radius: [0.0; 8], id: [u32::MAX; 8] };

    fn new(ids: &[u32], primitives: impl Fn(u32) -> Primitive) -> Self {
        let mut block = Self::EMPTY;
        for (lane, &id) in ids.iter().enumerate().filter(|&(_, &id)| id != u32::MAX) {
            if let Primitive::Sphere(sphere) = primitives(id) {
                set(&mut block.center, lane, sphere.center);
                block.radius[lane] = sphere.radius;
                block.id[lane] = id;
            }
        }
        block
    }
}

impl Primitive {
    fn class(&self) -> u8 {
        match self {
            Self::Triangle(_) => TRIANGLE,
            Self::Sphere(_) => SPHERE,
            Self::Canonical(_) => CANONICAL,
            Self::Instance => INSTANCE,
        }
    }
}

impl Primitives {
    /// Lays the primitives out. `slots` holds their ids, `u32::MAX` for padding, in blocks of one class; what is beyond
    /// the surfaces are instances.
    pub(super) fn new(mut slots: Vec<u32>, mut instances: Instances, surfaces: &Surfaces) -> Self {
        let first_instance = surfaces.shape_of.len() as u32;
        let primitives = |id| match id < first_instance {
            true => surfaces.primitive(id),
            false => Primitive::Instance,
        };
        let class = |block: &[u32; BLOCK]| primitives(block[0]).class();
        let blocks = slots.as_chunks().0;
        let (triangles, rest) = blocks.split_at(blocks.partition_point(|block| class(block) == TRIANGLE));
        let (spheres, rest) = rest.split_at(rest.partition_point(|block| class(block) == SPHERE));
        let (canonicals, placed) = rest.split_at(rest.partition_point(|block| class(block) == CANONICAL));
        instances.fill(placed.as_flattened());
        let spheres = spheres.par_iter().map(|ids| SphereBlock::new(ids, primitives)).collect();
        let canonical = |&id: &u32| match (id != u32::MAX).then(|| primitives(id)) {
            Some(Primitive::Canonical(surface)) => Some((surface, id)),
            _ => None,
        };
        let canonicals = canonicals.as_flattened().iter().map(canonical).collect();
        let triangles = TriangleBlock::all(triangles, surfaces);
        slots.truncate(triangles.len() * BLOCK);
        slots.shrink_to_fit();
        Self { triangles, triangle_ids: slots, spheres, canonicals, instances }
    }

    /// Bytes that tracing reads, without those of instances.
    pub fn bytes(&self) -> usize {
        size_of_val(self.triangles.as_slice())
            + size_of_val(self.triangle_ids.as_slice())
            + size_of_val(self.spheres.as_slice())
            + size_of_val(self.canonicals.as_slice())
    }

    /// Tests every primitive: the answer that every tree must give.
    pub fn brute_force(&self, ray: &Ray) -> Hit {
        let mut hit = Hit { t: ray.t_far, ..Hit::MISS };
        let slots = (self.triangles.len() + self.spheres.len()) * BLOCK + self.canonicals.len();
        for first in (0..slots as u32).step_by(BLOCK) {
            self.intersect_single::<false>(first, BLOCK as u32, ray, &mut hit);
        }
        self.instances.brute_force(ray, &mut hit);
        if hit.primitive == PrimitiveId::NONE { Hit::MISS } else { hit }
    }

    /// Rays in lanes against the primitives of a leaf; `instance` tests the one in a slot.
    #[inline(always)]
    fn intersect_lanes<const ANY: bool, R: Real>(
        &self,
        first: u32,
        count: u32,
        ray: &RayLanes<R>,
        active: R::Mask,
        hit: &mut HitLanes<R>,
        instance: impl Fn(usize, &mut HitLanes<R>),
    ) {
        let (class, block, lane) = self.place(first);
        for lane in lane..lane + count as usize {
            let limited = RayLanes { t_far: hit.t, ..*ray };
            let zero = R::zero();
            match class {
                TRIANGLE => {
                    let id = &self.triangle_ids[block * BLOCK + lane];
                    let block = &self.triangles[block];
                    let triangle = block.splat(lane);
                    let (aspect, margin) = {
                        let aspect = triangle.aspect(ray.org);
                        (aspect, aspect.margin(triangle.edges, ray.margin))
                    };
                    block.intersect::<ANY, R>((lane, id), (&aspect, margin), ray, active, hit);
                }
                SPHERE => {
                    let block = &self.spheres[block];
                    let sphere = SphereLanes {
                        center: Vector3::splat(row(&block.center, lane)),
                        radius: R::splat(block.radius[lane]),
                    };
                    let (found, t) = sphere.intersect(&limited, active);
                    accept::<ANY, R>(hit, found, (t, zero, zero), || R::Bits::splat(block.id[lane]));
                }
                CANONICAL => {
                    if let Some((surface, id)) = &self.canonicals[block * BLOCK + lane] {
                        let (found, t) = surface.intersect(&limited, active);
                        accept::<ANY, R>(hit, found, (t, zero, zero), || R::Bits::splat(*id));
                    }
                }
                _ => instance(block * BLOCK + lane, hit),
            }
        }
    }

    /// A slot's block: which class, which block of the class, and the first lane.
    #[inline]
    fn place(&self, slot: u32) -> (u8, usize, usize) {
        let (block, lane) = (slot as usize / BLOCK, slot as usize % BLOCK);
        if block < self.triangles.len() {
            return (TRIANGLE, block, lane);
        }
        let block = block - self.triangles.len();
        if block < self.spheres.len() {
            return (SPHERE, block, lane);
        }
        let (block, canonicals) = (block - self.spheres.len(), self.canonicals.len() / BLOCK);
        if block < canonicals {
            return (CANONICAL, block, lane);
        }
        (INSTANCE, block - canonicals, lane)
    }
}

impl Leaves for Primitives {
    #[inline]
    fn address(&self, slot: u32) -> *const u8 {
        self.triangles.as_ptr().wrapping_add(slot as usize / BLOCK).cast()
    }

    #[inline]
    fn intersect_packet<const ANY: bool>(
        &self,
        first: u32,
        count: u32,
        ray: &Rayx8,
        active: Mask8,
        hit: &mut Hitx8,
    ) {
        self.intersect_lanes::<ANY, f32x8>(first, count, ray, active, hit, |slot, hit| {
            self.instances.intersect_packet::<ANY>(slot, ray, active, hit);
        });
    }

    #[inline]
    fn intersect_bundle<const ANY: bool>(
        &self,
        first: u32,
        count: u32,
        ray: &Rayx16,
        active: Mask16,
        hit: &mut Hitx16,
    ) {
        self.intersect_lanes::<ANY, f32x16>(first, count, ray, active, hit, |slot, hit| {
            let mut halves = hit.halves();
            for (half, hit) in halves.iter_mut().enumerate() {
                self.instances.intersect_packet::<ANY>(slot, &ray.eight(half), active.half(half), hit);
            }
            *hit = Hitx16::of_halves(halves);
        });
    }

    fn intersect_tile<const ANY: bool>(
        &self,
        (first, count): (u32, u32),
        rays: &[&Rayx16; 16],
        pencils: Option<&Pencils>,
        mask: u32,
        hits: &mut [Hitx16; 16],
    ) -> (u32, u32) {
        let every = Mask16::splat(true);
        let bundles = (0..16).filter(|bundle| mask >> bundle & 1 != 0);
        let Some(block) = self.triangles.get(first as usize / BLOCK) else {
            for bundle in bundles {
                self.intersect_bundle::<ANY>(first, count, rays[bundle], every, &mut hits[bundle]);
            }
            return (mask.count_ones() * count, mask);
        };
        let Some(pencils) = pencils else {
            let first = first as usize;
            for slot in first..first + count as usize {
                let (lane, id) = (slot % BLOCK, &self.triangle_ids[slot]);
                let triangle = block.splat::<f32x16>(lane);
                for bundle in bundles.clone() {
                    let ray = rays[bundle];
                    let aspect = triangle.aspect(ray.org);
                    let seen = (&aspect, aspect.margin(triangle.edges, ray.margin));
                    block.intersect::<ANY, f32x16>((lane, id), seen, ray, every, &mut hits[bundle]);
                }
            }
            return (mask.count_ones() * count, mask);
        };
        // From the one origin of all, for all triangles of the block at once.
        let triangles = block.lanes();
        let aspects = triangles.aspect(Vector3::splat(pencils.org()));
        let margins = aspects.margin_towards(Vector3::splat(pencils.rounding())).to_array();
        let lane = first as usize % BLOCK;
        let lanes = lane..lane + count as usize;
        // Which bundles may hit which triangle: all are found out before the first is tested.
        let mut near = [mask; BLOCK];
        if mask.count_ones() > FEW {
            let planes = aspects.edge_planes(pencils);
            for lane in lanes {
                near[lane] &= pencils.meet(&planes, lane).to_bitmask();
            }
        }
        let seen_by = (pencils.org(), pencils.negative());
        let aspects = AspectColumns::new(&aspects, triangles.corners(), seen_by);
        let (mut tests, mut found) = (0, 0);
        for (lane, &margin) in margins.iter().enumerate().skip(lane).take(count as usize) {
            let id = &self.triangle_ids[first as usize / BLOCK * BLOCK + lane];
            let mut left = near[lane];
            tests += left.count_ones();
            while left != 0 {
                let bundle = left.trailing_zeros() as usize % 16;
                left &= left - 1;
                let seen = (&aspects, margin);
                let hit = block.intersect_bundle::<ANY>((lane, id), seen, rays[bundle], &mut hits[bundle]);
                found |= u32::from(hit) << bundle;
            }
        }
        (tests, found)
    }

    #[inline(always)]
    fn intersect_blocks<const ANY: bool, const N: usize, R: Groups<N>>(
        &self,
        slots: [u32; N],
        rays: RayLanes<R>,
        hits: [&mut Hit; N],
    ) -> bool {
        self.rays_against_blocks::<ANY, N, R>(slots, rays, hits)
    }

    fn intersect_alone<const ANY: bool>(&self, leaf: (u32, u32), ray: &Rayx8, hit: &mut Hit) -> u32 {
        self.ray_against_leaf::<ANY>(leaf, ray, hit)
    }

    #[inline]
    fn intersect_single<const ANY: bool>(&self, first: u32, count: u32, ray: &Ray, hit: &mut Hit) {
        let (class, block, lane) = self.place(first);
        for lane in lane..lane + count as usize {
            let limited = Ray { t_far: hit.t, ..*ray };
            match class {
                TRIANGLE => {
                    if let Some(found) = self.triangles[block].triangle(lane).intersect(&limited) {
                        accept_single::<ANY>(hit, found, self.triangle_ids[block * BLOCK + lane]);
                    }
                }
                SPHERE => {
                    let block = &self.spheres[block];
                    let sphere = Sphere { center: row(&block.center, lane), radius: block.radius[lane] };
                    if let Some(t) = sphere.intersect(&limited).filter(|_| block.id[lane] != u32::MAX) {
                        accept_single::<ANY>(hit, (t, 0.0, 0.0), block.id[lane]);
                    }
                }
                CANONICAL => {
                    if let Some((surface, id)) = &self.canonicals[block * BLOCK + lane]
                        && let Some(t) = surface.intersect_ray(&limited)
                    {
                        accept_single::<ANY>(hit, (t, 0.0, 0.0), *id);
                    }
                }
                _ => self.instances.intersect_single::<ANY>(block * BLOCK + lane, ray, hit),
            }
        }
    }
}
