//! A tile, eight rays at a time.
//!
//! One round takes all paths of the tile by one vertex: trace, sort by material, shade in groups of
//! eight, trace the shadow rays, add, compact. What a group has to say goes to places that belong to the
//! slot, so the order in which groups are shaded can't be seen in the picture: sorting changes no bit.

use std::time::Instant;

use bumpalo::{Bump, collections::Vec as BumpVec};

use super::aov::{AovIntegrator, Beside};
use super::camera_rays;
use super::columns::{
    Column, Column3, IntColumn, PathColumns, RayColumns, column3, fill, gather, gather3, lane_bits, scatter,
    scatter3,
};
use super::frame::Visit;
use super::integrator::{Integrator, Outgoing, Path};
use super::sort::{Sorter, for_each_unsorted_group};
use super::statistics::{Stages, Statistics};
use super::trace::{self, HitColumns};
use super::vertex::Vertex;
use crate::bvh::Tracer;
use crate::compile::Scene;
use crate::film::Tile;
use crate::geometry::PrimitiveId;
use crate::material::MaterialId;
use crate::simd::{Bits, LANES, Mask8, Real, Vec3x8, f32x8, u32x8};

/// Renders samples of a tile, for as long as the visit has any.
pub(super) fn render<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    sort: bool,
    tile: &Tile,
    visit: &Visit<'_>,
) {
    let Some(mut sample) = visit.next() else { return };
    let arena = Bump::new();
    let pixels = camera_rays::morton(tile);
    let places: Vec<u32> = pixels.iter().map(|&(x, y)| y * tile.width + x).collect();
    let mut wave = Wavefront::new(&arena, scene, integrator, sort);
    loop {
        let mut statistics = Statistics::default();
        wave.start(tile, &pixels, sample);
        wave.run(sample, &mut statistics);
        visit.finish(&statistics, |film| {
            film.add_all(&places, &wave.weights, wave.sums.iter().map(BumpVec::as_slice));
        });
        match visit.next() {
            Some(next) => sample = next,
            None => return,
        }
    }
}

/// What one sample of the pixel (x, y) brings to each channel, finite or not.
pub(super) fn sample<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    sort: bool,
    (x, y): (u32, u32),
    sample: u32,
) -> Vec<f32> {
    let arena = Bump::new();
    let mut wave = Wavefront::new(&arena, scene, integrator, sort);
    wave.start(&Tile { x, y, width: 1, height: 1 }, &[(0, 0)], sample);
    wave.run(sample, &mut Statistics::default());
    wave.sums.iter().map(|sum| sum[0]).collect()
}

struct Wavefront<'a, I> {
    scene: &'a Scene,
    integrator: &'a I,
    /// Channels of the integrator, before those of what the camera sees besides.
    lit: usize,
    beside: Option<AovIntegrator>,
    sort: bool,
    tracer: Tracer,
    paths: PathColumns<'a>,
    hits: HitColumns<'a>,
    /// Material of each hit; one more than the last material for a miss.
    keys: IntColumn<'a>,
    sorter: Sorter<'a>,
    out: Outputs<'a>,
    /// For each pixel what its sample counts.
    weights: Column<'a>,
    /// For each channel and each pixel what its paths have brought.
    sums: BumpVec<'a, Column<'a>>,
}

/// What the groups of a round have said, by slot.
struct Outputs<'a> {
    /// For each channel what the vertex adds.
    added: BumpVec<'a, Column<'a>>,
    shadows: RayColumns<'a>,
    /// Where each shadow ray's light stands in `connected`.
    shadow_target: IntColumn<'a>,
    /// Light of shadow rays: index-major, then by slot; 0 where there is none.
    connected: Column3<'a>,
    next: PathColumns<'a>,
    /// Which of `next` are paths at all. Branches of a slot stand together.
    alive: BumpVec<'a, bool>,
    /// Scratch of compaction.
    kept: IntColumn<'a>,
    branches: usize,
    slots: usize,
}

impl<'a, I: Integrator> Wavefront<'a, I> {
    fn new(arena: &'a Bump, scene: &'a Scene, integrator: &'a I, sort: bool) -> Self {
        let (lit, channels) = (integrator.channels().len(), integrator.all_channels(scene).len());
        let planes = || BumpVec::from_iter_in((0..channels).map(|_| BumpVec::new_in(arena)), arena);
        Self {
            scene,
            integrator,
            lit,
            beside: (channels > lit).then(|| AovIntegrator { channels: scene.aovs.clone() }),
            sort,
            tracer: Tracer::new(()),
            paths: PathColumns::new(arena),
            hits: HitColumns::new(arena),
            keys: BumpVec::new_in(arena),
            sorter: Sorter::new(arena, scene.materials.len() + 1),
            out: Outputs {
                added: planes(),
                shadows: RayColumns::new(arena),
                shadow_target: BumpVec::new_in(arena),
                connected: column3(arena),
                next: PathColumns::new(arena),
                alive: BumpVec::new_in(arena),
                kept: BumpVec::new_in(arena),
                branches: integrator.branches(),
                slots: 0,
            },
            weights: BumpVec::new_in(arena),
            sums: planes(),
        }
    }

