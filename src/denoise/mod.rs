//! Noise taken out of a picture, by Open Image Denoise \[Afr25\], where it is installed.
//!
//! A network has learned what pictures look like. It is shown the colours and, as a hint to what is an edge and
//! not noise, two layers of what the camera sees: how much the surfaces reflect, and their normals. Those are
//! cleaned first, each by itself, since they are noisy too where a pixel sees an edge or something out of focus.
//!
//! The contract of bits ends here: what a network makes of a picture depends on its version and on the machine.

mod library;

use std::{
    ffi::{CStr, OsStr, OsString},
    path::Path,
};

use crate::picture::Picture;
use library::Library;

/// Files that hold version 2, as systems name them. Version 1 has other functions.
#[cfg(target_os = "macos")]
const FILES: [&str; 2] = ["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"];
#[cfg(target_os = "windows")]
const FILES: [&str; 1] = ["OpenImageDenoise.dll"];
#[cfg(not(any(target_os = "macos", target_os = "windows")))]
const FILES: [&str; 2] = ["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"];

/// Why a picture is as noisy as it was.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DenoiseError {
    /// No library could be used.
    #[error("Open Image Denoise 2 was not found; looked for {}", .tried.join("; for "))]
    NotFound {
        /// Each file, and what the system says of it.
        tried: Vec<String>,
    },
    /// The library complains.
    #[error("Open Image Denoise: {0}")]
    Refused(String),
    /// The picture lacks what it takes.
    #[error("the picture has no channel {0}")]
    NoChannel(String),
}

/// The library, ready for work.
#[derive(Debug)]
pub struct Denoiser {
    library: Library,
}

impl Denoiser {
    /// Loads a library: the file `place`, or a file in the folder `place`, or else what the system finds under
    /// its usual names. It works on so many threads.
    ///
    /// A library is code, and can do whatever code can; so `place` must be a place that is trusted.
    ///
    /// # Errors
    /// [`DenoiseError::NotFound`], or what the library says of this machine.
    pub fn load(place: Option<&OsStr>, threads: usize) -> Result<Self, DenoiseError> {
        let mut tried = Vec::new();
        for file in candidates(place) {
            match Library::open(&file) {
                Ok(mut library) => {
                    library.start(threads).map_err(DenoiseError::Refused)?;
                    return Ok(Self { library });
                }
                Err(error) => tried.push(format!("{} ({error})", file.display())),
            }
        }
        Err(DenoiseError::NotFound { tried })
    }

    /// Name and version, as `Open Image Denoise 2.3.1`.
    pub fn name(&self) -> String {
        let version = self.library.version();
        format!("Open Image Denoise {}.{}.{}", version / 10_000, version / 100 % 100, version % 100)
    }

    /// The picture with other colours: `R G B`, linear, of any brightness. `albedo` names three channels of what
    /// surfaces reflect, in [0, 1], and `normal` three of their directions; all other channels stay.
    ///
    /// # Errors
    /// [`DenoiseError`]: a channel is missing, or the library can't do it.
    pub fn denoise(
        &self,
        picture: &Picture,
        albedo: [&str; 3],
        normal: [&str; 3],
    ) -> Result<Picture, DenoiseError> {
        let size = [picture.width as usize, picture.height as usize];
        let refused = DenoiseError::Refused;
        let colours = ["R", "G", "B"];
        let [color, albedo, normal] =
            [interleaved(picture, colours)?, interleaved(picture, albedo)?, interleaved(picture, normal)?];
        let cleaned = |name: &CStr, pixels: &[f32]| self.library.filter(size, &[(name, pixels)], &[]);
        let albedo = cleaned(c"albedo", &albedo).map_err(refused)?;
        let normal = cleaned(c"normal", &normal).map_err(refused)?;
        let images = [(c"color", &color[..]), (c"albedo", &albedo), (c"normal", &normal)];
        let clean = self.library.filter(size, &images, &[c"hdr", c"cleanAux"]).map_err(refused)?;
        let mut picture = picture.clone();
        for channel in &mut picture.channels {
            if let Some(c) = colours.iter().position(|name| *name == channel.name) {
                channel.samples = clean.iter().skip(c).step_by(3).copied().collect();
            }
        }
        Ok(picture)
    }
}

/// Files to be tried, the best first.
fn candidates(place: Option<&OsStr>) -> Vec<OsString> {
    match place {
        Some(place) if Path::new(place).is_dir() => {
            FILES.iter().map(|file| Path::new(place).join(file).into_os_string()).collect()
        }
        Some(file) => vec![file.to_owned()],
        None => FILES.map(OsString::from).to_vec(),
    }
}

/// Three channels, pixel by pixel.
fn interleaved(picture: &Picture, names: [&str; 3]) -> Result<Vec<f32>, DenoiseError> {
    let mut planes = [&[][..]; 3];
    for (plane, name) in planes.iter_mut().zip(names) {
        *plane = picture.plane(name).ok_or_else(|| DenoiseError::NoChannel(name.to_owned()))?;
    }
    let [x, y, z] = planes;
    Ok(x.iter().zip(y).zip(z).flat_map(|((&x, &y), &z)| [x, y, z]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Channel;

    #[test]
    fn what_is_no_library_is_told_with_its_place() {
        for (place, file) in [("/no/such/file", "/no/such/file"), ("src", "src")] {
            let error = Denoiser::load(Some(OsStr::new(place)), 1).unwrap_err().to_string();
            assert!(error.contains("was not found; looked for ") && error.contains(file), "{error}");
        }
        // A file that is something else.
        let error = Denoiser::load(Some(OsStr::new("./Cargo.toml")), 1).unwrap_err().to_string();
        assert!(error.contains("looked for ./Cargo.toml ("), "{error}");
    }

    #[test]
    fn pixels_have_their_channels_together_and_missing_ones_are_named() {
        let channel = |name: &str, samples: [f32; 2]| Channel { name: name.into(), samples: samples.into() };
        let channels = vec![channel("a", [1.0, 4.0]), channel("b", [2.0, 5.0]), channel("c", [3.0, 6.0])];
        let picture = Picture { width: 2, height: 1, channels, place: None };
        assert_eq!(interleaved(&picture, ["a", "b", "c"]), Ok(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        assert_eq!(interleaved(&picture, ["a", "d", "c"]), Err(DenoiseError::NoChannel("d".into())));
    }
}
