//! A picture while it is being made: what threads add to, and what anybody may look at meanwhile.
//!
//! A tile is behind a lock, which a thread takes for as long as it adds some samples. In between, whoever wants
//! to keep what there is copies it, tile by tile; tiles may have different numbers of samples then, each of
//! them whole. Threads go through the picture in passes that end at 1, 2, 4, 8 … samples, so that a picture
//! that is stopped early has no holes, and no tile has less than half the samples of another.

mod visit;

use std::{
    cell::RefCell,
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use bumpalo::Bump;
use rayon::prelude::*;

use super::{
    Backend, Progress, Rendered, Settings,
    integrator::Integrator,
    part::{Part, PartTile},
    reference,
    shard::Shard,
    statistics::Statistics,
    wavefront::Wavefront,
};
use crate::{
    bvh::Tracer,
    compile::Scene,
    film::{self, Film, Tile, TileFilm, spread::Spread, sums::Sums},
    picture::{Picture, Place},
    scene::Crop,
};

pub(super) use visit::{Visit, most_together};

/// Side of a tile in pixels: a thousand of them, so that what eight samples bring stays in a core's second-level cache.
pub(super) const TILE: u32 = 32;

/// What is to be rendered of a scene, and how well.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plan {
    /// Which part of it.
    pub shard: Shard,
    /// A tile is done when its relative error is as small as this; `None` takes all samples. See
    /// [`Spread`].
    pub target_error: Option<f32>,
}

/// Who watches a render.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Is called from the threads, now and then.
    pub progress: &'a (dyn Fn(Progress) + Sync),
    /// Is asked before a tile takes its next samples, which are 8 at most; after a `true` nothing more is begun.
    pub stop: &'a (dyn Fn() -> bool + Sync),
}

/// How much of a frame is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coverage {
    /// Samples of the pixels that have the fewest.
    pub least: u32,
    /// Samples of the pixels that have the most.
    pub most: u32,
    /// Is nothing left to do?
    pub complete: bool,
}

/// A tile as it was when somebody looked.
#[derive(Clone, Debug)]
pub struct TileView {
    /// First column, in the picture.
    pub x: u32,
    /// First row, in the picture.
    pub y: u32,
    /// Samples a pixel that it has.
    pub samples: u32,
    /// Their means.
    pub picture: Picture,
}

/// A picture that is being rendered.
#[derive(Debug)]
pub struct Frame {
    plan: Plan,
    /// Samples a pixel that are asked for.
    samples: u32,
    window: Crop,
    /// Where the window is in the film, if it is not all of it.
    place: Option<Place>,
    channels: Vec<String>,
    cells: Vec<Cell>,
    /// What was spent on it before it was resumed.
    earlier: Duration,
    started: Mutex<Option<Instant>>,
}

/// What a thread works in.
struct Memory {
    arena: Bump,
    tracer: Tracer,
    /// Of sums that are not needed any more: one, or none.
    spare: Vec<Sums>,
}

impl Default for Memory {
    fn default() -> Self {
        Self { arena: Bump::new(), tracer: Tracer::new(()), spare: Vec::new() }
    }
}

/// A tile of the plan.
#[derive(Debug)]
struct Cell {
    /// Among all tiles of the window, row by row.
    number: u32,
    /// In coordinates of the film.
    tile: Tile,
    state: Mutex<State>,
}

