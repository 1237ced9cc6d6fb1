//! A tile, eight rays at a time.
//!
//! One round takes all paths of the tile by one vertex: trace, sort by material, shade in groups of
//! eight, trace the shadow rays, add, compact. What a group has to say goes to places that belong to the
//! slot, so the order in which groups are shaded can't be seen in the picture: sorting changes no bit.

use std::time::Instant;

use bumpalo::{Bump, collections::Vec as BumpVec};

use super::aov::{AovIntegrator, Beside};
use super::camera_rays::{self, Pixels};
use super::census::{Census, Ends, Probe};
use super::connections::Connections;
use super::frame::Visit;
use super::integrator::{End, Integrator, Outgoing, Path};
use super::rows::{Hits, Packet, Paths, fill, reserve};
use super::sort::{Sorter, for_each_unsorted_group};
use super::statistics::{Stage, Statistics};
use super::trace;
use super::vertex::Vertex;
use crate::bvh::Tracer;
use crate::compile::Scene;
use crate::film::Tile;
use crate::geometry::PrimitiveId;
use crate::material::MaterialId;
use crate::simd::{Bits, LANES, Mask, Mask8, Real, Vec3x8, f32x8, u32x8};

/// What one thread needs to render tiles, one after the other.
pub(super) struct Wavefront<'a, I> {
    scene: &'a Scene,
    integrator: &'a I,
    /// Channels of the integrator, before those of what the camera sees besides.
    lit: usize,
    beside: Option<AovIntegrator>,
    sort: bool,
    channels: usize,
    tracer: Tracer,
    paths: Paths<'a>,
    hits: Hits<'a>,
    /// Material of each hit; one more than the last material for a miss.
    keys: BumpVec<'a, u32>,
    sorter: Sorter<'a>,
    out: Outputs<'a>,
    /// For each pixel what its sample counts.
    weights: BumpVec<'a, f32x8>,
    /// What a pixel's paths have brought, four channels at a time, pixel after pixel.
    sums: BumpVec<'a, Quad>,
    /// Looks on where rays are counted, not rendered.
    probe: Option<Box<Probe>>,
}

/// Four channels, added by one instruction.
type Quad = [f32; 4];

/// What the groups of a round have said, by slot.
struct Outputs<'a> {
    /// The channels of this round are so many quads, the last one padded.
    quads: usize,
    /// What the vertex adds, four channels at a time, slot after slot.
    added: BumpVec<'a, Quad>,
    connections: Connections<'a>,
    next: Paths<'a>,
    /// Which of `next` are paths at all. Branches of a slot stand together.
    alive: BumpVec<'a, bool>,
    branches: usize,
}

impl<'a, I: Integrator> Wavefront<'a, I> {
    pub(super) fn new(arena: &'a Bump, scene: &'a Scene, integrator: &'a I, sort: bool) -> Self {
        let (lit, channels) = (integrator.channels().len(), integrator.all_channels(scene).len());
        Self {
            scene,
            integrator,
            lit,
            beside: (channels > lit).then(|| AovIntegrator { channels: scene.aovs.clone() }),
            sort,
            channels,
            tracer: Tracer::new(()),
            paths: Paths::new(arena),
            hits: Hits::new(arena),
            keys: BumpVec::new_in(arena),
            sorter: Sorter::new(arena, scene.materials.len() + 1),
            out: Outputs {
                quads: channels.div_ceil(4),
                added: BumpVec::new_in(arena),
                connections: Connections::new(arena),
                next: Paths::new(arena),
                alive: BumpVec::new_in(arena),
                branches: integrator.branches(),
            },
            weights: BumpVec::new_in(arena),
            sums: BumpVec::new_in(arena),
            probe: None,
        }
    }

    /// Samples of a tile, for as long as the visit has any.
    pub(super) fn render(&mut self, tile: &Tile, visit: &Visit<'_>) {
        let Some(mut sample) = visit.next() else { return };
        let pixels = Pixels::new(self.scene, tile);
        loop {
            let mut statistics = Statistics::default();
            let start = Instant::now();
            self.start(&pixels, sample);
            statistics.spend(Stage::Shade, start);
            self.run(sample, &mut statistics);
            visit.finish(statistics, |film| {
                for (place, &pixel) in pixels.places.iter().enumerate() {
                    let weight = self.weights[place / LANES].lane(place % LANES);
                    let values = &self.sums[place * self.quads()..];
                    film.add(pixel as usize, weight, |c| values[c / 4][c % 4]);
                }
            });
            match visit.next() {
                Some(next) => sample = next,
                None => return,
            }
        }
    }

    /// Of all channels of a pixel.
    fn quads(&self) -> usize {
        self.channels.div_ceil(4)
    }

    /// What one sample of the pixel (x, y) brings to each channel, finite or not.
    pub(super) fn sample(&mut self, (x, y): (u32, u32), sample: u32) -> Vec<f32> {
        let pixels = Pixels::new(self.scene, &Tile { x, y, width: 1, height: 1 });
        self.start(&pixels, sample);
        self.run(sample, &mut Statistics::default());
        self.sums.iter().flatten().copied().take(self.channels).collect()
    }

