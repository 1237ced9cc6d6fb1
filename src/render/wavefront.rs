//! A tile, eight rays at a time and more.
//!
//! One round takes all paths of the tile by one vertex: trace, sort by material, shade in groups of
//! eight or sixteen, trace the shadow rays, add, compact. What a group has to say goes to places that belong to the
//! slot, so the order in which groups are shaded can't be seen in the picture: sorting changes no bit.

use std::{ops::Range, time::Instant};

use bumpalo::{Bump, collections::Vec as BumpVec};

use super::Settings;
use super::camera_rays::{self, Pixels};
use super::census::{Census, Probe};
use super::connections::Connections;
use super::frame::Visit;
use super::group::{Group, Outputs};
use super::integrator::{Integrator, Path};
use super::layers::Layers;
use super::rows::{Hits, Packet, Paths, reserve};
use super::shading::Shading;
use super::sort::{Sorter, for_each_unsorted_group};
use super::statistics::{Stage, Statistics};
use super::trace::{self, Route};
use crate::bvh::Tracer;
use crate::compile::Scene;
use crate::film::{
    Samples, Tile,
    sums::{Quad, WEIGHT, place, quads},
};
use crate::geometry::PrimitiveId;
use crate::simd::{Bits, LANES, f32x8, u32x8};

/// Paths in flight, at most: the more there are, the more of them meet the same things and the fuller are groups, as long
/// as their rows stay in a core's second-level cache.
const PATHS: usize = 4096;

/// So many of them where each asks for so many shadow rays, which have rows of their own: a power of two.
pub(super) fn paths_at_once(shadow_rays: usize) -> usize {
    let paths = (4 * PATHS / shadow_rays.max(1)).clamp(PATHS / 4, PATHS);
    1 << paths.ilog2()
}

/// What one thread needs to render tiles, one after the other.
pub(super) struct Wavefront<'a, I> {
    scene: &'a Scene,
    integrator: &'a I,
    /// What the camera sees besides, in channels behind those of the integrator.
    layers: Option<Layers<'a>>,
    sort: bool,
    channels: usize,
    route: Route,
    tracer: &'a mut Tracer,
    paths: Paths<'a>,
    hits: Hits<'a>,
    /// Material of each hit; one more than the last material for a miss.
    keys: BumpVec<'a, u32>,
    sorter: Sorter<'a>,
    out: Outputs<'a>,
    /// Where the first rays of packets are on the film.
    points: BumpVec<'a, (f32x8, f32x8)>,
    /// What the sample of each pixel counts, in the order of the first paths.
    weights: BumpVec<'a, f32>,
    /// What a pixel's paths have brought, pixel after pixel, each in a row as the film has them; of layers, no more than
    /// shares a quad with the last of the integrator's channels.
    sums: BumpVec<'a, Quad>,
    /// In a row of `sums`.
    quads: usize,
    /// Looks on where rays are counted, not rendered.
    probe: Option<Box<Probe>>,
}

impl<'a, I: Integrator> Wavefront<'a, I> {
    pub(super) fn new(
        (arena, tracer): (&'a Bump, &'a mut Tracer),
        scene: &'a Scene,
        integrator: &'a I,
        settings: &Settings,
    ) -> Self {
        let (lit, channels) = (integrator.channels().len(), integrator.all_channels(scene).len());
        let layers = (channels > lit).then(|| Layers::new(arena, scene, lit..channels));
        Self {
            scene,
            integrator,
            layers,
            sort: settings.sort,
            channels,
            route: settings.route,
            tracer,
            paths: Paths::new(arena),
            hits: Hits::new(arena),
            keys: BumpVec::new_in(arena),
            sorter: Sorter::new(arena, scene.materials.len() + 1),
            out: Outputs {
                quads: quads(lit),
                added: BumpVec::new_in(arena),
                connections: Connections::new(arena),
                next: Paths::new(arena),
                alive: BumpVec::new_in(arena),
                branches: integrator.branches(),
            },
            points: BumpVec::new_in(arena),
            weights: BumpVec::new_in(arena),
            sums: BumpVec::new_in(arena),
            quads: quads(lit),
            probe: None,
        }
    }

    /// Samples of a tile, for as long as the visit has any.
    pub(super) fn render(&mut self, tile: &Tile, visit: &Visit<'_>) {
        let Some(mut samples) = visit.next() else { return };
        let pixels = Pixels::new(self.scene, tile);
        loop {
            let mut statistics = Statistics::default();
            self.take(&pixels, &samples, &mut statistics);
            visit.finish(samples.clone(), statistics, |film| self.deliver(&pixels, film, samples.len()));
            match visit.next() {
                Some(next) => samples = next,
                None => return,
            }
        }
    }

