//! How much memory a render will need, known from a description's counts before any of it is taken.
//!
//! An estimate, meant to be close and rather too high: what allocators keep and how full nodes are differs
//! from scene to scene. `tests/memory.rs` holds it against what renders really take.

use super::{
    aov::{self, AovIntegrator},
    frame::{TILE, most_together},
    integrator::Integrator as _,
    wavefront::paths_at_once,
};
use crate::bvh::Quality;
use crate::compile::{Needs, needs};
use crate::film::sums;
use crate::scene::{Integrator, PixelFormat, SceneDescription};
use crate::simd::LANES;

/// The program itself, before it has read anything.
const PROGRAM: u64 = 8 << 20;
/// Stack, and what its allocator keeps, of a thread.
const THREAD: u64 = 256 << 10;
const FLOAT: u64 = 4;

/// Bytes, by what they are for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Budget {
    /// Code and stacks.
    pub program: u64,
    /// The scene.
    pub scene: Needs,
    /// Sums, the picture that is made of them, and the file that is made of it.
    pub film: u64,
    /// Paths in flight.
    pub wavefronts: u64,
}

/// What is known of a render besides its scene.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    /// How much work goes into the tree.
    pub quality: Quality,
    /// How many render.
    pub threads: usize,
    /// Are sums written too, as of shards and checkpoints?
    pub keeps_sums: bool,
}

impl Budget {
    /// Of rendering a description.
    pub fn new(description: &SceneDescription, conditions: &Conditions) -> Self {
        let threads = conditions.threads as u64;
        Self {
            program: PROGRAM + threads * THREAD,
            scene: needs(description, conditions.quality),
            film: film(description, conditions.keeps_sums),
            wavefronts: threads * wavefront(description),
        }
    }

    /// The most that is there at one time, if the description is given away: meshes are in columns before a tree is
    /// built, and that is finished before a film is begun.
    pub fn peak(&self) -> u64 {
        let Needs { meshes, returned, textures, columns, tree, building } = self.scene;
        let kept = self.program + meshes - returned + textures + columns;
        kept + returned.max(tree + building.max(self.film + self.wavefronts))
    }

    /// The parts, named, in the order in which they are taken.
    pub fn parts(&self) -> [(&'static str, u64); 8] {
        let Needs { meshes, textures, columns, tree, building, .. } = self.scene;
        [
            ("program", self.program),
            ("meshes", meshes),
            ("textures", textures),
            ("columns", columns),
            ("BVH", tree),
            ("building the BVH", building),
            ("film", self.film),
            ("wavefront", self.wavefronts),
        ]
    }
}

/// Names of the channels that are summed: colours, and what the camera sees besides.
pub fn channels(description: &SceneDescription) -> Vec<String> {
    let first = match &description.integrator {
        Integrator::Aov { channels } => AovIntegrator::new(channels.clone()).channels(),
        _ => ["R", "G", "B"].map(String::from).into(),
    };
    first.into_iter().chain(aov::layers(&description.aovs)).collect()
}

fn film(description: &SceneDescription, keeps_sums: bool) -> u64 {
    let window = description.sensor.film.window();
    let pixels = u64::from(window.width) * u64::from(window.height);
    let channels = channels(description).len() as u64;
    let alpha = match description.sensor.film.format {
        PixelFormat::Rgb | PixelFormat::Luminance => 0,
        PixelFormat::Rgba | PixelFormat::LuminanceAlpha => 1,
    };
    // A row, which has the weight, and a count; the block that is open, if one is in the end, and one node for each
    // binary digit of the number of blocks.
    let samples = description.sensor.sampler.sample_count;
    let (blocks, open) = (samples / sums::BLOCK, !samples.is_multiple_of(sums::BLOCK));
    let block = (row(channels) + 1) * FLOAT;
    let sums = block * u64::from(blocks.count_ones() + u32::from(open));
    // A file of sums always has the block that is open.
    let kept = block * u64::from(blocks.count_ones() + 1);
    // The picture, the file, and what of it is being packed or is left of packing.
    let picture = (channels + alpha) * FLOAT * 5 / 2;
    pixels * (sums + picture + if keeps_sums { 3 * kept } else { 0 })
}

/// Numbers in a row of sums.
fn row(channels: u64) -> u64 {
    4 * sums::quads(channels as usize) as u64
}

/// Of one thread.
fn wavefront(description: &SceneDescription) -> u64 {
    let lights = description.emitters.len()
        + description.shapes.iter().filter(|shape| shape.radiance.is_some()).count();
    let (shadow_rays, branches) = match description.integrator {
        Integrator::Direct { .. } => (lights as u64, 1),
        Integrator::Whitted { .. } => (lights as u64, 2),
        Integrator::Path { .. } | Integrator::AmbientOcclusion { .. } | Integrator::Irradiance { .. } => {
            (1, 1)
        }
        Integrator::Aov { .. } => (0, 1),
    };
    let (all, layers) = (channels(description).len(), aov::layers(&description.aovs).count());
    let (all, lit) = (row(all as u64), row((all - layers) as u64));
    // What layers have behind the quads of light comes in eights.
    let (summed, brought) = (all * FLOAT, (lit + (all - lit).next_multiple_of(LANES as u64)) * FLOAT);
    let added = lit * FLOAT;
    // Rows and places of paths, now and next, and alive or not; their octants; hits, keys and order; points of the film;
    // sums of the round; rows of connections, light, keys and order.
    let path = 69 * (1 + branches) + 12 + 28 + 8 + added + shadow_rays * 14 * FLOAT;
    let (pixels, together) = (u64::from(TILE * TILE), most_together(description.sensor.sampler.sample_count));
    let samples = pixels * u64::from(together);
    // Where paths branch there are more of them than began, say two and a half times as many; and an arena keeps what
    // has been outgrown.
    let begun = samples.min(paths_at_once(shadow_rays as usize) as u64);
    let slots = LANES as u64 + if branches > 1 { begun * 5 / 2 } else { begun };
    // What each sample brings and counts; and sums that a thread keeps for its next block.
    let brought = samples * (brought + FLOAT) + pixels * (summed + FLOAT);
    2 * slots * path + brought
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aov, AovChannel, Film, Geometry, MaterialIndex, Shape};

