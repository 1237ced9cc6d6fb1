//! Scene to film.
//!
//! Tiles are handed to the threads of the current rayon pool. A tile is rendered by the wavefront (eight
//! rays at a time) or by the reference (one), and both call the same integrators.

mod alpha;
mod ao;
mod aov;
mod camera_rays;
mod connections;
mod departure;
mod direct;
mod integrator;
mod irradiance;
pub mod measure;
pub mod meter;
mod path;
mod pixel_format;
mod ray_classes;
mod reference;
mod rows;
mod sort;
mod statistics;
mod trace;
mod vertex;
mod wavefront;
mod whitted;

use std::{
    sync::atomic::{AtomicU64, AtomicUsize, Ordering},
    time::Instant,
};

pub use irradiance::Receiver;
pub use ray_classes::{Query, RayClass, ray_classes};
pub use statistics::{LaneUse, Profile, Statistics};

use bumpalo::Bump;

use crate::{
    bvh::Traversal,
    compile::Scene,
    film::{self, Film, Tile, TileFilm},
    picture::Picture,
    scene,
};
use integrator::Integrator;
use irradiance::Irradiance;
use path::PathTracer;
use wavefront::Wavefront;

/// Side of a tile in pixels: a thousand paths, whose columns stay in a core's second-level cache.
const TILE: u32 = 32;

/// Which of the two pipelines renders. Their pictures are equal to the bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backend {
    /// Eight rays at a time.
    #[default]
    Packet,
    /// One ray at a time, from the scalar functions: the reference.
    Scalar,
}

/// How to render. None of it changes a bit of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Packet or scalar.
    pub backend: Backend,
    /// Hits are sorted by material before they are shaded.
    pub sort: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { backend: Backend::Packet, sort: true }
    }
}

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Pixel samples finished.
    pub done: u64,
    /// Pixel samples in all.
    pub total: u64,
}

/// A finished render.
#[derive(Clone, Debug, Default)]
pub struct Rendered {
    /// The channels of the film's [`PixelFormat`](scene::PixelFormat), or those of the AOV integrator.
    pub picture: Picture,
    /// What it took.
    pub statistics: Statistics,
}

/// Something to be done with whatever integrator the scene asks for.
trait Task {
    type Done;
    fn run<I: Integrator>(self, integrator: &I) -> Self::Done;
}

fn with_integrator<T: Task>(scene: &Scene, task: T) -> T::Done {
    if scene.has_meter() {
        return task.run(&meter::integrator(&scene.integrator, Receiver::Sensor));
    }
    match scene.integrator.clone() {
        scene::Integrator::Path { max_depth, rr_depth, hide_emitters } => {
            task.run(&paths(max_depth, rr_depth, hide_emitters))
        }
        scene::Integrator::Direct { hide_emitters } => task.run(&direct::Direct { hide_emitters }),
        scene::Integrator::Whitted { max_depth } => task.run(&whitted::Whitted { max_depth }),
        scene::Integrator::AmbientOcclusion { distance } => task.run(&ao::AmbientOcclusion { distance }),
        scene::Integrator::Irradiance { max_depth, rr_depth } => {
            task.run(&Irradiance { paths: paths(max_depth, rr_depth, false), receiver: None })
        }
        scene::Integrator::Aov { channels } => task.run(&aov::AovIntegrator { channels }),
    }
}

/// Renders on the current rayon pool. `progress` is called from its threads, now and then.
pub fn render(scene: &Scene, settings: &Settings, progress: &(dyn Fn(Progress) + Sync)) -> Rendered {
    struct Render<'a>(&'a Scene, &'a Settings, &'a (dyn Fn(Progress) + Sync));
    impl Task for Render<'_> {
        type Done = Rendered;
        fn run<I: Integrator>(self, integrator: &I) -> Rendered {
            render_with(self.0, integrator, self.1, self.2)
        }
    }
    let rendered = with_integrator(scene, Render(scene, settings, progress));
    pixel_format::formatted(scene, settings, rendered)
}