    /// One path from each pixel.
    fn start(&mut self, tile: &Tile, pixels: &[(u32, u32)], sample: u32) {
        for sum in &mut self.sums {
            sum.clear();
            sum.resize(pixels.len(), 0.0);
        }
        self.weights.clear();
        self.paths.resize(pixels.len());
        for (packet, group) in pixels.chunks(LANES).enumerate() {
            let pixel = |i: usize| group[i.min(group.len() - 1)];
            let x = u32x8::from_fn(|i| tile.x + pixel(i).0);
            let y = u32x8::from_fn(|i| tile.y + pixel(i).1);
            let path = Path::start(camera_rays::keys::<f32x8>(self.scene, x, y), sample);
            let (ray, weight) = camera_rays::rays::<f32x8>(self.scene, x, y, &path);
            let at = std::array::from_fn(|i| (packet * LANES + i) as u32);
            self.paths.store(&at, (1 << group.len()) - 1, (ray.org, ray.dir, ray.t_far), &path);
            self.weights.extend((0..group.len()).map(|i| weight.lane(i)));
            for (i, slot) in at.into_iter().enumerate().take(group.len()) {
                self.paths.pixel[slot as usize] = (packet * LANES + i) as u32;
            }
        }
    }

    /// All rounds of a sample.
    fn run(&mut self, sample: u32, statistics: &mut Statistics) {
        let mut depth = 0;
        while self.paths.len > 0 {
            let start = Instant::now();
            let mut traced = start;
            if depth == 0 && self.integrator.begins() {
                self.begin(sample, statistics);
            } else {
                self.trace(depth, statistics);
                traced = Instant::now();
                self.shade(depth, sample, statistics);
            }
            let shaded = Instant::now();
            self.connect(statistics);
            let connected = Instant::now();
            self.add(depth);
            self.advance();
            depth += 1;
            statistics.stages += Stages {
                trace: traced - start,
                shade: shaded - traced,
                connect: connected - shaded,
                add: connected.elapsed(),
            };
        }
    }

    fn trace(&mut self, depth: u32, statistics: &mut Statistics) {
        let Self { scene, paths, hits, tracer, .. } = self;
        let rays = if depth == 0 { &mut statistics.camera_rays } else { &mut statistics.bounce_rays };
        *rays += paths.len as u64;
        statistics.trace_lanes += trace::closest(scene, &paths.rays, paths.len, hits, tracer);
    }

    /// The first round of paths that begin without a camera.
    fn begin(&mut self, sample: u32, statistics: &mut Statistics) {
        let Self { scene, integrator, paths, out, .. } = self;
        out.clear(paths.len, integrator.shadow_rays(scene), usize::MAX);
        let all: BumpVec<u32> = BumpVec::from_iter_in(0..paths.len as u32, out.kept.bump());
        for slots in all.chunks(LANES) {
            statistics.shade_lanes.add(slots.len() as u32);
            let mut group = Group { slots: fill(slots), count: slots.len(), out };
            let path = paths.path(&group.slots, 0, sample);
            integrator.begin(scene, &path, &mut group);
        }
    }

    fn shade(&mut self, depth: u32, sample: u32, statistics: &mut Statistics) {
        let Self { scene, integrator, lit, beside, paths, hits, keys, sorter, out, .. } = self;
        let beside = beside.as_ref().filter(|_| depth == 0);
        let channels = if depth == 0 { usize::MAX } else { *lit };
        out.clear(paths.len, integrator.shadow_rays(scene), channels);
        let miss = scene.materials.len() as u32;
        keys.clear();
        let found = hits.primitive[..paths.len].iter().zip(&hits.u);
        keys.extend(found.map(|(&primitive, &u)| match PrimitiveId(primitive) {
            PrimitiveId::NONE => miss,
            hit => scene.material(hit, u).0,
        }));
        let group = |key: u32, slots: &[u32]| {
            statistics.shade_lanes.add(slots.len() as u32);
            let mut group = Group { slots: fill(slots), count: slots.len(), out };
            let at = group.slots;
            let path = paths.path(&at, depth, sample);
            let (org, dir) = (gather3(&paths.rays.org, &at), gather3(&paths.rays.dir, &at));
            if key == miss {
                integrator.miss(scene, &path, (org, dir), &mut group);
                if let Some(beside) = beside {
                    beside.miss(scene, &path, (org, dir), &mut Beside { out: &mut group, first: *lit });
                }
                return;
            }
            let tuv = (gather(&hits.t, &at), gather(&hits.u, &at), gather(&hits.v, &at));
            let primitive = u32x8::from_fn(|i| hits.primitive[at[i] as usize]);
            let vertex = Vertex::new(scene, path, (org, dir), tuv, primitive, MaterialId(key));
            integrator.shade(scene, &vertex, &mut group);
            if let Some(beside) = beside {
                beside.shade(scene, &vertex, &mut Beside { out: &mut group, first: *lit });
            }
        };
        if self.sort {
            sorter.sort(keys);
            sorter.for_each_group(group);
        } else {
            for_each_unsorted_group(keys, group);
        }
    }

