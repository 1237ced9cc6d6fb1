//! What the command line changes of a scene that was loaded.

use std::fmt;

use clap::ValueEnum;

use crate::scene::{Aov, AovChannel, Crop, Film, Integrator, SceneDescription};

/// The largest picture, in pixels a side.
pub(super) const MAX_SIDE: u32 = 65_536;

/// Depth of Whitted's recursion where the scene has no limit: without one, two facing mirrors never
/// end.
const WHITTED_DEPTH: u32 = 10;

/// An [`Integrator`] without its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum IntegratorName {
    /// Global illumination: the rendering equation
    Path,
    /// Direct light only
    Direct,
    /// Direct light, mirrors and glass
    Whitted,
    /// Ambient occlusion: how much of the sky is open
    Ao,
    /// Irradiance of what is seen, in W/m²
    Irradiance,
    /// Depth, normals, ids, heat maps of the tree and more in place of light; .exr only
    Aov,
}

impl From<&Integrator> for IntegratorName {
    fn from(integrator: &Integrator) -> Self {
        match integrator {
            Integrator::Path { .. } => Self::Path,
            Integrator::Direct { .. } => Self::Direct,
            Integrator::Whitted { .. } => Self::Whitted,
            Integrator::AmbientOcclusion { .. } => Self::Ao,
            Integrator::Irradiance { .. } => Self::Irradiance,
            Integrator::Aov { .. } => Self::Aov,
        }
    }
}

impl fmt::Display for IntegratorName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Path => "path",
            Self::Direct => "direct",
            Self::Whitted => "whitted",
            Self::Ao => "ao",
            Self::Irradiance => "irradiance",
            Self::Aov => "aov",
        })
    }
}

/// Each `None` leaves what the scene says.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Overrides {
    pub(super) integrator: Option<IntegratorName>,
    pub(super) spp: Option<u32>,
    pub(super) width: Option<u32>,
    pub(super) height: Option<u32>,
    pub(super) seed: Option<u32>,
}

impl Overrides {
    /// Changes the scene.
    pub(super) fn apply(&self, scene: &mut SceneDescription) {
        if let Some(name) = self.integrator
            && name != IntegratorName::from(&scene.integrator)
        {
            scene.integrator = named(name, &scene.integrator);
        }
        let sampler = &mut scene.sensor.sampler;
        sampler.sample_count = self.spp.unwrap_or(sampler.sample_count);
        sampler.seed = self.seed.unwrap_or(sampler.seed);
        scene.sensor.film = resized(scene.sensor.film, self.width, self.height);
    }
}

/// The integrator of that name with its defaults, and the limits of the one it replaces.
fn named(name: IntegratorName, replaced: &Integrator) -> Integrator {
    let (max_depth, hide_emitters) = match *replaced {
        Integrator::Path { max_depth, hide_emitters, .. } => (max_depth, hide_emitters),
        Integrator::Direct { hide_emitters } => (None, hide_emitters),
        Integrator::Whitted { max_depth } => (Some(max_depth), false),
        Integrator::Irradiance { max_depth, .. } => (max_depth, false),
        Integrator::AmbientOcclusion { .. } | Integrator::Aov { .. } => (None, false),
    };
    match name {
        IntegratorName::Path => Integrator::Path { max_depth, rr_depth: 5, hide_emitters },
        IntegratorName::Direct => Integrator::Direct { hide_emitters },
        IntegratorName::Whitted => Integrator::Whitted { max_depth: max_depth.unwrap_or(WHITTED_DEPTH) },
        IntegratorName::Ao => Integrator::AmbientOcclusion { distance: f32::INFINITY },
        IntegratorName::Irradiance => Integrator::Irradiance { max_depth, rr_depth: 5 },
        IntegratorName::Aov => Integrator::Aov { channels: every_channel() },
    }
}

/// Named as a scene file names the kinds.
fn every_channel() -> Vec<AovChannel> {
    [
        ("depth", Aov::Depth),
        ("position", Aov::Position),
        ("uv", Aov::Uv),
        ("geo_normal", Aov::GeoNormal),
        ("sh_normal", Aov::ShNormal),
        ("directional_albedo", Aov::DirectionalAlbedo),
        ("material_id", Aov::MaterialId),
        ("primitive_id", Aov::PrimitiveId),
        ("nodes", Aov::Nodes),
        ("primitives", Aov::Primitives),
    ]
    .map(|(name, kind)| AovChannel { name: name.into(), kind })
    .into()
}

/// One side alone keeps the aspect ratio, to the nearest pixel.
fn resized(film: Film, width: Option<u32>, height: Option<u32>) -> Film {
    match (width, height) {
        (None, None) => film,
        (Some(width), Some(height)) => enlarged(film, width, height),
        (Some(width), None) => enlarged(film, width, scaled(film.height, width, film.width)),
        (None, Some(height)) => enlarged(film, scaled(film.width, height, film.height), height),
    }
}

