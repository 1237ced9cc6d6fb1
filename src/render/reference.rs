//! The same integrators, one ray at a time, from the scalar functions: the picture that every other way
//! of rendering must equal to the bit.
//!
//! Nothing here is sorted, queued or eight wide. A sample is a list of rays that grows as it is worked
//! off, first in, first out, which is the order of a wavefront's rounds.

use std::collections::VecDeque;

use super::aov::{AovIntegrator, Beside};
use super::camera_rays;
use super::frame::Visit;
use super::integrator::{Integrator, Outgoing, Path};
use super::statistics::Statistics;
use super::vertex::Vertex;
use crate::bvh::Traversal;
use crate::compile::Scene;
use crate::film::Tile;
use crate::geometry::{PrimitiveId, Ray};
use crate::simd::Vector3;

/// A ray, and what it is worth.
type Flight = (Ray, Path<f32>);
/// (org, dir, `t_far`).
type Segment = (Vector3<f32>, Vector3<f32>, f32);

/// Renders samples of a tile, for as long as the visit has any.
pub(super) fn render<I: Integrator>(scene: &Scene, integrator: &I, tile: &Tile, visit: &Visit<'_>) {
    let mut traversal = Traversal::new(());
    while let Some(samples) = visit.next() {
        let mut statistics = Statistics::default();
        let all: Vec<Vec<_>> = samples
            .clone()
            .map(|sample| {
                let pixel = |pixel: u32| {
                    let place = (tile.x + pixel % tile.width, tile.y + pixel / tile.width);
                    self::sample(scene, integrator, place, sample, &mut traversal, &mut statistics)
                };
                (0..tile.len() as u32).map(pixel).collect()
            })
            .collect();
        visit.finish(samples, statistics, |samples| {
            for (index, pixels) in (0..).zip(&all) {
                for (pixel, (sums, weight)) in pixels.iter().enumerate() {
                    samples.add(pixel, index, *weight, |c| sums[c]);
                }
            }
        });
    }
}

/// What one sample of the pixel (x, y) brings to each channel, finite or not, and what it counts.
pub(super) fn sample<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    (x, y): (u32, u32),
    sample: u32,
    traversal: &mut Traversal,
    statistics: &mut Statistics,
) -> (Vec<f32>, f32) {
    let channels = integrator.all_channels(scene).len();
    let path = Path::start(camera_rays::keys::<f32>(scene, x, y), sample);
    let (ray, weight) = camera_rays::rays::<f32>(scene, x, y, &path);
    let mut sums = vec![0.0; channels];
    let mut flights = VecDeque::from([(ray.lane(0), path)]);
    while let Some(flight) = flights.pop_front() {
        let said = vertex(scene, integrator, &flight, channels, traversal, statistics);
        flights.extend(said.next.into_iter().flatten());
        for (c, sum) in sums.iter_mut().enumerate() {
            let mut value = said.added[c];
            // Only light comes by shadow rays, and not what the camera sees beside it.
            for (segment, radiance) in said.shadows.iter().filter(|_| c < 3) {
                value += if segment.is_some() { [radiance.x, radiance.y, radiance.z][c] } else { 0.0 };
            }
            *sum += value;
        }
    }
    (sums, weight)
}

/// What a vertex has said: shadow rays by index, `None` where there is none or it is blocked.
struct Said {
    added: Vec<f32>,
    shadows: Vec<(Option<Segment>, Vector3<f32>)>,
    next: [Option<Flight>; 2],
}

impl Outgoing<f32> for Said {
    fn add(&mut self, channel: usize, value: f32) {
        self.added[channel] = value;
    }

    fn shadow(&mut self, index: usize, there: bool, segment: Segment, radiance: Vector3<f32>) {
        self.shadows[index] = (there.then_some(segment), radiance);
    }

    fn next(
        &mut self,
        index: usize,
        there: bool,
        (org, dir): (Vector3<f32>, Vector3<f32>),
        path: &Path<f32>,
    ) {
        let ray = Ray::new(org.into(), dir.into(), 0.0, f32::INFINITY);
        self.next[index] = there.then_some((ray, *path));
    }
}

fn vertex<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    (ray, path): &Flight,
    channels: usize,
    traversal: &mut Traversal,
    statistics: &mut Statistics,
) -> Said {
    let shadows = vec![(None, Vector3::zero()); integrator.shadow_rays(scene)];
    let mut said = Said { added: vec![0.0; channels], shadows, next: [None; 2] };
    if path.depth == 0 && integrator.begins() {
        integrator.begin(scene, path, &mut said);
    } else {
        arrive(scene, integrator, (ray, path), &mut said, traversal, statistics);
    }
    for (segment, _) in &mut said.shadows {
        if let Some((org, dir, t_far)) = *segment {
            statistics.shadow_rays += 1;
            if scene.occluded(&Ray::new(org.into(), dir.into(), 0.0, t_far), traversal) {
                *segment = None;
            }
        }
    }
    said
}

/// Traces a ray and says what is where it ends.
fn arrive<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    (ray, path): (&Ray, &Path<f32>),
    said: &mut Said,
    traversal: &mut Traversal,
    statistics: &mut Statistics,
) {
    let rays = if path.depth == 0 { &mut statistics.camera_rays } else { &mut statistics.bounce_rays };
    *rays += 1;
    let hit = scene.closest_hit(ray, traversal);
    let line = (ray.org.into(), ray.dir.into());
    if hit.primitive == PrimitiveId::NONE {
        integrator.miss(scene, path, line, said);
        beside(scene, integrator, path, said, |aovs, out| aovs.miss(scene, path, line, out));
        return;
    }
    let material = scene.material(hit.primitive, hit.u);
    let vertex = Vertex::new(scene, *path, line, (hit.t, hit.u, hit.v), hit.primitive.0, material);
    integrator.shade(scene, &vertex, said);
    beside(scene, integrator, path, said, |aovs, out| aovs.shade(scene, &vertex, out));
}

/// What the camera sees besides.
fn beside<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    path: &Path<f32>,
    said: &mut Said,
    say: impl FnOnce(&AovIntegrator, &mut Beside<'_, Said>),
) {
    if path.depth == 0 && !scene.aovs.is_empty() {
        let aovs = AovIntegrator::new(scene.aovs.clone());
        say(&aovs, &mut Beside { out: said, first: integrator.channels().len() });
    }
}
