//! What the rays of one sample a pixel do, counted one by one.
//!
//! Nothing is counted while a picture is rendered that would take time. So the first sample of each pixel is gone
//! through once more, by the same code with somebody looking on, and each tile starts without habits: the counts
//! are the same on any number of threads.

use std::ops::AddAssign;

use bumpalo::Bump;
use rayon::prelude::*;

use super::{
    Settings, Task,
    connections::Connections,
    frame::tiles,
    integrator::{End, Integrator},
    measure::Counts,
    rows::{Hits, Paths},
    sort::for_each_unsorted_group,
    statistics::LaneUse,
    trace::{self, Route},
    wavefront::Wavefront,
    with_integrator,
};
use crate::{bvh::Tracer, compile::Scene, film::Tile, geometry::PrimitiveId, simd::LANES};

/// What the rays of one sample of each pixel do.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// From the camera.
    pub camera: Crowd,
    /// From one surface to the next.
    pub bounce: Crowd,
    /// From a surface to a light.
    pub shadow: Crowd,
    /// Shadow rays that something blocks.
    pub blocked: u64,
    /// Lane use of shading, hits sorted by material.
    pub sorted: LaneUse,
    /// Lane use of shading, hits as they come: neighbours together where they happen to have one material.
    pub unsorted: LaneUse,
    /// Paths that arrive at their first, second, … vertex, those that leave the scene there included.
    pub vertices: Vec<u64>,
    /// How they end.
    pub ends: Ends,
}

/// Rays of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crowd {
    /// How many.
    pub rays: u64,
    /// Lanes of the packets in which they are handed to the tree.
    pub packets: LaneUse,
    /// What they meet in the tree one by one.
    pub alone: Counts,
    /// What they meet as they are traced, in company.
    pub together: Counts,
}

/// How paths end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ends {
    /// They leave the scene.
    pub escaped: u64,
    /// A surface that absorbs them, or an integrator that goes no further.
    pub surface: u64,
    /// They are as long as the integrator allows.
    pub depth: u64,
    /// Russian roulette.
    pub roulette: u64,
}

impl Ends {
    /// All of them.
    pub fn total(&self) -> u64 {
        let Self { escaped, surface, depth, roulette } = self;
        escaped + surface + depth + roulette
    }

    /// Lanes of a group that end.
    pub(super) fn add(&mut self, why: End, lanes: u32) {
        let ends = match why {
            End::Depth => &mut self.depth,
            End::Roulette => &mut self.roulette,
        };
        *ends += u64::from(lanes.count_ones());
    }
}

impl AddAssign for Ends {
    fn add_assign(&mut self, other: Self) {
        self.escaped += other.escaped;
        self.surface += other.surface;
        self.depth += other.depth;
        self.roulette += other.roulette;
    }
}

impl AddAssign for Crowd {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.packets += other.packets;
        self.alone += other.alone;
        self.together += other.together;
    }
}

impl AddAssign for Census {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.bounce += other.bounce;
        self.shadow += other.shadow;
        self.blocked += other.blocked;
        self.sorted += other.sorted;
        self.unsorted += other.unsorted;
        self.ends += other.ends;
        self.vertices.resize(self.vertices.len().max(other.vertices.len()), 0);
        self.vertices.iter_mut().zip(other.vertices).for_each(|(all, more)| *all += more);
    }
}

/// Counts what the first sample of each pixel does, as packets, on the current rayon pool.
pub fn census(scene: &Scene) -> Census {
    struct Count<'a>(&'a Scene);
    impl Task for Count<'_> {
        type Done = Census;
        fn run<I: Integrator>(self, integrator: &I) -> Census {
            let count = |tile: &Tile| {
                let arena = Bump::new();
                let tracer = &mut Tracer::new(());
                Wavefront::new((&arena, tracer), self.0, integrator, &Settings::default()).census(tile, 0)
            };
            let add = |mut sum: Census, tile| {
                sum += tile;
                sum
            };
            tiles(self.0.film.window()).par_iter().map(count).reduce(Census::default, add)
        }
    }
    with_integrator(scene, Count(scene))
}

/// Who looks on while a tile is rendered.
pub(super) struct Probe {
    tracer: Tracer<Counts>,
    /// For single rays.
    alone: Tracer<Counts>,
    pub(super) census: Census,
}

impl Probe {
    /// Nothing seen yet.
    pub(super) fn new() -> Self {
        let counts = Counts::default();
        Self { tracer: Tracer::new(counts), alone: Tracer::new(counts), census: Census::default() }
    }

