//! The scene that a command works on.

use std::{
    path::PathBuf,
    time::{Duration, Instant},
};

use clap::Args;

use super::{
    failure::{Failure, warn},
    quantity::counted,
};
use crate::{
    compile::Scene,
    load::{LoadOptions, Loaded, Origins, load},
};

/// Arguments of every command that loads a scene.
#[derive(Clone, Debug, Args)]
pub(super) struct Source {
    /// Scene file (.xml, as Mitsuba 3 reads it), a bare mesh (.obj, .ply) or one made on the
    /// spot (gen:soup:100k, gen:terrain:1M, gen:spheres:1M, gen:hair:200k)
    #[arg(value_name = "SCENE")]
    pub(super) path: PathBuf,

    /// Value of `$NAME` in the scene, stronger than its <default>; repeatable
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = definition)]
    defines: Vec<(String, String)>,

    /// Which of the scene's sensors, from 0; the first if not given
    #[arg(short, long, value_name = "N")]
    sensor: Option<usize>,
}

impl Source {
    pub(super) fn new(path: PathBuf, defines: Vec<(String, String)>) -> Self {
        Self { path, defines, sensor: None }
    }

    /// The definitions, as they were typed.
    pub(super) fn options(&self) -> String {
        let defines = self.defines.iter().map(|(name, value)| format!(" -D {name}={value}"));
        defines.chain(self.sensor.map(|index| format!(" --sensor {index}"))).collect()
    }

    /// Loads the scene and tells its warnings.
    pub(super) fn load(&self) -> Result<(Loaded, Duration), Failure> {
        let start = Instant::now();
        let options = LoadOptions { defines: self.defines.clone(), sensor: self.sensor };
        let loaded = load(&self.path, &options)?;
        let time = start.elapsed();
        warn(&loaded.warnings);
        Ok((loaded, time))
    }
}

/// Tells which triangles were left out of a scene.
pub(super) fn warn_of_degenerate(origins: &Origins, scene: &Scene) {
    let warnings = scene.degenerate().iter().filter_map(|one| {
        let shapes = match one.group {
            None => &origins.shapes,
            Some(group) => origins.groups.get(group.0 as usize)?,
        };
        let triangles = counted(one.triangles, "triangle");
        let are = if one.triangles == 1 { "is" } else { "are" };
        let message = format!("{triangles} without area can't be hit and {are} left out");
        Some(shapes.get(one.shape as usize)?.warning(message).label("of this shape"))
    });
    warn(&warnings.collect::<Vec<_>>());
}

pub(super) fn definition(argument: &str) -> Result<(String, String), String> {
    match argument.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_owned(), value.to_owned())),
        _ => Err("expected NAME=VALUE, as in -D spp=64".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_equals_sign_divides() {
        assert_eq!(definition("a=b=c"), Ok(("a".into(), "b=c".into())));
        assert_eq!(definition("a="), Ok(("a".into(), String::new())));
        assert!(definition("a").is_err() && definition("=b").is_err());
    }
}