/// What one sample of the pixel (x, y) brings: names of channels, and values that may be NaN or infinite.
/// A pixel outside of the film has samples too.
pub fn replay(scene: &Scene, settings: &Settings, pixel: (u32, u32), sample: u32) -> Vec<(String, f32)> {
    struct Replay<'a>(&'a Scene, &'a Settings, (u32, u32), u32);
    impl Task for Replay<'_> {
        type Done = Vec<(String, f32)>;
        fn run<I: Integrator>(self, integrator: &I) -> Self::Done {
            let Self(scene, settings, pixel, sample) = self;
            let values = match settings.backend {
                Backend::Packet => {
                    let arena = Bump::new();
                    Wavefront::new(&arena, scene, integrator, settings.sort).sample(pixel, sample)
                }
                Backend::Scalar => {
                    let (mut traversal, mut statistics) = (Traversal::new(()), Statistics::default());
                    reference::sample(scene, integrator, pixel, sample, &mut traversal, &mut statistics).0
                }
            };
            integrator.channels().into_iter().zip(values).collect()
        }
    }
    with_integrator(scene, Replay(scene, settings, pixel, sample))
}

fn paths(max_depth: Option<u32>, rr_depth: u32, hide_emitters: bool) -> PathTracer {
    PathTracer { max_depth: max_depth.unwrap_or(u32::MAX), rr_depth, hide_emitters }
}

/// What is rendered of the film, in its coordinates.
fn tiles(scene: &Scene) -> Vec<Tile> {
    let window = scene.film.window();
    let mut tiles = film::tiles(window.width, window.height, TILE);
    for tile in &mut tiles {
        tile.x += window.x;
        tile.y += window.y;
    }
    tiles
}

fn render_with<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    settings: &Settings,
    progress: &(dyn Fn(Progress) + Sync),
) -> Rendered {
    let start = Instant::now();
    let window = scene.film.window();
    let total = u64::from(window.width) * u64::from(window.height) * u64::from(scene.sampler.sample_count);
    let done = AtomicU64::new(0);
    let sample_done = |tile: &Tile| {
        let pixels = tile.len() as u64;
        progress(Progress { done: done.fetch_add(pixels, Ordering::Relaxed) + pixels, total });
    };
    let tiles = tiles(scene);
    let next = AtomicUsize::new(0);
    // Each thread takes the next tile, and keeps its memory from tile to tile.
    let thread = |_: rayon::BroadcastContext<'_>| -> Vec<(usize, TileFilm, Statistics)> {
        let arena = Bump::new();
        let mut wavefront = Wavefront::new(&arena, scene, integrator, settings.sort);
        let mut finished = Vec::new();
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(tile) = tiles.get(place) else { return finished };
            let (mut statistics, sample_done) = (Statistics::default(), || sample_done(tile));
            let film = match settings.backend {
                Backend::Packet => wavefront.render(tile, &mut statistics, sample_done),
                Backend::Scalar => reference::render(scene, integrator, tile, &mut statistics, sample_done),
            };
            statistics.invalid_samples = film.invalid;
            statistics.first_invalid = film
                .first_invalid
                .map(|(pixel, sample)| (tile.x + pixel % tile.width, tile.y + pixel / tile.width, sample));
            finished.push((place, film, statistics));
        }
    };
    let finished = rayon::broadcast(thread);
    let mut film = Film::new(window.width, window.height, &integrator.channels());
    let mut statistics = Statistics::default();
    for (place, tile_film, tile_statistics) in finished.iter().flatten() {
        let tile = &tiles[*place];
        let place = Tile { x: tile.x - window.x, y: tile.y - window.y, ..*tile };
        film.place(&place, tile_film);
        statistics.merge(tile_statistics);
    }
    statistics.time = start.elapsed();
    Rendered { picture: film.develop(), statistics }
}
