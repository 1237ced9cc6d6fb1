//! Reflection models.

use super::{
    colour,
    document::Value,
    files::Files,
    presets::{CONDUCTORS, IORS},
    properties::Object,
    texture,
    vocabulary::{Class, did_you_mean},
};
use crate::{
    load::LoadError,
    scene::{Material, Rgb},
};

pub(super) fn build(object: Object, files: &mut Files) -> Result<Material, LoadError> {
    let mut reflectance = |name, default| texture::reflectance(object, name, default, files);
    let material = match object.plugin() {
        "diffuse" => Material::Diffuse { reflectance: reflectance("reflectance", 0.5)? },
        "conductor" => {
            let specular_reflectance = reflectance("specular_reflectance", 1.0)?;
            let (eta, k) = conductor(object)?;
            Material::Conductor { eta, k, specular_reflectance }
        }
        "dielectric" => Material::Dielectric {
            specular_reflectance: reflectance("specular_reflectance", 1.0)?,
            specular_transmittance: reflectance("specular_transmittance", 1.0)?,
            int_ior: ior(object, "int_ior", "bk7")?,
            ext_ior: ior(object, "ext_ior", "air")?,
        },
        "phong" => Material::Phong {
            diffuse_reflectance: reflectance("diffuse_reflectance", 0.5)?,
            specular_reflectance: reflectance("specular_reflectance", 0.2)?,
            exponent: object.positive("exponent", 30.0)? as f32,
        },
        "twosided" => two_sided(object, files)?,
        _ => return Err(object.unknown_plugin()),
    };
    object.finish()?;
    Ok(material)
}

fn conductor(object: Object) -> Result<(Rgb, Rgb), LoadError> {
    object.exclude("eta", "material")?;
    object.exclude("k", "material")?;
    let Some(name) = object.string("material")? else {
        return Ok((colour::coefficient(object, "eta", 0.0)?, colour::coefficient(object, "k", 1.0)?));
    };
    match CONDUCTORS.iter().find(|(known, ..)| *known == name) {
        Some(&(_, eta, k)) => Ok((eta.into(), k.into())),
        None => {
            Err(object.error_at("material", format!("the conductor `{name}` is not known")).help(format!(
                "{}; other metals are written as `eta` and `k`",
                did_you_mean(name, CONDUCTORS.map(|(known, ..)| known), "the known ones")
            )))
        }
    }
}

/// An index of refraction, as a number or as the name of a material.
fn ior(object: Object, name: &'static str, default: &str) -> Result<f32, LoadError> {
    let word = match object.value(name) {
        None => default,
        Some(Value::String(word)) => word,
        Some(Value::Float(_) | Value::Integer(_)) => return Ok(object.positive(name, 1.0)? as f32),
        Some(_) => return Err(object.wrong_kind(name, "`float` or `string`")),
    };
    match IORS.iter().find(|(known, _)| *known == word) {
        Some(&(_, ior)) => Ok(ior),
        None => Err(object
            .error_at(name, format!("the index of refraction of `{word}` is not known"))
            .help(did_you_mean(word, IORS.map(|(known, _)| known), "the known ones"))),
    }
}

fn two_sided(object: Object, files: &mut Files) -> Result<Material, LoadError> {
    let mut side = |nested: Object| match nested.plugin() {
        "twosided" => Err(nested.error("a `twosided` bsdf can't stand inside another")),
        "dielectric" => Err(nested
            .error("`twosided` is for opaque bsdfs: a `dielectric` already has two sides")
            .help("use the `dielectric` without `twosided`")),
        _ => build(nested, files).map(Box::new),
    };
    match object.children(Class::Bsdf)[..] {
        [front] => Ok(Material::TwoSided { front: side(front)?, back: None }),
        [front, back] => Ok(Material::TwoSided { front: side(front)?, back: Some(side(back)?) }),
        ref other => Err(object
            .error(format!("`twosided` takes one bsdf, or a second for the back, but has {}", other.len()))
            .help("write <bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf>")),
    }
}
