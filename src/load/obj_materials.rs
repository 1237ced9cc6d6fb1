//! What the materials of an OBJ file mean here: Lambert, or Phong where there is a highlight.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use glam::DAffine2;

use super::{
    LoadError, Warning,
    mtl::{self, MtlMaterial},
};
use crate::{
    picture::{self, Encoding, Picture},
    scene::{Filter, Material, Rgb, Texture, Wrap},
};

/// The materials that an OBJ file can use, and the pictures that were read for them.
pub(super) struct Library {
    /// Of the OBJ file.
    path: PathBuf,
    materials: HashMap<String, MtlMaterial>,
    /// `None` could not be read, which has been said.
    pictures: HashMap<PathBuf, Option<Arc<Picture>>>,
}

impl Library {
    /// Reads the libraries beside the OBJ file; one that is missing is a warning.
    pub(super) fn read(
        path: &Path,
        names: &[String],
        warnings: &mut Vec<Warning>,
    ) -> Result<Self, LoadError> {
        let mut materials = HashMap::new();
        for name in names {
            let file = path.with_file_name(name.replace('\\', "/"));
            if !file.is_file() {
                let message = format!("the material library {name} is missing: its materials are grey");
                warnings.push(Warning::new(path, message));
                continue;
            }
            let found = mtl::read(&file, warnings)?;
            materials.extend(found.into_iter().map(|material| (material.name.clone(), material)));
        }
        Ok(Self { path: path.to_owned(), materials, pictures: HashMap::new() })
    }

    /// The reflection model called `name`, and the radiance that it emits.
    pub(super) fn material(
        &mut self,
        name: &str,
        warnings: &mut Vec<Warning>,
    ) -> Option<(Material, Option<Rgb>)> {
        let Some(mtl) = self.materials.get(name) else {
            if !name.is_empty() {
                let message = format!("there is no material `{name}`: its faces are grey");
                warnings.push(Warning::new(&self.path, message));
            }
            return None;
        };
        let mtl = mtl.clone();
        let picture = mtl.map_kd.as_deref().and_then(|file| self.picture(file, warnings));
        let radiance = (mtl.ke != Rgb::ZERO).then_some(mtl.ke);
        Some((reflection(&mtl, picture), radiance))
    }

    fn picture(&mut self, file: &Path, warnings: &mut Vec<Warning>) -> Option<Arc<Picture>> {
        let read = || match picture::decode(file, Encoding::Srgb) {
            Ok(picture) => Some(Arc::new(picture)),
            Err(error) => {
                let message = format!("a texture can't be read, Kd is used in its place: {error}");
                warnings.push(Warning::new(&self.path, message));
                None
            }
        };
        self.pictures.entry(file.to_owned()).or_insert_with(read).clone()
    }
}

fn reflection(mtl: &MtlMaterial, picture: Option<Arc<Picture>>) -> Material {
    let kd = mtl.kd.unwrap_or(Rgb::splat(0.6));
    if mtl.ks == Rgb::ZERO || mtl.ns <= 1.0 {
        return Material::Diffuse { reflectance: texture(kd, picture, 1.0) };
    }
    // Both are dimmed together where they would reflect more light than comes in.
    let brightest = picture.as_deref().map_or(kd, brightest);
    let scale = 1.0 / (brightest + mtl.ks).max_element().max(1.0);
    Material::Phong {
        diffuse_reflectance: texture(kd, picture, scale),
        specular_reflectance: Texture::Constant(mtl.ks * scale),
        exponent: Texture::Constant(Rgb::splat(mtl.ns)),
    }
}

/// The picture if there is one, else the colour; scaled.
fn texture(kd: Rgb, picture: Option<Arc<Picture>>, scale: f32) -> Texture {
    let Some(mut picture) = picture else { return Texture::Constant(kd * scale) };
    if scale < 1.0 {
        let samples =
            Arc::make_mut(&mut picture).channels.iter_mut().flat_map(|channel| &mut channel.samples);
        samples.for_each(|sample| *sample *= scale);
    }
    Texture::Bitmap { picture, filter: Filter::Bilinear, wrap: Wrap::Repeat, to_uv: DAffine2::IDENTITY }
}

fn brightest(picture: &Picture) -> Rgb {
    let max = |name| picture.plane(name).into_iter().flatten().fold(0.0, |max: f32, &sample| max.max(sample));
    Rgb::new(max("R"), max("G"), max("B"))
}