    /// Adds what so many samples have brought to the film.
    fn deliver(&self, pixels: &Pixels, film: &mut Samples<'_>, count: usize) {
        for (pixel, &path) in pixels.paths.iter().enumerate() {
            let paths = path as usize * count..(path as usize + 1) * count;
            let sums = &self.sums[paths.start * self.quads..paths.end * self.quads];
            let layers = self.layers.as_ref().map_or(&[][..], |layers| layers.rows(paths.clone()));
            film.add_rows(pixel, &self.weights[paths], sums, layers);
        }
    }

    /// What one sample of the pixel (x, y) brings to each channel, finite or not.
    pub(super) fn sample(&mut self, (x, y): (u32, u32), sample: u32) -> Vec<f32> {
        let pixels = Pixels::new(self.scene, &Tile { x, y, width: 1, height: 1 });
        self.take(&pixels, &(sample..sample + 1), &mut Statistics::default());
        let layers = self.layers.as_ref().map_or(&[][..], |layers| layers.rows(0..1));
        let layers = layers.iter().flat_map(|eight| eight.to_array());
        let row: Vec<f32> = self.sums.iter().flatten().copied().chain(layers).collect();
        (0..self.channels).map(|channel| row[place(channel)]).collect()
    }

    /// What one sample of a tile does.
    pub(super) fn census(&mut self, tile: &Tile, sample: u32) -> Census {
        self.probe = Some(Box::new(Probe::new()));
        self.take(&Pixels::new(self.scene, tile), &(sample..sample + 1), &mut Statistics::default());
        self.probe.take().map_or_else(Census::default, |probe| probe.finish())
    }

    /// Samples of each pixel: the more of them, the fewer pixels at once.
    fn take(&mut self, pixels: &Pixels, samples: &Range<u32>, statistics: &mut Statistics) {
        let start = Instant::now();
        self.clear(pixels.len() * samples.len());
        statistics.spend(Stage::Shade, start);
        let some = paths_at_once(self.integrator.shadow_rays(self.scene)) / samples.len();
        for first in (0..pixels.len()).step_by(some) {
            let start = Instant::now();
            self.start(pixels, first..pixels.len().min(first + some), samples);
            statistics.spend(Stage::Shade, start);
            self.run(statistics);
        }
    }

    /// Nothing yet, for so many paths.
    fn clear(&mut self, len: usize) {
        self.sums.clear();
        self.sums.resize(len * self.quads, [0.0; 4]);
        self.sums.chunks_exact_mut(self.quads).for_each(|row| row[0][WEIGHT] = 1.0);
        if let Some(layers) = &mut self.layers {
            layers.reserve(len);
        }
        self.weights.clear();
    }

    /// A path from each of some pixels for each of the samples; those of a pixel are neighbours.
    fn start(&mut self, pixels: &Pixels, some: Range<usize>, samples: &Range<u32>) {
        let count = samples.len();
        let (before, len) = (some.start * count, some.len() * count);
        self.paths.reserve(len);
        self.points.clear();
        let packets = (0..len).step_by(LANES).map(|first| {
            let slots = u32x8::from_fn(|i| (first + i) as u32);
            let sample = (slots & u32x8::splat(count as u32 - 1)).wrapping_add(u32x8::splat(samples.start));
            let [x, y, key] = pixels.packet(some.start + first / count, count);
            (slots, (x, y), Path::<f32x8>::start(key, sample))
        });
        // By itself: random numbers are long chains of short steps, of which several packets' go on at once.
        for (_, (x, y), path) in packets.clone() {
            let (point, weight) = camera_rays::points(self.scene, x, y, &path);
            self.points.push(point);
            self.weights.extend_from_slice(&weight.to_array());
        }
        for ((slots, _, path), &point) in packets.zip(&self.points) {
            let ray = camera_rays::through(self.scene, point, &path);
            let pixel = slots.wrapping_add(u32x8::splat(before as u32));
            let packet = Packet { org: ray.org, dir: ray.dir, t_far: ray.t_far, path, pixel };
            self.paths.store(&slots.to_array(), &packet);
        }
        reserve(&mut self.out.alive, len, false);
        let alive = &mut self.out.alive[..len.next_multiple_of(LANES)];
        alive[..len].fill(true);
        alive[len..].fill(false);
        self.paths.keep(alive);
    }

    /// All rounds of the paths that have been started.
    fn run(&mut self, statistics: &mut Statistics) {
        let mut depth = 0;
        while self.paths.len > 0 {
            self.out.clear(self.paths.len, self.integrator.shadow_rays(self.scene));
            if depth == 0 && self.integrator.begins() {
                self.begin(statistics);
            } else {
                self.trace(depth, statistics);
                self.shade(depth, statistics);
                if let Some(probe) = &mut self.probe {
                    probe.ends(&self.paths, &self.hits, &self.out.alive, self.out.branches);
                }
            }
            self.connect(statistics);
            let start = Instant::now();
            self.add();
            let places = (self.paths.len * self.out.branches).next_multiple_of(LANES);
            std::mem::swap(&mut self.paths, &mut self.out.next);
            self.paths.keep(&self.out.alive[..places]);
            // What several paths bring to one pixel is added in the order of slots.
            if self.out.branches == 1 {
                self.paths.order_by_octant();
            }
            statistics.spend(Stage::Add, start);
            depth += 1;
        }
    }

