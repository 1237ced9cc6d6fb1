//! Rays that leave a triangle do not meet it again.
//!
//! From wherever rays hit triangles, others leave to both sides, steeply and grazing, as paths do
//! ([`offset_origin`]). A plane is met once, so one that finds the triangle it left was not moved far enough.

use rayon::prelude::*;

use super::{Exhibit, Expected, aim::Random};
use crate::bvh::Traversal;
use crate::compile::{Asked, Scene};
use crate::geometry::{Hit, PrimitiveId, Ray, Ray32, offset_origin};
use crate::simd::Vector3;

/// Rays that a thread takes at a time.
const CHUNK: usize = 4096;

/// What was found.
#[derive(Clone, Debug, Default)]
pub struct Departures {
    /// Rays that left a triangle.
    pub rays: u64,
    /// Rays that met it again.
    pub self_hits: u64,
    /// The first of them.
    pub exhibit: Option<Exhibit>,
}

/// Sends four rays from each triangle that one of `rays` hits.
pub fn departures(scene: &Scene, rays: &[Ray32]) -> Departures {
    let one = |(index, chunk): (usize, &[Ray32])| depart(scene, chunk, index as u64);
    let each: Vec<Departures> = rays.par_chunks(CHUNK).enumerate().map(one).collect();
    each.into_iter().fold(Departures::default(), |mut sum, next| {
        sum.rays += next.rays;
        sum.self_hits += next.self_hits;
        sum.exhibit = sum.exhibit.or(next.exhibit);
        sum
    })
}

fn depart(scene: &Scene, rays: &[Ray32], seed: u64) -> Departures {
    let mut found = Departures::default();
    let (mut random, mut traversal) = (Random::new(seed), Traversal::new(()));
    for ray in rays.iter().map(Ray32::ray) {
        let hit = scene.closest_hit(&ray, &mut traversal);
        let Some(triangle) =
            (hit.primitive != PrimitiveId::NONE).then(|| scene.triangle(hit.primitive)).flatten()
        else {
            continue;
        };
        for leaving in leave(scene, &ray, &hit, &mut random) {
            found.rays += 1;
            if scene.closest_hit(&leaving, &mut traversal).primitive == hit.primitive {
                found.self_hits += 1;
                found.exhibit.get_or_insert_with(|| Exhibit {
                    what: "a ray meets the triangle that it left".into(),
                    triangles: vec![triangle],
                    rays: vec![Ray32::new(leaving.org, leaving.dir, leaving.t_near, leaving.t_far)],
                    expected: Some(Expected::Miss),
                });
            }
        }
    }
    found
}

/// To both sides, any way and nearly along the surface.
fn leave(scene: &Scene, ray: &Ray, hit: &Hit, random: &mut Random) -> [Ray; 4] {
    let (org, dir) = (Vector3::from(ray.org), Vector3::from(ray.dir));
    let surface = scene.surface((org, dir), (hit.t, hit.u, hit.v), hit.primitive.0, Asked::default());
    let n = glam::Vec3::from(surface.n_g);
    [(1.0, 1.0), (-1.0, 1.0), (1.0, 1e-3), (-1.0, 1e-3)].map(|(side, steep)| {
        let any = random.vector();
        let along = any - n * any.dot(n);
        let way = (along + n * (side * steep * (0.01 + random.unit()))).normalize_or(n * side);
        let start = offset_origin(surface.position, surface.extent, surface.n_g, Vector3::from(way));
        Ray::new(start.into(), way, 0.0, f32::INFINITY)
    })
}
