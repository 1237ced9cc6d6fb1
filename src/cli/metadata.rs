//! What decides a picture, in words: by it parts are told apart, and files say what they are.

use clap::ValueEnum;

use super::quantity::grouped;
use crate::{
    render::{Coverage, Statistics},
    scene::SceneDescription,
    simd::cpu,
};

/// How much a file says of its making.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Metadata {
    /// Nothing
    None,
    /// What decides the picture: equal pictures are equal files
    #[default]
    Picture,
    /// Time, threads and instruction set as well
    All,
}

/// What decides the bits of a picture, but for the number of samples.
pub(super) fn facts(scene: &SceneDescription) -> Vec<(String, String)> {
    let SceneDescription { integrator, sensor, .. } = scene;
    [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("scene", format!("{:016x}", scene.fingerprint())),
        ("integrator", format!("{integrator:?}")),
        ("film", format!("{:?}", sensor.film)),
        ("seed", sensor.sampler.seed.to_string()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// What a file says of the picture in it.
pub(super) struct About<'a> {
    /// The name of the scene's file.
    pub(super) scene: &'a str,
    pub(super) facts: &'a [(String, String)],
    /// A pixel, as they were asked for.
    pub(super) samples: u32,
    pub(super) statistics: &'a Statistics,
    pub(super) coverage: Coverage,
}

impl About<'_> {
    /// The lines of the header.
    pub(super) fn attributes(&self, metadata: Metadata) -> Vec<(String, String)> {
        let fact = |name: &str| {
            let found = self.facts.iter().find(|(fact, _)| fact == name);
            found.map_or(String::new(), |(_, value)| value.clone())
        };
        let Statistics { camera_rays, bounce_rays, shadow_rays, time, .. } = *self.statistics;
        let picture = [
            ("software", format!("packlight {}", fact("version"))),
            ("packlight.scene", self.scene.to_owned()),
            ("packlight.hash", fact("scene")),
            ("packlight.integrator", fact("integrator")),
            ("packlight.samples", samples(self.coverage, self.samples)),
            ("packlight.seed", fact("seed")),
            ("packlight.rays", format!("camera {camera_rays}, bounce {bounce_rays}, shadow {shadow_rays}")),
        ];
        let machine = [
            ("packlight.seconds", format!("{:.3}", time.as_secs_f64())),
            ("packlight.threads", rayon::current_num_threads().to_string()),
            ("packlight.lanes", cpu::compiled()),
        ];
        let picture = picture.into_iter().filter(|_| metadata != Metadata::None);
        let machine = machine.into_iter().filter(|_| metadata == Metadata::All);
        picture.chain(machine).map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// How many samples a pixel has, of how many.
pub(super) fn samples(Coverage { least, most, .. }: Coverage, asked: u32) -> String {
    match (least == most, most == asked) {
        (true, true) => grouped(asked.into()),
        (true, false) => format!("{} of {}", grouped(most.into()), grouped(asked.into())),
        _ => format!("{} to {} of {}", grouped(least.into()), grouped(most.into()), grouped(asked.into())),
    }
}
