//! Arrays of rays to arrays of results: the door for whoever has many rays and no packets.
//!
//! Results are those of [`Scene::closest_hit`] and [`Scene::occluded`], to the bit, in the order of the
//! rays. How rays travel together in between is decided here and nowhere else.

use std::cell::RefCell;

use super::Scene;
use crate::bvh::{Stream, Tally, Tracer, Way};
use crate::geometry::{Hit, Ray32, Rayx8};
use crate::simd::{LANES, Mask8, Real, prefetch};

thread_local! {
    /// Stacks are set up once a thread, not once a call.
    static TRACER: RefCell<Tracer> = RefCell::new(Tracer::new(()));
}

impl Scene {
    /// The nearest hit of each ray. Rays are valid ([`Ray32::is_valid`]) or [`Ray32::NEVER`].
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn closest_hits(&self, rays: &[Ray32], out: &mut [Hit]) {
        TRACER.with_borrow_mut(|tracer| self.closest_hits_by(rays, out, Way::Chosen, tracer));
    }

    /// Which rays are blocked: 1 or 0 each. Rays as for [`Scene::closest_hits`].
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn occluded_stream(&self, rays: &[Ray32], out: &mut [u8]) {
        TRACER.with_borrow_mut(|tracer| self.occluded_stream_by(rays, out, Way::Chosen, tracer));
    }

    /// [`Scene::closest_hits`] by a way of the caller's choice, counting what it does.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn closest_hits_by<T: Tally>(
        &self,
        rays: &[Ray32],
        out: &mut [Hit],
        way: Way,
        tracer: &mut Tracer<T>,
    ) {
        assert_eq!(rays.len(), out.len(), "a hit for each ray");
        self.trace::<false, _, T>(&mut Slices { rays, out }, way, tracer);
    }

    /// [`Scene::occluded_stream`] by a way of the caller's choice, counting what it does.
    ///
    /// # Panics
    /// If the slices differ in length.
    pub fn occluded_stream_by<T: Tally>(
        &self,
        rays: &[Ray32],
        out: &mut [u8],
        way: Way,
        tracer: &mut Tracer<T>,
    ) {
        assert_eq!(rays.len(), out.len(), "an answer for each ray");
        self.trace::<true, _, T>(&mut Slices { rays, out }, way, tracer);
    }
}

/// Rays in an array, answers into another.
struct Slices<'a, A> {
    rays: &'a [Ray32],
    out: &'a mut [A],
}

/// What is kept of a hit.
trait Answer: Copy {
    fn of(hit: &Hit) -> Self;
}

impl Answer for Hit {
    #[inline]
    fn of(hit: &Hit) -> Self {
        *hit
    }
}

impl Answer for u8 {
    #[inline]
    fn of(hit: &Hit) -> Self {
        Self::from(*hit == Hit::BLOCKED)
    }
}

impl<A: Answer> Stream for Slices<'_, A> {
    fn len(&self) -> usize {
        self.rays.len()
    }

    #[inline(always)]
    fn packet(&self, first: usize) -> (Rayx8, Mask8) {
        let rays = &self.rays[first..self.rays.len().min(first + LANES)];
        let packet = Ray32::packet(rays);
        (packet, Mask8::first(rays.len()) & packet.t_near.le(packet.t_far))
    }

    // In runs, rays and answers come one after the other by far less than a page: that is over before the processor
    // sees it by itself.
    #[inline]
    fn expect(&self, first: usize) {
        prefetch::<4>(self.rays.as_ptr().wrapping_add(first).cast());
        let answers = self.out.as_ptr().wrapping_add(first).cast();
        if size_of::<A>() * LANES > 64 { prefetch::<2>(answers) } else { prefetch::<1>(answers) }
    }

    #[inline]
    fn answer(&mut self, index: usize, hit: &Hit) {
        self.out[index] = A::of(hit);
    }

    #[inline]
    fn answer_blocked(&mut self, first: usize, count: usize, blocked: u64) {
        let out = &mut self.out[first..first + count];
        let answer = |i: usize| A::of(if blocked >> i & 1 != 0 { &Hit::BLOCKED } else { &Hit::MISS });
        match out.first_chunk_mut::<64>() {
            Some(out) => *out = std::array::from_fn(answer),
            None => out.iter_mut().enumerate().for_each(|(i, out)| *out = answer(i)),
        }
    }

    #[inline]
    fn answer_packet(&mut self, first: usize, [a, b, c, d, e, f, g, h]: [Hit; LANES]) {
        if let Some(out) = self.out[first..].first_chunk_mut() {
            *out = [A::of(&a), A::of(&b), A::of(&c), A::of(&d), A::of(&e), A::of(&f), A::of(&g), A::of(&h)];
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, Vec3, vec3};

    use super::*;
    use crate::bvh::Traversal;
    use crate::compile::compile;
    use crate::scene::{Geometry, Material, MaterialIndex, Mesh, SceneDescription, Shape};

    /// A staircase of small triangles across the unit square.
    fn scene() -> Scene {
        let corner = |i: usize| vec3((i % 10) as f32, (i / 10) as f32, (i % 7) as f32) * 0.1;
        let positions = (0..100).flat_map(|i| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| corner(i) + p * 0.12));
        let mesh = Mesh {
            positions: positions.collect(),
            triangles: (0..300).step_by(3).map(|i| [i, i + 1, i + 2]).collect(),
            ..Mesh::default()
        };
        let shape = Shape {
            name: String::new(),
            geometry: Geometry::Mesh { mesh: Arc::new(mesh), face_normals: true },
            to_world: DAffine3::IDENTITY,
            flip_normals: false,
            material: MaterialIndex(0),
            radiance: None,
        };
        let materials = vec![Material::default()];
        compile(&SceneDescription { shapes: vec![shape], materials, ..Default::default() }).unwrap()
    }

    #[test]
    fn streams_give_what_single_rays_give() {
        let scene = scene();
        // Not a multiple of eight, and one ray among them that never hits.
        let mut rays: Vec<Ray32> = (0..1001)
            .map(|i| {
                let org = vec3((i % 37) as f32 / 37.0, (i % 41) as f32 / 41.0, 2.0);
                let dir = vec3((i % 5) as f32 - 2.0, (i % 3) as f32 - 1.0, -8.0) * 0.1;
                Ray32::new(org, dir, 0.0, if i % 2 == 0 { f32::INFINITY } else { 2.2 })
            })
            .collect();
        rays[500] = Ray32::NEVER;
        let (mut hits, mut blocked) = (vec![Hit::MISS; rays.len()], vec![7; rays.len()]);
        scene.closest_hits(&rays, &mut hits);
        scene.occluded_stream(&rays, &mut blocked);
        let mut traversal = Traversal::new(());
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(hits[i], scene.closest_hit(&ray.ray(), &mut traversal), "{i}");
            assert_eq!(blocked[i] == 1, scene.occluded(&ray.ray(), &mut traversal), "{i}");
        }
        assert!(hits.iter().any(|hit| hit.t < 9.0) && hits.contains(&Hit::MISS));
        assert_eq!((hits[500], blocked[500]), (Hit::MISS, 0));
        scene.closest_hits(&[], &mut []);
    }
}