#[derive(Clone, Debug)]
struct State {
    film: TileFilm,
    statistics: Statistics,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // A thread that panics takes the whole render with it; what is behind the lock is whole nevertheless.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Tiles of a part of a film, in the film's coordinates.
pub(super) fn tiles(window: Crop) -> Vec<Tile> {
    let mut tiles = film::tiles(window.width, window.height, TILE);
    for tile in &mut tiles {
        tile.x += window.x;
        tile.y += window.y;
    }
    tiles
}

impl Frame {
    /// Nothing yet of a plan.
    pub(super) fn with_channels(scene: &Scene, channels: Vec<String>, plan: Plan) -> Self {
        let (window, place) = (scene.film.window(), scene.film.place());
        let samples = scene.sampler.sample_count;
        let first = plan.shard.samples(samples).start;
        let cell = |(number, tile): (u32, Tile)| {
            let mut film = TileFilm::new(tile.len(), channels.len(), first);
            film.spread = plan.target_error.map(|_| Spread::new(tile.len()));
            Cell { number, tile, state: Mutex::new(State { film, statistics: Statistics::default() }) }
        };
        let tiles = (0..).zip(tiles(window)).filter(|(number, _)| plan.shard.has_tile(*number));
        let cells = tiles.map(cell).collect();
        let (earlier, started) = (Duration::ZERO, Mutex::new(None));
        Self { plan, samples, window, place, channels, cells, earlier, started }
    }

    /// Takes over what a part has, which belongs here.
    pub(super) fn adopt(&mut self, part: Part) {
        self.earlier = part.time;
        for PartTile { number, film, statistics } in part.tiles {
            if let Ok(at) = self.cells.binary_search_by_key(&number, |cell| cell.number) {
                self.cells[at].state = Mutex::new(State { film, statistics });
            }
        }
    }

    /// Renders what is missing, on the current rayon pool.
    pub(super) fn run<I: Integrator>(
        &self,
        scene: &Scene,
        integrator: &I,
        settings: &Settings,
        watch: &Watch<'_>,
    ) {
        *lock(&self.started) = Some(Instant::now());
        let range = self.plan.shard.samples(self.samples);
        let pixels = |cell: &Cell| cell.tile.len() as u64;
        let total = self.cells.iter().map(pixels).sum::<u64>() * range.len() as u64;
        let there = |cell: &Cell| pixels(cell) * lock(&cell.state).film.samples.len() as u64;
        let done = AtomicU64::new(self.cells.iter().map(there).sum());
        // Each thread takes the next tile, and keeps its memory from tile to tile and from pass to pass.
        let memory: Vec<Mutex<Memory>> =
            (0..rayon::current_num_threads()).map(|_| Mutex::default()).collect();
        for end in passes(range.end - range.start) {
            let until = range.start + end;
            let next = AtomicUsize::new(0);
            let take = || self.cells.get(next.fetch_add(1, Ordering::Relaxed));
            rayon::broadcast(|thread| {
                let Some(first) = take() else { return };
                let Memory { arena, tracer, spare } = &mut *lock(&memory[thread.index()]);
                arena.reset();
                let spare = RefCell::new(spare);
                let mut wavefront = Wavefront::new((arena, tracer), scene, integrator, settings);
                for cell in std::iter::once(first).chain(std::iter::from_fn(take)) {
                    let visit = Visit { cell, frame: self, until, total, done: &done, watch, spare: &spare };
                    match settings.backend {
                        Backend::Packet => wavefront.render(&cell.tile, &visit),
                        Backend::Scalar => reference::render(scene, integrator, &cell.tile, &visit),
                    }
                }
            });
        }
    }

    /// What there is now, from whatever thread.
    pub fn part(&self, scene: &str, facts: &[(String, String)]) -> Part {
        let tile = |cell: &Cell| {
            let State { film, statistics } = lock(&cell.state).clone();
            PartTile { number: cell.number, film, statistics }
        };
        Part {
            facts: facts.to_vec(),
            scene: scene.to_owned(),
            channels: self.channels.clone(),
            width: self.window.width,
            height: self.window.height,
            place: self.place,
            samples: self.samples,
            plan: self.plan,
            time: self.time(),
            tiles: self.cells.iter().map(tile).collect(),
        }
    }

    fn time(&self) -> Duration {
        self.earlier + lock(&self.started).map_or(Duration::ZERO, |start| start.elapsed())
    }

    /// Samples a pixel that are asked for.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// What is to be rendered.
    pub fn plan(&self) -> Plan {
        self.plan
    }