    const CONDITIONS: Conditions = Conditions { quality: Quality::Medium, threads: 2, keeps_sums: false };

    fn film_of(samples: u32, side: u32) -> u64 {
        let mut description = SceneDescription::default();
        description.sensor.film = Film::new(side, side);
        description.sensor.sampler.sample_count = samples;
        Budget::new(&description, &CONDITIONS).film
    }

    #[test]
    fn a_film_grows_with_its_pixels_and_with_the_binary_digits_of_its_blocks() {
        assert_eq!(film_of(1, 200), 4 * film_of(1, 100));
        assert_eq!(film_of(16, 100), film_of(1024, 100));
        assert_eq!(film_of(16, 100), film_of(1, 100));
        let sums = film_of(17, 100) - film_of(16, 100);
        assert_eq!(sums, 100 * 100 * 20);
        assert_eq!(film_of(48, 100), film_of(17, 100));
        assert_eq!(film_of(49, 100), film_of(17, 100) + sums);
    }

    #[test]
    fn a_channel_is_summed_drawn_and_written() {
        // Three colours, a weight and a count; then each channel in the picture, in the file and on its way there.
        assert_eq!(film_of(1, 10), 100 * (5 * 4 + 3 * 10));
        let mut description = SceneDescription::default();
        description.sensor.film = Film { format: PixelFormat::Rgba, ..Film::new(10, 10) };
        description.sensor.sampler.sample_count = 1;
        // Alpha is not summed with the colours.
        assert_eq!(Budget::new(&description, &CONDITIONS).film - film_of(1, 10), 100 * 10);
        // Sums that are kept are three times there besides.
        let kept = Budget::new(&description, &Conditions { keeps_sums: true, ..CONDITIONS }).film;
        assert_eq!(kept, 100 * (4 * 5 * 4 + 4 * 10));
        // There, the block that is open is one even where none is.
        description.sensor.sampler.sample_count = 16;
        let kept = Budget::new(&description, &Conditions { keeps_sums: true, ..CONDITIONS }).film;
        assert_eq!(kept, 100 * ((1 + 3 * 2) * 5 * 4 + 4 * 10));
    }

    #[test]
    fn a_peak_is_no_more_than_the_parts() {
        let budget = Budget::new(&SceneDescription::default(), &CONDITIONS);
        let parts: u64 = budget.parts().iter().map(|(_, bytes)| bytes).sum();
        assert!(budget.peak() <= parts && budget.peak() > budget.film + budget.wavefronts);
    }

    #[test]
    fn large_meshes_are_gone_before_a_tree_is_there() {
        let scene =
            Needs { meshes: 50, returned: 40, columns: 30, tree: 20, building: 5, ..Needs::default() };
        let budget = Budget { scene, ..Budget::default() };
        assert_eq!(budget.peak(), 50 + 30, "meshes and columns");
        let large = Budget { scene: Needs { tree: 100, ..scene }, ..budget };
        assert_eq!(large.peak(), 10 + 30 + 100 + 5, "columns and the tree");
    }

    #[test]
    fn samples_that_are_taken_together_are_in_flight_together() {
        let of = |samples| {
            let mut description = SceneDescription::default();
            description.sensor.sampler.sample_count = samples;
            wavefront(&description)
        };
        assert_eq!((of(1), of(16)), (of(3), of(1024)));
        assert!(of(16) > 3 * of(1), "{} {}", of(16), of(1));
        // Half of those that are brought are not in flight.
        assert!(of(16) > of(8) && of(16) < 2 * of(8));
    }

    #[test]
    fn layers_come_in_eights() {
        let of = |layers| {
            let mut description = SceneDescription::default();
            description.sensor.sampler.sample_count = 1;
            description.aovs = [Aov::Depth, Aov::Uv, Aov::Position]
                .into_iter()
                .take(layers)
                .map(|kind| AovChannel { name: format!("{kind:?}"), kind })
                .collect();
            wavefront(&description)
        };
        let pixels = u64::from(TILE * TILE);
        // A quad of sums for up to four numbers, and room for eight in flight.
        assert_eq!(
            [1, 2, 3].map(|layers| of(layers) - of(0)),
            [4 + 8, 4 + 8, 8 + 8].map(|n| pixels * n * FLOAT)
        );
    }

    #[test]
    fn lights_cost_connections_where_all_are_asked() {
        let light = crate::scene::Emitter::Constant { radiance: glam::Vec3::ONE };
        let mut description = SceneDescription { emitters: vec![light; 1000], ..Default::default() };
        let one = Budget::new(&description, &CONDITIONS).wavefronts;
        description.integrator = Integrator::Direct { hide_emitters: false };
        let many = Budget::new(&description, &CONDITIONS).wavefronts;
        assert!(many > 50 * one);
        // A shape that shines is a light as any other.
        let shape = Shape {
            name: String::new(),
            geometry: Geometry::Disk,
            to_world: glam::DAffine3::IDENTITY,
            flip_normals: false,
            material: MaterialIndex(0),
            radiance: Some(glam::Vec3::ONE),
        };
        description.emitters.truncate(300);
        description.shapes = vec![shape; 700];
        assert_eq!(Budget::new(&description, &CONDITIONS).wavefronts, many);
    }
}
