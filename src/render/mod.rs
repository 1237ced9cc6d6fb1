//! Scene to film.
//!
//! Tiles are handed to the threads of the current rayon pool. A tile is rendered by the wavefront (eight
//! rays at a time) or by the reference (one), and both call the same integrators.

mod aov;
mod camera_rays;
mod columns;
mod direct;
mod integrator;
pub mod measure;
mod path;
mod ray_classes;
mod reference;
mod sort;
mod statistics;
mod trace;
mod vertex;
mod wavefront;
mod whitted;

use std::{
    sync::atomic::{AtomicU64, Ordering},
    time::Instant,
};

pub use ray_classes::{Query, RayClass, ray_classes};
use rayon::prelude::*;
pub use statistics::{LaneUse, Statistics};

use crate::{
    compile::Scene,
    film::{self, Film, Tile, TileFilm},
    picture::Picture,
    scene,
};
use integrator::Integrator;

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
    /// `R G B`, or the channels of the AOV integrator.
    pub picture: Picture,
    /// What it took.
    pub statistics: Statistics,
}

/// Renders on the current rayon pool. `progress` is called from its threads, now and then.
pub fn render(scene: &Scene, settings: &Settings, progress: &(dyn Fn(Progress) + Sync)) -> Rendered {
    match scene.integrator.clone() {
        scene::Integrator::Path { max_depth, rr_depth, hide_emitters } => {
            let max_depth = max_depth.unwrap_or(u32::MAX);
            render_with(scene, &path::PathTracer { max_depth, rr_depth, hide_emitters }, settings, progress)
        }
        scene::Integrator::Direct { hide_emitters } => {
            render_with(scene, &direct::Direct { hide_emitters }, settings, progress)
        }
        scene::Integrator::Whitted { max_depth } => {
            render_with(scene, &whitted::Whitted { max_depth }, settings, progress)
        }
        scene::Integrator::Aov { channels } => {
            render_with(scene, &aov::AovIntegrator { channels }, settings, progress)
        }
    }
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
    let render_tile = |tile: &Tile| -> (TileFilm, Statistics) {
        let mut statistics = Statistics::default();
        let sample_done = || {
            let pixels = tile.len() as u64;
            progress(Progress { done: done.fetch_add(pixels, Ordering::Relaxed) + pixels, total });
        };
        let film = match settings.backend {
            Backend::Packet => {
                wavefront::render(scene, integrator, settings.sort, tile, &mut statistics, sample_done)
            }
            Backend::Scalar => reference::render(scene, integrator, tile, &mut statistics, sample_done),
        };
        statistics.invalid_samples = film.invalid;
        statistics.first_invalid = film
            .first_invalid
            .map(|(pixel, sample)| (tile.x + pixel % tile.width, tile.y + pixel / tile.width, sample));
        (film, statistics)
    };
    let tiles = tiles(scene);
    let finished: Vec<_> = tiles.par_iter().with_max_len(1).map(render_tile).collect();
    let mut film = Film::new(window.width, window.height, &integrator.channels());
    let mut statistics = Statistics::default();
    for (tile, (tile_film, tile_statistics)) in tiles.iter().zip(&finished) {
        let place = Tile { x: tile.x - window.x, y: tile.y - window.y, ..*tile };
        film.place(&place, tile_film);
        statistics.merge(tile_statistics);
    }
    statistics.time = start.elapsed();
    Rendered { picture: film.develop(), statistics }
}