    /// How much of it is there.
    pub fn coverage(&self) -> Coverage {
        let mut coverage = Coverage { least: u32::MAX, most: 0, complete: true };
        let range = self.plan.shard.samples(self.samples);
        for cell in &self.cells {
            let film = &lock(&cell.state).film;
            let count = film.samples.len() as u32;
            coverage.least = coverage.least.min(count);
            coverage.most = coverage.most.max(count);
            coverage.complete &= film.is_done(range.end, self.plan.target_error);
        }
        coverage.least = coverage.least.min(coverage.most);
        coverage
    }

    /// Columns and rows of the picture.
    pub fn size(&self) -> [u32; 2] {
        [self.window.width, self.window.height]
    }

    /// The picture's channels, by name.
    pub fn channels(&self) -> &[String] {
        &self.channels
    }

    /// Tiles that are to be rendered.
    pub fn tiles(&self) -> usize {
        self.cells.len()
    }

    /// One of the tiles as it is now, if it has samples, and others than the `seen` that somebody has seen.
    ///
    /// # Panics
    /// If there is no such tile.
    pub fn tile(&self, index: usize, seen: u32) -> Option<TileView> {
        let cell = &self.cells[index];
        let (samples, total) = {
            let state = lock(&cell.state);
            let film = &state.film;
            let samples = film.samples.len() as u32;
            (samples != seen).then(|| (samples, film.total().into_owned()))?
        };
        let Tile { x, y, width, height } = cell.tile;
        let mut film = Film::new(width, height, &self.channels);
        film.place(&Tile { x: 0, y: 0, width, height }, &total);
        Some(TileView { x: x - self.window.x, y: y - self.window.y, samples, picture: film.develop() })
    }

    /// Tiles side by side, from top to bottom; not all are of the plan.
    fn rows(&self) -> Vec<&[Cell]> {
        let (columns, rows) = (self.window.width.div_ceil(TILE), self.window.height.div_ceil(TILE));
        let before = |row: u32| self.cells.partition_point(|cell| cell.number < row * columns);
        (0..rows).map(|row| &self.cells[before(row)..before(row + 1)]).collect()
    }

    /// The picture as it is now, and what it took, on the current rayon pool.
    pub fn develop(&self) -> Rendered {
        let mut film = Film::new(self.window.width, self.window.height, &self.channels);
        let mut statistics = Statistics::default();
        self.cells.iter().for_each(|cell| statistics.merge(&lock(&cell.state).statistics));
        // Whoever writes to a page first makes the system find one: a band's pages are found by its own thread.
        film.bands(TILE).into_par_iter().zip(self.rows()).for_each(|(mut band, cells)| {
            for cell in cells {
                let Tile { x, y, .. } = cell.tile;
                let place = Tile { x: x - self.window.x, y: y - self.window.y, ..cell.tile };
                band.place(&place, &lock(&cell.state).film.total());
            }
        });
        statistics.time = self.time();
        Rendered { picture: Picture { place: self.place, ..film.develop() }, statistics }
    }
}

/// Into how many tiles a part of a film is divided.
pub fn tile_count(window: Crop) -> usize {
    window.width.div_ceil(TILE) as usize * window.height.div_ceil(TILE) as usize
}

/// Where passes over so many samples end.
fn passes(samples: u32) -> impl Iterator<Item = u32> {
    let ends = (0..32).map(|power| 1u32 << power).take_while(move |&end| end < samples);
    ends.chain((samples > 0).then_some(samples))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_double_and_end_where_they_should() {
        let ends = |samples| passes(samples).collect::<Vec<_>>();
        assert_eq!(ends(0), [0; 0]);
        assert_eq!(ends(1), [1]);
        assert_eq!(ends(3), [1, 2, 3]);
        assert_eq!(ends(16), [1, 2, 4, 8, 16]);
        assert_eq!(ends(u32::MAX).len(), 33);
    }
}
