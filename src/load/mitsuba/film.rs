//! Films: the size of the picture and the filter of its pixels.

use super::{files::Files, properties::Object, vocabulary::Class};
use crate::{
    load::LoadError,
    scene::{Crop, Film, PixelFormat, ReconstructionFilter},
};

/// Pictures wider or higher than this are taken for slips.
const MAX_SIDE: u32 = 65_536;
/// Filters wider than this, in pixels, are taken for slips.
const MAX_RADIUS: f64 = 64.0;

/// The standard deviation of a `gaussian` filter.
const STDDEV: f64 = 0.5;

/// The film of a sensor.
pub(super) fn build(sensor: Object, files: &mut Files) -> Result<Film, LoadError> {
    let default = Film { filter: ReconstructionFilter::Gaussian { stddev: STDDEV }, ..Film::default() };
    let Some(film) = sensor.child(Class::Film)? else {
        files.warnings.push(
            sensor.warning("the sensor has no film: 768 × 576 pixels and a `gaussian` filter are used"),
        );
        return Ok(default);
    };
    if film.plugin() != "hdrfilm" {
        return Err(film.unknown_plugin());
    }
    let width = film.count("width", default.width, 1, MAX_SIDE)?;
    let height = film.count("height", default.height, 1, MAX_SIDE)?;
    let crop = crop(film, width, height)?;
    let format = format(film, files)?;
    // Samples are drawn about each pixel, at the border as elsewhere: nothing is there to be chosen.
    film.boolean("sample_border", false)?;
    film.boolean("compensate", false)?;
    let filter = film.child(Class::RFilter)?.map_or(Ok(default.filter), filter)?;
    film.finish()?;
    Ok(Film { width, height, crop, filter, format })
}

fn crop(film: Object, width: u32, height: u32) -> Result<Option<Crop>, LoadError> {
    let names = ["crop_offset_x", "crop_offset_y", "crop_width", "crop_height"];
    let given = names.iter().any(|name| film.has(name));
    let crop = Crop {
        x: film.count("crop_offset_x", 0, 0, MAX_SIDE)?,
        y: film.count("crop_offset_y", 0, 0, MAX_SIDE)?,
        width: film.count("crop_width", width, 1, MAX_SIDE)?,
        height: film.count("crop_height", height, 1, MAX_SIDE)?,
    };
    for (offset, size, from, length, whole) in [
        ("crop_offset_x", "crop_width", crop.x, crop.width, width),
        ("crop_offset_y", "crop_height", crop.y, crop.height, height),
    ] {
        if from + length > whole {
            let at = if film.has(size) { size } else { offset };
            return Err(film
                .error_at(at, format!("the crop ends at {}, but the film at {whole}", from + length))
                .help(format!("`{offset}` and `{size}` together must not exceed the size of the film")));
        }
    }
    Ok(given.then_some(crop))
}

/// The channels of the picture. Which file holds them is chosen on the command line, and it has all bits.
fn format(film: Object, files: &mut Files) -> Result<PixelFormat, LoadError> {
    film.choice("file_format", &[("openexr", ()), ("exr", ()), ("rgbe", ()), ("pfm", ())], ())?;
    film.choice("component_format", &[("float16", ()), ("float32", ()), ("uint32", ())], ())?;
    let known = [
        ("rgb", Some(PixelFormat::Rgb)),
        ("rgba", Some(PixelFormat::Rgba)),
        ("luminance", Some(PixelFormat::Luminance)),
        ("luminance_alpha", Some(PixelFormat::LuminanceAlpha)),
        ("xyz", None),
        ("xyza", None),
    ];
    let format = film.choice("pixel_format", &known, Some(PixelFormat::Rgb))?;
    if format.is_none() {
        let message = "the tristimulus values of this format are not written: the picture has R, G and B";
        files.warnings.push(film.span("pixel_format").warning(message));
    }
    Ok(format.unwrap_or_default())
}

fn filter(object: Object) -> Result<ReconstructionFilter, LoadError> {
    let filter = match object.plugin() {
        "box" => ReconstructionFilter::Box,
        "gaussian" => ReconstructionFilter::Gaussian { stddev: length(object, "stddev", STDDEV)? },
        "tent" => ReconstructionFilter::Tent { radius: length(object, "radius", 1.0)? },
        "mitchell" => ReconstructionFilter::Mitchell { b: share(object, "B")?, c: share(object, "C")? },
        "catmullrom" => ReconstructionFilter::CatmullRom,
        "lanczos" => ReconstructionFilter::Lanczos { lobes: object.count("lobes", 3, 1, 16)? },
        _ => return Err(object.unknown_plugin()),
    };
    object.finish()?;
    Ok(filter)
}

fn length(object: Object, name: &'static str, default: f64) -> Result<f64, LoadError> {
    let length = object.positive(name, default)?;
    match length <= MAX_RADIUS {
        true => Ok(length),
        false => Err(object
            .error_at(name, format!("`{name}` is {length}, more than {MAX_RADIUS} pixels"))
            .help("lengths of a filter are in pixels")),
    }
}

/// B or C of Mitchell's cubics, which sum to less than nothing for others.
fn share(object: Object, name: &'static str) -> Result<f64, LoadError> {
    let share = object.float(name)?.unwrap_or(1.0 / 3.0);
    match (0.0..=1.0).contains(&share) {
        true => Ok(share),
        false => Err(object.error_at(name, format!("`{name}` must lie between 0 and 1, but is {share}"))),
    }
}