    /// What one sample of a tile does.
    pub(super) fn census(&mut self, tile: &Tile, sample: u32) -> Census {
        self.probe = Some(Box::new(Probe::new()));
        self.start(&Pixels::new(self.scene, tile), sample);
        self.run(sample, &mut Statistics::default());
        self.probe.take().map_or_else(Census::default, |probe| probe.finish())
    }

    /// One path from each pixel.
    fn start(&mut self, pixels: &Pixels, sample: u32) {
        let len = pixels.places.len();
        self.sums.clear();
        let quads = self.quads();
        self.sums.resize(len * quads, [0.0; 4]);
        self.weights.clear();
        self.paths.resize(len);
        let slots = u32x8::from_fn(|i| i as u32);
        for (packet, &(x, y, key)) in pixels.packets.iter().enumerate() {
            let path = Path::start(key, sample);
            let (ray, weight) = camera_rays::rays::<f32x8>(self.scene, x, y, &path);
            self.weights.push(weight);
            let pixel = slots.wrapping_add(u32x8::splat((packet * LANES) as u32));
            let packet = Packet { org: ray.org, dir: ray.dir, t_far: ray.t_far, path, pixel };
            self.paths.store(&pixel.to_array(), &packet);
        }
    }

    /// All rounds of a sample.
    fn run(&mut self, sample: u32, statistics: &mut Statistics) {
        let mut depth = 0;
        while self.paths.len > 0 {
            // What the camera sees besides is said in the first round.
            self.out.quads = if depth == 0 { self.quads() } else { self.lit.div_ceil(4) };
            self.out.clear(self.paths.len, self.integrator.shadow_rays(self.scene));
            if depth == 0 && self.integrator.begins() {
                self.begin(sample, statistics);
            } else {
                self.trace(depth, statistics);
                self.shade(depth, sample, statistics);
                if let Some(probe) = &mut self.probe {
                    probe.ends(&self.paths, &self.hits, &self.out.alive, self.out.branches);
                }
            }
            self.connect(statistics);
            let start = Instant::now();
            self.add();
            self.paths.take(&self.out.next, &self.out.alive);
            statistics.spend(Stage::Add, start);
            depth += 1;
        }
    }

    fn trace(&mut self, depth: u32, statistics: &mut Statistics) {
        let start = Instant::now();
        let rays = if depth == 0 { &mut statistics.camera_rays } else { &mut statistics.bounce_rays };
        *rays += self.paths.len as u64;
        let Self { scene, paths, hits, tracer, probe, .. } = self;
        statistics.trace_lanes += match probe {
            None => trace::closest(scene, paths, hits, tracer),
            Some(probe) => probe.closest(scene, paths, hits, depth),
        };
        statistics.spend(Stage::Trace, start);
    }

    /// The first round of paths that begin without a camera.
    fn begin(&mut self, sample: u32, statistics: &mut Statistics) {
        let Self { scene, integrator, paths, out, .. } = self;
        for first in (0..paths.len as u32).step_by(LANES) {
            let slots = u32x8::from_fn(|i| (first + i as u32).min(paths.len as u32 - 1)).to_array();
            let count = (paths.len - first as usize).min(LANES);
            statistics.shade_lanes.add(count as u32);
            let Packet { path, pixel, .. } = paths.packet(&slots, 0, sample);
            integrator.begin(scene, &path, &mut Group { slots, count, pixel, out, ends: None });
        }
    }

