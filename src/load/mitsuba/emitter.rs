//! Lights that are not shapes.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::{
    colour,
    files::{Files, existing_file},
    properties::Object,
};
use crate::{
    load::{LoadError, sh},
    scene::{Emitter, Rgb},
};

/// How far from a right angle, or from each other's length, the axes of an environment may be.
const STRETCH: f64 = 1e-4;

pub(super) fn build(object: Object, files: &mut Files) -> Result<Emitter, LoadError> {
    let emitter = match object.plugin() {
        "point" => {
            let intensity = colour::emission(object, "intensity")?;
            object.exclude("position", "to_world")?;
            let moved = object.to_world()?.translation;
            Emitter::Point { position: object.vector("position")?.unwrap_or(moved), intensity }
        }
        "spot" => {
            let to_world = object.to_world()?;
            let (cutoff_angle, beam_width) = cone(object)?;
            Emitter::Spot {
                position: to_world.translation,
                direction: to_world.matrix3.z_axis.normalize(),
                intensity: colour::emission(object, "intensity")?,
                cutoff_angle,
                beam_width,
            }
        }
        "directional" => Emitter::Directional {
            direction: direction(object)?,
            irradiance: colour::emission(object, "irradiance")?,
        },
        "constant" => Emitter::Constant { radiance: colour::emission(object, "radiance")? },
        "envmap" => envmap(object, files)?,
        "shlight" => shlight(object)?,
        "area" => {
            return Err(object
                .error("an `area` emitter stands inside the shape that shines")
                .help("write <shape type=\"…\"><emitter type=\"area\">…</emitter></shape>"));
        }
        _ => return Err(object.unknown_plugin()),
    };
    object.finish()?;
    Ok(emitter)
}

fn cone(object: Object) -> Result<(f64, f64), LoadError> {
    let cutoff = object.positive("cutoff_angle", 20.0)?;
    if cutoff >= 180.0 {
        return Err(object.error_at("cutoff_angle", "`cutoff_angle` must be less than 180 degrees"));
    }
    let beam = object.float("beam_width")?.unwrap_or(cutoff * 0.75);
    if !(0.0..=cutoff).contains(&beam) {
        return Err(object
            .error_at("beam_width", format!("`beam_width` is {beam}, outside of [0, {cutoff}]"))
            .help("both angles are measured from the axis, in degrees: `beam_width` <= `cutoff_angle`"));
    }
    Ok((cutoff.to_radians(), beam.to_radians()))
}

fn direction(object: Object) -> Result<DVec3, LoadError> {
    object.exclude("direction", "to_world")?;
    let turned = object.to_world()?.matrix3.z_axis;
    let direction = object.vector("direction")?.unwrap_or(turned);
    direction.try_normalize().ok_or_else(|| object.error_at("direction", "`direction` is zero"))
}

fn envmap(object: Object, files: &mut Files) -> Result<Emitter, LoadError> {
    let picture = files.picture(object, false)?;
    let scale = object.float("scale")?.unwrap_or(1.0) as f32;
    if !(scale >= 0.0 && scale.is_finite()) {
        return Err(object.error_at("scale", "`scale` must not be negative or exceed 32 bits"));
    }
    let mut negative = 0;
    for channel in &picture.channels {
        if let Some(place) = channel.samples.iter().position(|sample| !(sample * scale).is_finite()) {
            let (x, y) = (place % picture.width as usize, place / picture.width as usize);
            let value = channel.samples[place];
            return Err(object
                .error_at(
                    "filename",
                    format!("{} of pixel ({x}, {y}) is {value}: not a radiance", channel.name),
                )
                .help("an environment's pixels are finite, times `scale` too"));
        }
        negative += channel.samples.iter().filter(|sample| **sample < 0.0).count();
    }
    if negative > 0 {
        let message = format!("negative values in the picture ({negative}) are taken as 0");
        files.warnings.push(object.span("filename").warning(message));
    }
    Ok(Emitter::Envmap { picture: Arc::clone(&picture), scale, to_world: turn(object)? })
}

fn shlight(object: Object) -> Result<Emitter, LoadError> {
    let path = existing_file(object)?;
    let read = sh::read(&path).map_err(|why| {
        object
            .error_at("filename", format!("the coefficients can't be used: {why}"))
            .help("`packlight envmap sky.exr --sh -o sky.json` writes them")
    })?;
    let scale = object.float("scale")?.unwrap_or(1.0) as f32;
    let coefficients = read.coefficients.map(|rgb| scale * Rgb::from_array(rgb));
    if !(scale >= 0.0 && coefficients.iter().all(|rgb| rgb.is_finite())) {
        return Err(object.error_at("scale", "`scale` must not be negative or exceed 32 bits"));
    }
    Ok(Emitter::Sh { coefficients, to_world: turn(object)? })
}

/// The turn in `to_world`: what is infinitely far away is neither moved nor scaled.
fn turn(object: Object) -> Result<DMat3, LoadError> {
    let matrix = object.to_world()?.matrix3;
    let scale = matrix.determinant().abs().cbrt();
    let turn = matrix * (1.0 / scale);
    let unequal = turn.transpose() * turn - DMat3::IDENTITY;
    match unequal.to_cols_array().iter().all(|off| off.abs() < STRETCH) {
        true => Ok(turn),
        false => Err(object
            .error_at("to_world", "an environment can be turned and mirrored, not stretched")
            .help("scale all axes alike, or none")),
    }
}
