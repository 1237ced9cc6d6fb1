//! Rays as a renderer traces them, sorted by what they are for: what a tracer is measured with.
//!
//! | class | query | rays |
//! | --- | --- | --- |
//! | primary | closest | one a pixel, tiles in rows, Morton order inside: eight in a row are 4 × 2 pixels |
//! | shadow | any | from each primary hit to a point of each light on the viewer's side, light by light |
//! | ao | any | cosine hemisphere over each primary hit, a tenth of the scene's diagonal long |
//! | diffuse | closest | cosine hemisphere, without an end |
//! | diffuse2 | closest | the same again from the hits of diffuse |
//!
//! Directions have unit length, so t is a distance. The same scene gives the same rays.

use rayon::prelude::*;

use super::camera_rays;
use super::integrator::Path;
use crate::compile::{Asked, Scene};
use crate::geometry::{Hit, PrimitiveId, REACH, Ray32, offset_origin};
use crate::light::{Light, Reach, Receiver};
use crate::math::{Frame, Sampler, warp};
use crate::simd::Vector3;

/// What is asked of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// Its nearest hit.
    Closest,
    /// Whether it is blocked.
    Any,
}

/// Rays of one kind.
#[derive(Clone, Debug)]
pub struct RayClass {
    /// Name of the kind, and of its file without `.rays`.
    pub name: &'static str,
    /// What is asked of them.
    pub query: Query,
    /// In the order in which they are traced.
    pub rays: Vec<Ray32>,
}

/// Lights that a hit sends shadow rays to, at most: evenly spread over those there are.
const SHADOW_LIGHTS: usize = 8;
/// Rays that a thread takes at a time.
const CHUNK: usize = 4096;

// Pairs of random numbers; pair 0 is the position in the pixel.
const AO: u32 = 1;
const DIFFUSE: u32 = 2;
const DIFFUSE2: u32 = 3;
const SHADOW: u32 = 4;

/// The scene's rays, one class after the other, on the current rayon pool. Classes without rays are
/// left out.
pub fn ray_classes(scene: &Scene) -> Vec<RayClass> {
    let (primary, keys) = primary(scene);
    let seen = arrive(scene, &primary, &keys);
    let diffuse = hemisphere(&seen, DIFFUSE, f32::INFINITY);
    let keys: Vec<u32> = seen.iter().map(|point| point.key).collect();
    let bounced = arrive(scene, &diffuse, &keys);
    let class = |name, query, rays| RayClass { name, query, rays };
    let mut classes = vec![
        class("primary", Query::Closest, primary),
        class("shadow", Query::Any, shadow(scene, &seen)),
        class("ao", Query::Any, hemisphere(&seen, AO, 0.1 * diagonal(scene))),
        class("diffuse", Query::Closest, diffuse),
        class("diffuse2", Query::Closest, hemisphere(&bounced, DIFFUSE2, f32::INFINITY)),
    ];
    classes.retain(|class| !class.rays.is_empty());
    classes
}

/// A point that is seen, and its normal on the side it is seen from.
struct Point {
    position: Vector3<f32>,
    extent: Vector3<f32>,
    n: Vector3<f32>,
    key: u32,
}

impl Point {
    fn leave(&self, dir: Vector3<f32>) -> Vector3<f32> {
        offset_origin(self.position, self.extent, self.n, dir)
    }
}

/// Camera rays and the keys of their pixels.
fn primary(scene: &Scene) -> (Vec<Ray32>, Vec<u32>) {
    let tiles = super::frame::tiles(scene.film.window());
    let pixels = tiles
        .iter()
        .flat_map(|tile| camera_rays::morton(tile).into_iter().map(move |(x, y)| (tile.x + x, tile.y + y)));
    pixels
        .map(|(x, y)| {
            let key = camera_rays::keys::<f32>(scene, x, y);
            let (ray, _) = camera_rays::rays(scene, x, y, &Path::<f32>::start(key, 0));
            (Ray32::new(ray.org.into(), ray.dir.into(), ray.t_near, ray.t_far), key)
        })
        .unzip()
}

/// Where rays hit something, in their order.
fn arrive(scene: &Scene, rays: &[Ray32], keys: &[u32]) -> Vec<Point> {
    let mut hits = vec![Hit::MISS; rays.len()];
    rays.par_chunks(CHUNK)
        .zip(hits.par_chunks_mut(CHUNK))
        .for_each(|(rays, hits)| scene.closest_hits(rays, hits));
    let found = rays.iter().zip(&hits).zip(keys).filter(|((_, hit), _)| hit.primitive != PrimitiveId::NONE);
    found
        .map(|((ray, hit), &key)| {
            let ray = ray.ray();
            let (org, dir) = (Vector3::from(ray.org), Vector3::from(ray.dir));
            let surface = scene.surface((org, dir), (hit.t, hit.u, hit.v), hit.primitive.0, Asked::default());
            let n = if surface.n_g.dot(dir) > 0.0 { -surface.n_g } else { surface.n_g };
            Point { position: surface.position, extent: surface.extent, n, key }
        })
        .collect()
}

fn hemisphere(points: &[Point], pair: u32, t_far: f32) -> Vec<Ray32> {
    let ray = |point: &Point| {
        let (u, v) = Sampler::<f32>::new(point.key, 0).pair(pair);
        let dir = Frame::around(point.n).to_world(warp::cosine_hemisphere(u, v)).normalize();
        Ray32::new(point.leave(dir).into(), dir.into(), 0.0, t_far)
    };
    points.par_iter().map(ray).collect()
}

fn shadow(scene: &Scene, points: &[Point]) -> Vec<Ray32> {
    let count = scene.lights.len();
    let chosen = count.min(SHADOW_LIGHTS);
    let lights = (0..chosen).map(|i| i * count / chosen);
    let towards = |index: usize| {
        let light = &scene.lights[index];
        points.par_iter().filter_map(move |point| shadow_ray(point, light, SHADOW + index as u32))
    };
    lights.flat_map(|index| towards(index).collect::<Vec<_>>()).collect()
}

fn shadow_ray(point: &Point, light: &Light, pair: u32) -> Option<Ray32> {
    let receiver = Receiver { position: point.position, n: point.n };
    let sample = light.sample(&receiver, Sampler::<f32>::new(point.key, 0).pair(pair));
    if !sample.valid || sample.wi.dot(point.n) <= 0.0 {
        return None;
    }
    let org = point.leave(sample.wi);
    let (dir, t_far) = match sample.reach {
        Reach::Unhindered => return None,
        Reach::Infinity => (sample.wi, f32::INFINITY),
        Reach::Target => {
            let way = sample.target - org;
            (way.normalize(), way.length() * REACH)
        }
    };
    Some(Ray32::new(org.into(), dir.into(), 0.0, t_far)).filter(Ray32::is_valid)
}

fn diagonal(scene: &Scene) -> f32 {
    let Some(root) = scene.bvh.nodes().first() else {
        return 0.0;
    };
    let bounds = root.bounds();
    (bounds.max - bounds.min).length()
}