    fn shade(&mut self, depth: u32, sample: u32, statistics: &mut Statistics) {
        let start = Instant::now();
        let Self { scene, integrator, lit, beside, paths, hits, keys, sorter, out, probe, .. } = self;
        let beside = beside.as_ref().filter(|_| depth == 0);
        let miss = scene.materials.len() as u32;
        keys.clear();
        keys.extend((0..paths.len).map(|slot| match hits.primitive(slot) {
            (PrimitiveId::NONE, _) => miss,
            (hit, u) => scene.material(hit, u).0,
        }));
        if self.sort {
            sorter.sort(keys);
        }
        if let Some(probe) = probe {
            probe.groups(keys, scene.materials.len() + 1);
        }
        let mut ends = probe.as_deref_mut().map(|probe| &mut probe.census.ends);
        let start = statistics.spend(Stage::Sort, start);
        let lanes = &mut statistics.shade_lanes;
        let group = |key: u32, slots: &[u32]| {
            lanes.add(slots.len() as u32);
            let at = fill(slots);
            let Packet { org, dir, path, pixel, .. } = paths.packet(&at, depth, sample);
            let ends = ends.as_deref_mut();
            let mut group = Group { slots: at, count: slots.len(), pixel, out, ends };
            if key == miss {
                integrator.miss(scene, &path, (org, dir), &mut group);
                if let Some(beside) = beside {
                    beside.miss(scene, &path, (org, dir), &mut Beside { out: &mut group, first: *lit });
                }
                return;
            }
            let (tuv, primitive) = hits.packet(&at);
            let vertex = Vertex::new(scene, path, (org, dir), tuv, primitive, MaterialId(key));
            integrator.shade(scene, &vertex, &mut group);
            if let Some(beside) = beside {
                beside.shade(scene, &vertex, &mut Beside { out: &mut group, first: *lit });
            }
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
        let Self { scene, out: Outputs { connections, .. }, tracer, probe, .. } = self;
        statistics.trace_lanes += match probe {
            None => trace::occluded(scene, connections, tracer),
            Some(probe) => probe.occluded(scene, connections),
        };
        statistics.spend(Stage::Trace, start);
    }

    /// Adds each vertex to its pixel: vertices in the order of slots, light in the order of its index.
    fn add(&mut self) {
        let of_all = self.quads();
        let Self { paths, out: Outputs { quads, added, connections, .. }, sums, .. } = self;
        let quads = *quads;
        connections.for_each(|slot, channel, light| added[slot * quads][channel] += light);
        for (slot, values) in added.chunks_exact(quads).enumerate() {
            let sums = &mut sums[paths.pixel(slot) * of_all..][..quads];
            for (sums, values) in sums.iter_mut().zip(values) {
                *sums = std::array::from_fn(|c| sums[c] + values[c]);
            }
        }
    }
}

impl Outputs<'_> {
    fn clear(&mut self, slots: usize, shadows: usize) {
        self.added.clear();
        self.added.resize(slots * self.quads, [0.0; 4]);
        self.connections.clear(slots * shadows);
        self.next.resize(slots * self.branches);
        reserve(&mut self.alive, slots * self.branches, false);
        self.alive.fill(false);
    }
}

/// A group of at most eight slots that is being shaded.
struct Group<'g, 'a> {
    slots: [u32; LANES],
    count: usize,
    pixel: u32x8,
    out: &'g mut Outputs<'a>,
    ends: Option<&'g mut Ends>,
}

impl Outgoing<f32x8> for Group<'_, '_> {
    #[inline]
    fn add(&mut self, channel: usize, value: f32x8) {
        // Most surfaces don't shine.
        if value.equal(f32x8::zero()).all() {
            return;
        }
        for (&slot, value) in self.slots[..self.count].iter().zip(value.to_array()) {
            self.out.added[slot as usize * self.out.quads + channel / 4][channel % 4] = value;
        }
    }

    #[inline]
    fn shadow(&mut self, _: usize, lanes: Mask8, ray: (Vec3x8, Vec3x8, f32x8), radiance: Vec3x8) {
        let lanes = lanes.to_bitmask() & ((1 << self.count) - 1);
        if lanes == 0 {
            return;
        }
        self.out.connections.push(lanes, ray, radiance, u32x8::new(self.slots));
    }

    #[inline]
    fn next(&mut self, index: usize, lanes: Mask8, (org, dir): (Vec3x8, Vec3x8), path: &Path<f32x8>) {
        let lanes = lanes.to_bitmask();
        if lanes == 0 {
            return;
        }
        let branches = self.out.branches as u32;
        let at: [u32; LANES] = std::array::from_fn(|i| self.slots[i] * branches + index as u32);
        let packet = Packet { org, dir, t_far: f32x8::splat(f32::INFINITY), path: *path, pixel: self.pixel };
        // Rows of paths that end here are written too, and left where they are.
        self.out.next.store(&at[..self.count], &packet);
        for (i, &at) in at[..self.count].iter().enumerate() {
            self.out.alive[at as usize] = lanes >> i & 1 != 0;
        }
    }

    #[inline]
    fn end(&mut self, why: End, lanes: Mask8) {
        if let Some(ends) = &mut self.ends {
            ends.add(why, lanes.to_bitmask() & ((1 << self.count) - 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_beyond_the_count_say_nothing() {
        let arena = Bump::new();
        let mut out = Outputs {
            quads: 1,
            added: BumpVec::new_in(&arena),
            connections: Connections::new(&arena),
            next: Paths::new(&arena),
            alive: BumpVec::new_in(&arena),
            branches: 1,
        };
        out.clear(16, 1);
        let all = Mask8::splat(true);
        let (zero, one) = (Vec3x8::zero(), f32x8::splat(1.0));
        let mut group =
            Group { slots: fill(&[3, 9]), count: 2, pixel: u32x8::splat(7), out: &mut out, ends: None };
        group.add(0, one);
        group.shadow(0, all, (zero, zero, one), zero);
        group.next(0, all, (zero, zero), &Path::start(u32x8::splat(1), 0));
        let said: Vec<usize> = (0..16).filter(|&slot| out.added[slot] != [0.0; 4]).collect();
        assert_eq!(said, [3, 9]);
        assert_eq!(out.connections.len, 2);
        let alive: Vec<usize> = (0..16).filter(|&slot| out.alive[slot]).collect();
        assert_eq!(alive, [3, 9]);
        assert_eq!(out.next.pixel(9), 7);
    }
}
