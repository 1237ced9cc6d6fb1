//! What a renderer asks of a scene.

use glam::Vec3;

use super::{Scene, Surface, primitives::Primitive};
use crate::bvh::{Hitx8, Stream, Tally, Tracer, Traversal, Way};
use crate::geometry::{Aabb, Hit, PrimitiveId, Ray, Rayx8};
use crate::material::MaterialId;
use crate::simd::{Bits, Mask8, Real, Vector3, f32x8, u32x8};

/// Trees of so many nodes are gone through together.
const FEW_NODES: usize = 8;

/// What some look at of a [`Surface`], and most don't.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asked {
    /// Whatever has to do with the direction of u and v.
    pub oriented: bool,
    /// (u, v), whether the material has textures or not.
    pub mapped: bool,
}

impl Scene {
    /// The nearest hits of a packet; lanes that are not active, or hit nothing, have primitive
    /// [`PrimitiveId::NONE`] and t = +∞.
    #[inline]
    pub fn closest_hit_packet<T: Tally>(
        &self,
        ray: &Rayx8,
        active: Mask8,
        traversal: &mut Traversal<T>,
    ) -> Hitx8 {
        let none = u32x8::splat(PrimitiveId::NONE.0);
        let mut hit = Hitx8 { t: ray.t_far, u: f32x8::zero(), v: f32x8::zero(), primitive: none };
        self.bvh.intersect_packet::<false, _, T>(&self.primitives, ray, active, &mut hit, traversal);
        hit.t = f32x8::select(hit.primitive.equal(none), f32x8::splat(f32::INFINITY), hit.t);
        hit
    }

    /// The nearest hit of a ray.
    #[inline]
    pub fn closest_hit<T: Tally>(&self, ray: &Ray, traversal: &mut Traversal<T>) -> Hit {
        let mut hit = Hit { t: ray.t_far, ..Hit::MISS };
        self.bvh.intersect_single::<false, _, T>(&self.primitives, ray, &mut hit, traversal);
        if hit.primitive == PrimitiveId::NONE { Hit::MISS } else { hit }
    }

    /// Which rays of a packet are blocked; false where not active.
    #[inline]
    pub fn occluded_packet<T: Tally>(
        &self,
        ray: &Rayx8,
        active: Mask8,
        traversal: &mut Traversal<T>,
    ) -> Mask8 {
        let mut hit = Hitx8 { t: ray.t_far, u: f32x8::zero(), v: f32x8::zero(), primitive: u32x8::default() };
        self.bvh.intersect_packet::<true, _, T>(&self.primitives, ray, active, &mut hit, traversal);
        active & hit.t.equal(f32x8::splat(f32::NEG_INFINITY))
    }

    /// Is a ray blocked?
    #[inline]
    pub fn occluded<T: Tally>(&self, ray: &Ray, traversal: &mut Traversal<T>) -> bool {
        let mut hit = Hit { t: ray.t_far, ..Hit::MISS };
        self.bvh.intersect_single::<true, _, T>(&self.primitives, ray, &mut hit, traversal);
        hit.t == f32::NEG_INFINITY
    }

    /// Traces a stream of rays: nearest hits, or for `ANY` whether there is any. Every way gives the same
    /// answers, to the bit.
    #[inline]
    pub fn trace<const ANY: bool, S: Stream, T: Tally>(
        &self,
        stream: &mut S,
        way: Way,
        tracer: &mut Tracer<T>,
    ) {
        self.bvh.intersect_stream::<ANY, _, S, T>(&self.primitives, stream, way, tracer);
    }

    /// The nearest hit of a ray by testing every primitive: what every other way must equal to the bit.
    pub fn brute_force(&self, ray: &Ray) -> Hit {
        self.primitives.brute_force(ray)
    }

    /// How rays had better go that a renderer has many of: [`Way::Tile`] in a scene of a few dozen primitives,
    /// whose boxes eight rays at once meet sooner than one ray finds its way among them.
    #[inline]
    pub(crate) fn way(&self) -> Way {
        let few = self.bvh.nodes().len() <= FEW_NODES && self.primitives.instances.is_empty();
        if few { Way::Tile } else { Way::Chosen }
    }

    /// Size of the scene along each axis; 0 if it is empty.
    #[inline]
    pub fn extent(&self) -> Vec3 {
        self.extent
    }

    /// The material of what was hit; `u` is the hit's.
    #[inline]
    pub fn material(&self, primitive: PrimitiveId, u: f32) -> MaterialId {
        let instances = &self.primitives.instances;
        if instances.holds(primitive.0) {
            return instances.material(primitive, u);
        }
        self.surfaces.shape(primitive.0).material
    }

    /// The points where rays (org, dir) met their primitives at (t, u, v).
    #[inline]
    pub fn surface<R: Real>(
        &self,
        ray: (Vector3<R>, Vector3<R>),
        tuv: (R, R, R),
        primitive: R::Bits,
        asked: Asked,
    ) -> Surface<R> {
        let instances = &self.primitives.instances;
        if !instances.is_empty() {
            return instances.surface(&self.surfaces, ray, (tuv, primitive), asked);
        }
        self.surfaces.at(ray, tuv, primitive, asked)
    }

    /// How many primitives there are, those without area included and an instance as one; their ids are less.
    pub fn primitive_count(&self) -> u32 {
        (self.surfaces.shape_of.len() + self.primitives.instances.len()) as u32
    }

    /// The vertices of a primitive in the world; `None` if it is no triangle.
    pub fn triangle(&self, primitive: PrimitiveId) -> Option<[Vec3; 3]> {
        let instance = self.primitives.instances.holds(primitive.0);
        if instance { None } else { self.surfaces.corners(primitive.0) }
    }

    /// The box that decides a primitive's hits.
    pub fn primitive_bounds(&self, primitive: PrimitiveId) -> Aabb {
        self.primitives.instances.bounds(primitive.0).unwrap_or_else(|| {
            match self.surfaces.primitive(primitive.0) {
                Primitive::Triangle(triangle) => triangle.bounds(),
                Primitive::Sphere(sphere) => sphere.bounds(),
                Primitive::Canonical(surface) => surface.bounds,
                Primitive::Instance => Aabb::EMPTY,
            }
        })
    }
}
