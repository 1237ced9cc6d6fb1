//! Lights that are not shapes.

use glam::DVec3;

use super::{colour, properties::Object};
use crate::{load::LoadError, scene::Emitter};

pub(super) fn build(object: Object) -> Result<Emitter, LoadError> {
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
