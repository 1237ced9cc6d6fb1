//! Textures, and reflectances that may be textures.

use super::{colour, document::Value, files::Files, properties::Object, transform, vocabulary::Class};
use crate::{
    load::LoadError,
    picture::Picture,
    scene::{Filter, Rgb, Texture, Wrap},
};

/// A reflectance: a colour in [0, 1] or a texture of such colours.
pub(super) fn reflectance(
    object: Object,
    name: &'static str,
    default: f32,
    files: &mut Files,
) -> Result<Texture, LoadError> {
    match object.value(name) {
        None => return Ok(Texture::Constant(Rgb::splat(default))),
        Some(&Value::Object(index)) if object.at(index).class() == Class::Texture => {
            return build(object.at(index), files);
        }
        Some(_) => {}
    }
    let constant = colour::reflectance(object, name)?;
    constant.map(Texture::Constant).ok_or_else(|| object.wrong_kind(name, "`rgb` or `texture`"))
}

/// A texture of reflectances.
pub(super) fn build(object: Object, files: &mut Files) -> Result<Texture, LoadError> {
    let texture = match object.plugin() {
        "checkerboard" => Texture::Checkerboard {
            color0: field(object, "color0", 0.4)?,
            color1: field(object, "color1", 0.2)?,
            to_uv: transform::planar(object.transform("to_uv")?),
        },
        "bitmap" => bitmap(object, files)?,
        _ => return Err(object.unknown_plugin()),
    };
    object.finish()?;
    Ok(texture)
}

fn field(object: Object, name: &'static str, default: f32) -> Result<Rgb, LoadError> {
    if object.value(name).is_none() {
        return Ok(Rgb::splat(default));
    }
    colour::reflectance(object, name)?.ok_or_else(|| object.wrong_kind(name, "`rgb`"))
}

fn bitmap(object: Object, files: &mut Files) -> Result<Texture, LoadError> {
    let raw = object.boolean("raw", false)?;
    let picture = files.picture(object, raw)?;
    if let Some(worst) = out_of_range(&picture) {
        return Err(object
            .error_at("filename", format!("the picture has the value {worst}, no reflectance"))
            .help("reflectances lie between 0 and 1"));
    }
    Ok(Texture::Bitmap {
        picture,
        filter: object.choice(
            "filter_type",
            &[("bilinear", Filter::Bilinear), ("nearest", Filter::Nearest)],
            Filter::Bilinear,
        )?,
        wrap: object.choice(
            "wrap_mode",
            &[("repeat", Wrap::Repeat), ("mirror", Wrap::Mirror), ("clamp", Wrap::Clamp)],
            Wrap::Repeat,
        )?,
        to_uv: transform::planar(object.transform("to_uv")?),
    })
}

fn out_of_range(picture: &Picture) -> Option<f32> {
    let mut samples = picture.channels.iter().flat_map(|channel| &channel.samples);
    samples.find(|sample| !(0.0..=1.0).contains(*sample)).copied()
}
