//! Textures, and parameters that may be textures.

use super::{
    colour, document::Value, files::Files, mesh_attribute, properties::Object, transform, vocabulary::Class,
};
pub(super) use crate::scene::Texture;
use crate::{
    load::LoadError,
    scene::{Filter, Rgb, Wrap},
};

/// What the values of a parameter may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Range {
    /// [0, 1]: reflectances and shares.
    Unit,
    /// From 0 up: optical constants and heights.
    Coefficient,
    /// Above 0: roughness. A texture may touch 0.
    Positive,
}

impl Range {
    /// The first value out of range.
    pub(super) fn outside(self, values: &mut impl Iterator<Item = f32>) -> Option<f32> {
        let most = if self == Self::Unit { 1.0 } else { f32::MAX };
        values.find(|value| !(0.0..=most).contains(value))
    }

    pub(super) fn help(self) -> &'static str {
        match self {
            Self::Unit => "reflectances lie between 0 and 1",
            Self::Coefficient | Self::Positive => "it must not be negative",
        }
    }
}

/// A colour, or a texture of colours.
pub(super) fn colour(
    object: Object,
    name: &'static str,
    default: f32,
    range: Range,
    files: &mut Files,
) -> Result<Texture, LoadError> {
    match object.value(name) {
        None => return Ok(Texture::Constant(Rgb::splat(default))),
        Some(&Value::Object(index)) if object.at(index).class() == Class::Texture => {
            return build(object.at(index), range, files);
        }
        Some(_) => {}
    }
    if range != Range::Unit {
        return colour::coefficient(object, name, default).map(Texture::Constant);
    }
    let constant = colour::reflectance(object, name)?;
    constant.map(Texture::Constant).ok_or_else(|| object.wrong_kind(name, "`rgb` or `texture`"))
}

/// A number, or a texture of which the luminance is taken.
pub(super) fn number(
    object: Object,
    name: &'static str,
    default: f32,
    range: Range,
    files: &mut Files,
) -> Result<Texture, LoadError> {
    if let Some(&Value::Object(index)) = object.value(name)
        && object.at(index).class() == Class::Texture
    {
        return Ok(match build(object.at(index), range, files)? {
            // Mitsuba exchanges the fields where a checkerboard is asked for one number, not for a colour.
            Texture::Checkerboard { color0, color1, to_uv } => {
                Texture::Checkerboard { color0: color1, color1: color0, to_uv }
            }
            texture => texture,
        });
    }
    let number = match range {
        Range::Positive => object.positive(name, f64::from(default))?,
        _ => colour::unit(object, name, f64::from(default))?,
    };
    Ok(Texture::Constant(Rgb::splat(number as f32)))
}

/// A texture of values in a range.
pub(super) fn build(object: Object, range: Range, files: &mut Files) -> Result<Texture, LoadError> {
    let texture = match object.plugin() {
        "checkerboard" => Texture::Checkerboard {
            color0: field(object, "color0", 0.4)?,
            color1: field(object, "color1", 0.2)?,
            to_uv: transform::planar(object.transform("to_uv")?),
        },
        "bitmap" => bitmap(object, range, files)?,
        mesh_attribute::PLUGIN => mesh_attribute::build(object, range, files)?,
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

fn bitmap(object: Object, range: Range, files: &mut Files) -> Result<Texture, LoadError> {
    let raw = object.boolean("raw", false)?;
    let picture = files.picture(object, raw)?;
    let mut samples = picture.channels.iter().flat_map(|channel| &channel.samples).copied();
    if let Some(worst) = range.outside(&mut samples) {
        return Err(object
            .error_at("filename", format!("the picture has the value {worst}, which is out of range"))
            .help(range.help()));
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