    fn trace(&mut self, depth: u32, statistics: &mut Statistics) {
        let start = Instant::now();
        let rays = if depth == 0 { &mut statistics.camera_rays } else { &mut statistics.bounce_rays };
        *rays += self.paths.len as u64;
        let Self { scene, paths, hits, route, tracer, probe, .. } = self;
        statistics.trace_lanes += match probe {
            None => trace::closest(scene, paths, hits, *route, tracer),
            Some(probe) => probe.closest(scene, paths, hits, depth),
        };
        statistics.spend(Stage::Trace, start);
    }

    /// The first round of paths that begin without a camera.
    fn begin(&mut self, statistics: &mut Statistics) {
        let Self { scene, integrator, paths, out, .. } = self;
        for first in (0..paths.len as u32).step_by(LANES) {
            let slots = std::array::from_fn(|i| (first + i as u32).min(paths.len as u32 - 1));
            let count = (paths.len - first as usize).min(LANES);
            statistics.shade_lanes.add(count as u32);
            let Packet::<f32x8> { path, pixel, .. } = paths.packet(&slots, 0);
            integrator.begin(scene, &path, &mut Group { slots, count, pixel, out, ends: None });
        }
    }

    fn shade(&mut self, depth: u32, statistics: &mut Statistics) {
        let start = Instant::now();
        let Self { scene, integrator, layers, paths, hits, keys, sorter, out, sums, probe, .. } = self;
        // What the camera sees besides is said in the first round.
        let layers = layers.as_mut().filter(|_| depth == 0);
        let miss = scene.materials.len() as u32;
        reserve(keys, paths.len, miss);
        let keys = &mut keys[..paths.len];
        for (slot, key) in keys.iter_mut().enumerate() {
            *key = match hits.primitive(slot) {
                (PrimitiveId::NONE, _) => miss,
                (hit, u) => scene.material(hit, u).0,
            };
        }
        if self.sort {
            sorter.sort(keys);
        }
        if let Some(probe) = probe {
            probe.groups(keys, scene.materials.len() + 1);
        }
        let ends = probe.as_deref_mut().map(|probe| &mut probe.census.ends);
        let start = statistics.spend(Stage::Sort, start);
        let lanes = &mut statistics.shade_lanes;
        let mut shading =
            Shading { scene, integrator: *integrator, paths, hits, out, layers, sums, ends, depth, miss };
        let group = |key: u32, slots: &[u32]| {
            lanes.add(slots.len() as u32);
            shading.group(key, slots);
        };
        if self.sort {
            sorter.for_each_group(group);
        } else {
            for_each_unsorted_group(keys, group);
        }
        statistics.spend(Stage::Shade, start);
    }

    /// Takes back the light of shadow rays that are blocked.
    fn connect(&mut self, statistics: &mut Statistics) {
        let start = Instant::now();
        statistics.shadow_rays += self.out.connections.len as u64;
        self.out.connections.order_by_octant();
        let Self { scene, out: Outputs { connections, .. }, route, tracer, probe, .. } = self;
        statistics.trace_lanes += match probe {
            None => trace::occluded(scene, connections, *route, tracer),
            Some(probe) => probe.occluded(scene, connections),
        };
        statistics.spend(Stage::Trace, start);
    }

    /// Adds each vertex to its pixel: vertices in the order of slots, light in the order of its index.
    fn add(&mut self) {
        let Self { paths, out: Outputs { quads: lit, added, connections, .. }, sums, quads, .. } = self;
        let lit = *lit;
        for (slot, light) in connections.iter() {
            let added = &mut added[slot * lit];
            *added = std::array::from_fn(|c| added[c] + light[c]);
        }
        if lit == 1 {
            for (slot, values) in added.iter().enumerate() {
                let sums = &mut sums[paths.pixel(slot) * *quads];
                *sums = std::array::from_fn(|c| sums[c] + values[c]);
            }
            return;
        }
        for (slot, values) in added.chunks_exact(lit).enumerate() {
            let sums = &mut sums[paths.pixel(slot) * *quads..][..lit];
            for (sums, values) in sums.iter_mut().zip(values) {
                *sums = std::array::from_fn(|c| sums[c] + values[c]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_whole_packets_and_fewer_where_each_asks_for_many_shadow_rays() {
        assert_eq!([0, 1, 4, 5, 8, 16, 1000].map(paths_at_once), [4096, 4096, 4096, 2048, 2048, 1024, 1024]);
    }
}
