//! `--denoise`: a second picture, without the noise.

use std::{
    env,
    path::{Path, PathBuf},
    time::Instant,
};

use serde::Serialize;

use crate::{
    cli::failure::Failure,
    denoise::Denoiser,
    picture::{Picture, Style, save_with},
    scene::{Aov, AovChannel},
};

/// The environment variable that says where the library is.
const PLACE: &str = "OIDN_LIB";

/// The layers that denoising looks at, under the names that `--aov` gives them.
const ALBEDO: [&str; 3] = ["albedo.R", "albedo.G", "albedo.B"];
const NORMAL: [&str; 3] = ["normal.X", "normal.Y", "normal.Z"];

/// The layers that have to be rendered for it besides those that are asked for.
pub(super) fn besides(asked: &[AovChannel]) -> Vec<AovChannel> {
    let needed = [("albedo", Aov::DirectionalAlbedo), ("normal", Aov::ShNormal)];
    let needed = needed.map(|(name, kind)| AovChannel { name: name.into(), kind });
    needed.into_iter().filter(|layer| !asked.contains(layer)).collect()
}

/// Takes the channels of some layers out of a picture.
pub(super) fn without(mut picture: Picture, layers: &[AovChannel]) -> Picture {
    let is_of = |channel: &str, layer: &AovChannel| {
        channel.strip_prefix(layer.name.as_str()).is_some_and(|rest| rest.starts_with('.'))
    };
    picture.channels.retain(|channel| !layers.iter().any(|layer| is_of(&channel.name, layer)));
    picture
}

/// Where it is written: `a.denoised.exr` beside `a.exr`.
pub(super) fn beside(output: &Path) -> PathBuf {
    let extension = output.extension().unwrap_or_default().to_string_lossy();
    output.with_extension(format!("denoised.{extension}"))
}

/// Loads the library, while there is nothing to lose yet.
pub(super) fn load() -> Result<Denoiser, Failure> {
    let place = env::var_os(PLACE).filter(|place| !place.is_empty());
    Denoiser::load(place.as_deref(), rayon::current_num_threads()).map_err(|error| {
        Failure::Sentence(format!(
            "--denoise: {error}; install it (https://www.openimagedenoise.org), or say by {PLACE}=PATH where its \
             library or the library's folder is"
        ))
    })
}

/// The picture without noise. Field names are keys of `--json`; units are in the names.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct Denoised {
    pub(in crate::cli) output: String,
    /// What made it, with its version.
    pub(in crate::cli) by: String,
    pub(in crate::cli) seconds: f64,
}

impl Denoised {
    /// Takes the noise out of a picture that is safe in `output` already.
    pub(super) fn of(
        denoiser: &Denoiser,
        picture: &Picture,
        output: &Path,
    ) -> Result<(Self, Picture), Failure> {
        let start = Instant::now();
        let clean = denoiser.denoise(picture, ALBEDO, NORMAL).map_err(|error| {
            let output = output.display();
            Failure::Sentence(format!("--denoise: {error}; {output} is written as it was rendered"))
        })?;
        let (output, seconds) = (beside(output).display().to_string(), start.elapsed().as_secs_f64());
        Ok((Self { output, by: denoiser.name(), seconds }, clean))
    }

    /// Writes it beside `output`.
    pub(super) fn save(&self, picture: &Picture, output: &Path, mut style: Style) -> Result<(), Failure> {
        if !style.exr.attributes.is_empty() {
            style.exr.attributes.push(("packlight.denoiser".into(), self.by.clone()));
        }
        Ok(save_with(picture, &beside(output), &style)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Channel;

    #[test]
    fn only_what_was_not_asked_for_is_taken_out() {
        let channel = |name: &str| Channel { name: name.into(), samples: vec![0.0] };
        let names = ["R", "albedo.R", "normal.X", "normals.X", "depth.Z"];
        let picture = Picture { width: 1, height: 1, channels: names.map(channel).into(), place: None };
        let asked = [AovChannel { name: "normal".into(), kind: Aov::ShNormal }];
        let besides = besides(&asked);
        assert_eq!(besides.len(), 1);
        let left = without(picture, &besides);
        let left: Vec<&str> = left.channels.iter().map(|channel| channel.name.as_str()).collect();
        assert_eq!(left, ["R", "normal.X", "normals.X", "depth.Z"]);
    }

    #[test]
    fn it_stands_beside_the_picture() {
        assert_eq!(beside(Path::new("a/b.c.exr")), Path::new("a/b.c.denoised.exr"));
        assert_eq!(beside(Path::new("b.PNG")), Path::new("b.denoised.PNG"));
    }
}