    /// Takes back the light of shadow rays that are blocked.
    fn connect(&mut self, statistics: &mut Statistics) {
        let Outputs { shadows, shadow_target, connected, .. } = &mut self.out;
        let len = shadow_target.len();
        statistics.shadow_rays += len as u64;
        shadows.resize(len.next_multiple_of(LANES));
        let used = trace::occluded(self.scene, shadows, len, &mut self.tracer, |ray| {
            connected.iter_mut().for_each(|channel| channel[shadow_target[ray] as usize] = 0.0);
        });
        statistics.trace_lanes += used;
    }

    /// Adds each vertex to its pixel: vertices in the order of slots, light in the order of its index.
    fn add(&mut self, depth: u32) {
        let Self { paths, out, sums, integrator, scene, lit, .. } = self;
        let shadows = integrator.shadow_rays(scene);
        for (c, (sum, added)) in sums.iter_mut().zip(&out.added).enumerate() {
            if c >= *lit {
                if depth == 0 {
                    paths.pixel[..paths.len]
                        .iter()
                        .zip(added)
                        .for_each(|(&pixel, value)| sum[pixel as usize] += value);
                }
                continue;
            }
            for slot in 0..paths.len {
                let mut value = added[slot];
                for index in 0..shadows {
                    value += out.connected[c][index * out.slots + slot];
                }
                sum[paths.pixel[slot] as usize] += value;
            }
        }
    }

    /// The rays that go on become the next round's.
    fn advance(&mut self) {
        let Self { paths, out, .. } = self;
        for slot in 0..paths.len * out.branches {
            out.next.pixel[slot] = paths.pixel[slot / out.branches];
        }
        out.next.compact(&out.alive, &mut out.kept);
        std::mem::swap(paths, &mut out.next);
    }
}

impl Outputs<'_> {
    /// Makes room for this round, in the first `channels` of them.
    fn clear(&mut self, slots: usize, shadows: usize, channels: usize) {
        self.slots = slots;
        for channel in self.added.iter_mut().take(channels) {
            channel.clear();
            channel.resize(slots, 0.0);
        }
        self.shadows.resize(0);
        self.shadow_target.clear();
        for channel in &mut self.connected {
            channel.clear();
            channel.resize(slots * shadows, 0.0);
        }
        self.next.resize(slots * self.branches);
        self.alive.clear();
        self.alive.resize(slots * self.branches, false);
    }
}

/// A group of at most eight slots that is being shaded.
struct Group<'g, 'a> {
    slots: [u32; LANES],
    count: usize,
    out: &'g mut Outputs<'a>,
}

impl Outgoing<f32x8> for Group<'_, '_> {
    fn add(&mut self, channel: usize, value: f32x8) {
        scatter(&mut self.out.added[channel], &self.slots, (1 << self.count) - 1, value);
    }

    fn shadow(&mut self, index: usize, lanes: Mask8, ray: (Vec3x8, Vec3x8, f32x8), radiance: Vec3x8) {
        let lanes = lane_bits(lanes, self.count);
        let slots = self.out.slots;
        let target = self.slots.map(|slot| (index * slots) as u32 + slot);
        self.out.shadows.push(lanes, ray);
        self.out.shadow_target.extend((0..LANES).filter(|i| lanes >> i & 1 != 0).map(|i| target[i]));
        scatter3(&mut self.out.connected, &target, lanes, radiance);
    }

    fn next(&mut self, index: usize, lanes: Mask8, (org, dir): (Vec3x8, Vec3x8), path: &Path<f32x8>) {
        let lanes = lane_bits(lanes, self.count);
        let branches = self.out.branches;
        let at = self.slots.map(|slot| slot * branches as u32 + index as u32);
        self.out.next.store(&at, lanes, (org, dir, f32x8::splat(f32::INFINITY)), path);
        for i in (0..LANES).filter(|i| lanes >> i & 1 != 0) {
            self.out.alive[at[i] as usize] = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_beyond_the_count_say_nothing() {
        let arena = Bump::new();
        let mut column = BumpVec::from_iter_in([0.0; 16], &arena);
        scatter(&mut column, &fill(&[3, 9]), lane_bits(Mask8::first(8), 2), f32x8::splat(1.0));
        assert_eq!(column.iter().sum::<f32>(), 2.0);
        assert_eq!(u32x8::from_fn(|i| fill(&[3, 9])[i]).lane(7), 9);
    }
}
