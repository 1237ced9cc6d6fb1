//! Optical constants: numbers, or materials known by name.

use super::super::{
    document::Value,
    files::Files,
    presets::{CONDUCTORS, IORS},
    properties::Object,
    texture::{self, Range},
    vocabulary::did_you_mean,
};
use crate::{
    load::LoadError,
    scene::{Metal, Texture},
};

/// `material`, or `eta` and `k`.
pub(super) fn metal(object: Object, files: &mut Files) -> Result<Metal, LoadError> {
    object.exclude("eta", "material")?;
    object.exclude("k", "material")?;
    let Some(name) = object.string("material")? else {
        let mut coefficient =
            |name, default| texture::colour(object, name, default, Range::Coefficient, files);
        return Ok(Metal { eta: coefficient("eta", 0.0)?, k: coefficient("k", 1.0)? });
    };
    match CONDUCTORS.iter().find(|(known, ..)| *known == name) {
        Some(&(_, eta, k)) => {
            Ok(Metal { eta: Texture::Constant(eta.into()), k: Texture::Constant(k.into()) })
        }
        None => {
            Err(object.error_at("material", format!("the conductor `{name}` is not known")).help(format!(
                "{}; other metals are written as `eta` and `k`",
                did_you_mean(name, CONDUCTORS.map(|(known, ..)| known), "the known ones")
            )))
        }
    }
}

/// An index of refraction, as a number or as the name of a material.
pub(super) fn ior(object: Object, name: &'static str, default: &str) -> Result<f32, LoadError> {
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