    /// [`trace::closest`], counted.
    pub(super) fn closest<'a>(
        &mut self,
        scene: &Scene,
        paths: &Paths<'a>,
        hits: &mut Hits<'a>,
        depth: u32,
    ) -> LaneUse {
        trace::closest(scene, paths, hits, Route::Single, &mut self.alone);
        let lanes = trace::closest(scene, paths, hits, Route::default(), &mut self.tracer);
        self.census.vertices.push(paths.len as u64);
        let crowd = self.crowd(paths.len, lanes);
        *(if depth == 0 { &mut self.census.camera } else { &mut self.census.bounce }) += crowd;
        lanes
    }

    /// [`trace::occluded`], counted.
    pub(super) fn occluded(&mut self, scene: &Scene, connections: &mut Connections) -> LaneUse {
        for first in (0..connections.len).step_by(LANES) {
            let rays = connections.rays(first);
            for lane in 0..LANES.min(connections.len - first) {
                self.census.blocked += u64::from(scene.occluded(&rays.lane(lane), &mut self.alone.traversal));
            }
        }
        let lanes = trace::occluded(scene, connections, Route::default(), &mut self.tracer);
        let crowd = self.crowd(connections.len, lanes);
        self.census.shadow += crowd;
        lanes
    }

    /// What has been counted since the last time.
    fn crowd(&mut self, rays: usize, packets: LaneUse) -> Crowd {
        Crowd {
            rays: rays as u64,
            packets,
            alone: std::mem::take(&mut self.alone.traversal.tally),
            together: std::mem::take(&mut self.tracer.traversal.tally),
        }
    }

    /// The groups of eight that hits of so many materials make.
    pub(super) fn groups(&mut self, keys: &[u32], materials: usize) {
        let mut counts = vec![0; materials];
        keys.iter().for_each(|&key| counts[key as usize] += 1);
        let packets = counts.into_iter().filter(|&count| count > 0).map(LaneUse::of_packets);
        packets.for_each(|packet| self.census.sorted += packet);
        for_each_unsorted_group(keys, |_, slots| self.census.unsorted.add(slots.len() as u32));
    }

    /// Which paths of a round end, in the open or at a surface, whyever they do.
    pub(super) fn ends(&mut self, paths: &Paths<'_>, hits: &Hits<'_>, alive: &[bool], branches: usize) {
        let Ends { escaped, surface, .. } = &mut self.census.ends;
        for (slot, branches) in alive.chunks_exact(branches).take(paths.len).enumerate() {
            if !branches.contains(&true) {
                let in_the_open = hits.primitive(slot).0 == PrimitiveId::NONE;
                *(if in_the_open { &mut *escaped } else { &mut *surface }) += 1;
            }
        }
    }

    /// All that was seen.
    pub(super) fn finish(self) -> Census {
        let Self { mut census, .. } = self;
        // What an integrator ended, it ended at a surface.
        census.ends.surface -= census.ends.depth + census.ends.roulette;
        census
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::{
        compile::compile,
        load::{LoadOptions, load},
        render::{Backend, Settings, Statistics, render},
        scene::{Integrator, SceneDescription},
    };

    fn described(name: &str) -> SceneDescription {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
        let mut description = load(&path, &LoadOptions::default()).expect("it loads").description;
        (description.sensor.film.width, description.sensor.film.height) = (40, 30);
        description.sensor.sampler.sample_count = 1;
        description
    }

    #[test]
    fn the_census_is_of_the_rays_that_one_sample_renders() {
        let lights = |depth| Integrator::Path { max_depth: depth, rr_depth: 2, hide_emitters: false };
        for integrator in [lights(None), lights(Some(3)), Integrator::Whitted { max_depth: 4 }] {
            let mut description = described("spheres.xml");
            description.integrator = integrator.clone();
            let scene = compile(&description).expect("it compiles");
            let counted = census(&scene);
            for backend in [Backend::Packet, Backend::Scalar] {
                let settings = Settings { backend, ..Settings::default() };
                let Statistics { camera_rays, bounce_rays, shadow_rays, .. } =
                    render(&scene, &settings, &|_| {}).statistics;
                let rays = [counted.camera.rays, counted.bounce.rays, counted.shadow.rays];
                assert_eq!(rays, [camera_rays, bounce_rays, shadow_rays], "{integrator:?}");
            }
            assert!(counted.blocked > 0 && counted.blocked < counted.shadow.rays);
            assert_eq!(counted.vertices.iter().sum::<u64>(), counted.camera.rays + counted.bounce.rays);
            // Shading sees each of them once, sorted or not, and the fewer groups the better.
            assert_eq!(counted.sorted.active, counted.unsorted.active);
            assert!(counted.sorted.total < counted.unsorted.total, "{counted:?}");
            // A ray that goes alone shares no test.
            for Crowd { alone, together, .. } in [counted.camera, counted.bounce, counted.shadow] {
                assert_eq!(alone.tests, alone.nodes + alone.primitives);
                assert!(together.tests > 0 && together.tests <= together.nodes + together.primitives);
            }
        }
    }

    #[test]
    fn every_path_ends_once() {
        let ends = |max_depth, rr_depth| {
            let mut description = described("cornell.xml");
            description.integrator = Integrator::Path { max_depth, rr_depth, hide_emitters: false };
            let counted = census(&compile(&description).expect("it compiles"));
            assert_eq!(counted.ends.total(), counted.camera.rays);
            counted.ends
        };
        let free = ends(None, 2);
        assert!(free.roulette > 0 && free.depth == 0 && free.escaped > 0, "{free:?}");
        let short = ends(Some(3), 9);
        assert!(short.roulette == 0 && short.depth > 0 && short.surface > 0, "{short:?}");
    }
}