/// Of another size, with the crop where it was in proportion.
fn enlarged(film: Film, width: u32, height: u32) -> Film {
    let span = |start: u32, length: u32, to: u32, from: u32| {
        let edge = |at: u32| (f64::from(at) * f64::from(to) / f64::from(from)).round() as u32;
        let first = edge(start).min(to - 1);
        (first, (edge(start + length).min(to) - first).max(1))
    };
    let crop = film.crop.map(|crop| {
        let (x, columns) = span(crop.x, crop.width, width, film.width);
        let (y, rows) = span(crop.y, crop.height, height, film.height);
        Crop { x, y, width: columns, height: rows }
    });
    Film { width, height, crop, ..film }
}

/// `length` · `to` / `from`, rounded, as a side of a picture.
fn scaled(length: u32, to: u32, from: u32) -> u32 {
    let from = u64::from(from.max(1));
    let side = (u64::from(length) * u64::from(to) + from / 2) / from;
    side.clamp(1, u64::from(MAX_SIDE)) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn applied(overrides: Overrides, integrator: Integrator) -> SceneDescription {
        let mut scene = SceneDescription { integrator, ..SceneDescription::default() };
        overrides.apply(&mut scene);
        scene
    }

    fn switched(to: IntegratorName, from: Integrator) -> Integrator {
        applied(Overrides { integrator: Some(to), ..Overrides::default() }, from).integrator
    }

    #[test]
    fn nothing_asked_changes_nothing() {
        let scene = applied(Overrides::default(), Integrator::Whitted { max_depth: 3 });
        let untouched = SceneDescription::default();
        assert_eq!(scene.integrator, Integrator::Whitted { max_depth: 3 });
        assert_eq!(scene.sensor, untouched.sensor);
    }

    #[test]
    fn samples_and_seed_are_replaced() {
        let asked = Overrides { spp: Some(64), seed: Some(7), ..Overrides::default() };
        let sampler = applied(asked, Integrator::default()).sensor.sampler;
        assert_eq!((sampler.sample_count, sampler.seed), (64, 7));
    }

    #[test]
    fn one_side_keeps_the_aspect_ratio() {
        let film = Film::new(1920, 1080);
        assert_eq!(resized(film, Some(640), None), Film::new(640, 360));
        assert_eq!(resized(film, None, Some(540)), Film::new(960, 540));
        assert_eq!(resized(film, Some(5), Some(9)), Film::new(5, 9));
        // 1080 / 1920 = 0.5625 rounds up.
        assert_eq!(resized(film, Some(1), None), Film::new(1, 1));
    }

    #[test]
    fn a_crop_stays_where_it_was_in_proportion() {
        let crop = Some(Crop { x: 10, y: 0, width: 30, height: 50 });
        let film = resized(Film { crop, ..Film::new(100, 50) }, Some(50), None);
        assert_eq!((film.width, film.height), (50, 25));
        assert_eq!(film.crop, Some(Crop { x: 5, y: 0, width: 15, height: 25 }));
        // A sliver does not vanish.
        let crop = Some(Crop { x: 99, y: 49, width: 1, height: 1 });
        let film = resized(Film { crop, ..Film::new(100, 50) }, Some(2), Some(1));
        assert_eq!(film.crop, Some(Crop { x: 1, y: 0, width: 1, height: 1 }));
    }

    #[test]
    fn a_side_is_never_zero_nor_beyond_the_limit() {
        let ribbon = Film::new(60_000, 1);
        assert_eq!(resized(ribbon, Some(10), None).height, 1);
        assert_eq!(resized(ribbon, None, Some(60_000)).width, MAX_SIDE);
    }

    #[test]
    fn a_new_integrator_keeps_the_depth_where_it_has_one() {
        let path = Integrator::Path { max_depth: Some(4), rr_depth: 9, hide_emitters: true };
        assert_eq!(switched(IntegratorName::Whitted, path.clone()), Integrator::Whitted { max_depth: 4 });
        assert_eq!(switched(IntegratorName::Direct, path), Integrator::Direct { hide_emitters: true });
        let whitted = Integrator::Whitted { max_depth: 6 };
        let path = Integrator::Path { max_depth: Some(6), rr_depth: 5, hide_emitters: false };
        assert_eq!(switched(IntegratorName::Path, whitted), path);
    }

    #[test]
    fn without_a_limit_path_has_none_and_whitted_ten() {
        let direct = Integrator::Direct { hide_emitters: false };
        assert_eq!(switched(IntegratorName::Path, direct.clone()), Integrator::default());
        assert_eq!(switched(IntegratorName::Whitted, direct), Integrator::Whitted { max_depth: 10 });
        assert_eq!(
            switched(IntegratorName::Whitted, Integrator::default()),
            Integrator::Whitted { max_depth: 10 }
        );
    }

    #[test]
    fn the_integrator_of_the_scene_keeps_its_parameters_when_named() {
        let path = Integrator::Path { max_depth: Some(2), rr_depth: 9, hide_emitters: true };
        assert_eq!(switched(IntegratorName::Path, path.clone()), path);
    }

    #[test]
    fn aov_by_name_writes_everything() {
        let Integrator::Aov { channels } = switched(IntegratorName::Aov, Integrator::default()) else {
            panic!("not aov");
        };
        assert_eq!(channels.len(), 10);
    }
}
