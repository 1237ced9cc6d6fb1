//! What decides a picture, in words: by it parts are told apart, and files say what they are.

use clap::ValueEnum;

use super::{overrides::IntegratorName, quantity::grouped};
use crate::{
    render::{Coverage, Statistics},
    scene::{Crop, Film, Integrator, PixelFormat, ReconstructionFilter, SceneDescription},
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
        ("integrator", transport(integrator)),
        ("film", size(&sensor.film)),
        ("seed", sensor.sampler.seed.to_string()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into()
}

/// An integrator and its parameters, by the names that they have in a scene.
fn transport(integrator: &Integrator) -> String {
    let depth = |max_depth: Option<u32>| max_depth.map(|depth| format!("max_depth {depth}"));
    let hidden = |hide_emitters: bool| hide_emitters.then(|| "hide_emitters".to_owned());
    let parameters = match integrator {
        Integrator::Path { max_depth, rr_depth, hide_emitters } => {
            vec![depth(*max_depth), Some(format!("rr_depth {rr_depth}")), hidden(*hide_emitters)]
        }
        Integrator::Irradiance { max_depth, rr_depth } => {
            vec![depth(*max_depth), Some(format!("rr_depth {rr_depth}"))]
        }
        Integrator::Direct { hide_emitters } => vec![hidden(*hide_emitters)],
        Integrator::Whitted { max_depth } => vec![depth(Some(*max_depth))],
        Integrator::AmbientOcclusion { distance } => {
            vec![distance.is_finite().then(|| format!("distance {distance}"))]
        }
        Integrator::Aov { channels } => {
            channels.iter().map(|channel| Some(format!("{}:{:?}", channel.name, channel.kind))).collect()
        }
    };
    let name = IntegratorName::from(integrator).to_string();
    std::iter::once(name).chain(parameters.into_iter().flatten()).collect::<Vec<_>>().join(", ")
}

/// A film: its size, its crop as it is typed, its filter, and its channels.
fn size(film: &Film) -> String {
    let Film { width, height, crop, filter, format } = film;
    let crop = crop.map_or(String::new(), |Crop { x, y, width, height }| {
        format!("crop {x},{},{y},{}, ", x + width, y + height)
    });
    let filter = match filter {
        ReconstructionFilter::Box => "box".to_owned(),
        ReconstructionFilter::Tent { radius } => format!("tent of radius {radius}"),
        ReconstructionFilter::Gaussian { stddev } => format!("gaussian of stddev {stddev}"),
        ReconstructionFilter::Mitchell { b, c } => format!("mitchell of B {b} and C {c}"),
        ReconstructionFilter::CatmullRom => "catmullrom".to_owned(),
        ReconstructionFilter::Lanczos { lobes } => format!("lanczos of {lobes} lobes"),
    };
    let format = match format {
        PixelFormat::Rgb => "rgb",
        PixelFormat::Rgba => "rgba",
        PixelFormat::Luminance => "luminance",
        PixelFormat::LuminanceAlpha => "luminance_alpha",
    };
    format!("{width} x {height}, {crop}{filter}, {format}")
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aov, AovChannel};

    /// Whatever decides a picture is a fact, under its own name; and words don't hide what differs.
    #[test]
    fn two_pictures_differ_in_a_fact() {
        let of = |scene: &SceneDescription| facts(scene);
        let usual = of(&SceneDescription::default());
        let names: Vec<&str> = usual.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["version", "scene", "integrator", "film", "seed"]);
        assert_eq!(usual[0].1, env!("CARGO_PKG_VERSION"));
        let differs = |at: usize, change: &dyn Fn(&mut SceneDescription)| {
            let mut scene = SceneDescription::default();
            change(&mut scene);
            assert_ne!(of(&scene)[at], usual[at], "{scene:?}");
            of(&scene)[at].1.clone()
        };
        let path =
            |max_depth, rr_depth, hide_emitters| Integrator::Path { max_depth, rr_depth, hide_emitters };
        assert_eq!(usual[2].1, "path, rr_depth 5");
        assert_eq!(
            differs(2, &|scene| scene.integrator = path(Some(8), 5, false)),
            "path, max_depth 8, rr_depth 5"
        );
        assert_eq!(
            differs(2, &|scene| scene.integrator = path(None, 6, true)),
            "path, rr_depth 6, hide_emitters"
        );
        let channels = vec![AovChannel { name: "dd".into(), kind: Aov::Depth }];
        let aov = Integrator::Aov { channels };
        assert_eq!(differs(2, &|scene| scene.integrator = aov.clone()), "aov, dd:Depth");
        let near = Integrator::AmbientOcclusion { distance: 0.1 };
        assert_eq!(differs(2, &|scene| scene.integrator = near.clone()), "ao, distance 0.1");
        assert_eq!(usual[3].1, "768 x 576, box, rgb");
        let crop = Some(Crop { x: 1, y: 2, width: 3, height: 4 });
        assert_eq!(differs(3, &|scene| scene.sensor.film.crop = crop), "768 x 576, crop 1,4,2,6, box, rgb");
        let bell = ReconstructionFilter::Gaussian { stddev: 0.5 };
        assert_eq!(
            differs(3, &|scene| scene.sensor.film.filter = bell),
            "768 x 576, gaussian of stddev 0.5, rgb"
        );
        differs(3, &|scene| scene.sensor.film.format = PixelFormat::Rgba);
        assert_eq!(differs(4, &|scene| scene.sensor.sampler.seed = 7), "7");
    }
}
