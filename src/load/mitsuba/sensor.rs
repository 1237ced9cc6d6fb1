//! Cameras and samplers.

use super::{files::Files, film, meter, properties::Object, transform, vocabulary::Class};
use crate::{
    load::LoadError,
    scene::{Film, Projection, Sampler, Sensor},
};

/// Diagonal of a 36 mm × 24 mm negative, to which `focal_length` refers.
const DIAGONAL_35MM: f64 = 43.266_615_305_567_87;

#[derive(Clone, Copy)]
enum Axis {
    X,
    Y,
    Smaller,
    Larger,
    Diagonal,
}

pub(super) fn build(object: Object, files: &mut Files) -> Result<Sensor, LoadError> {
    if !object.class().supported().contains(&object.plugin()) {
        return Err(object.unknown_plugin());
    }
    if object.plugin() == meter::PLUGIN {
        return Err(object
            .error(format!("an `{}` stands inside the shape that it measures", meter::PLUGIN))
            .help("write <shape type=\"…\"><sensor type=\"irradiancemeter\">…</sensor></shape>"));
    }
    let to_world = object.to_world()?;
    let film = film::build(object, files)?;
    let sampler = sampler(object, files)?;
    let near_clip = object.positive("near_clip", 0.01)?;
    let far_clip = object.positive("far_clip", 10_000.0)?;
    if far_clip <= near_clip {
        return Err(object.error_at(
            if object.has("far_clip") { "far_clip" } else { "near_clip" },
            format!("`far_clip` ({far_clip}) must be greater than `near_clip` ({near_clip})"),
        ));
    }
    let projection = match object.plugin() {
        "orthographic" => Projection::Orthographic,
        plugin => {
            if transform::similarity(to_world).is_none_or(|factor| (factor - 1.0).abs() > 1e-3) {
                return Err(object
                    .error_at(
                        "to_world",
                        format!("the `to_world` of a `{plugin}` sensor can't scale or shear"),
                    )
                    .help("`fov` sets the size of the picture"));
            }
            let x_fov = x_fov(object, film)?;
            match plugin {
                "thinlens" => Projection::ThinLens {
                    x_fov,
                    aperture_radius: required(object, "aperture_radius", "0.1")?,
                    focus_distance: required(object, "focus_distance", "5")?,
                },
                _ => {
                    // Everything in a pinhole's picture is in focus.
                    object.float("focus_distance")?;
                    Projection::Perspective { x_fov }
                }
            }
        }
    };
    object.finish()?;
    Ok(Sensor { to_world, projection, near_clip, far_clip, film, sampler })
}

/// A number greater than 0 that has no default.
fn required(object: Object, name: &'static str, example: &str) -> Result<f64, LoadError> {
    match object.has(name) {
        true => object.positive(name, 1.0),
        false => {
            // Known here, so that the help can tell it from a misspelt name.
            object.value(name);
            Err(object.missing(name, &format!("<float name=\"{name}\" value=\"{example}\"/>")))
        }
    }
}

fn x_fov(object: Object, film: Film) -> Result<f64, LoadError> {
    object.exclude("fov", "focal_length")?;
    let axis = object.choice(
        "fov_axis",
        &[
            ("x", Axis::X),
            ("y", Axis::Y),
            ("smaller", Axis::Smaller),
            ("larger", Axis::Larger),
            ("diagonal", Axis::Diagonal),
        ],
        Axis::X,
    )?;
    let aspect = f64::from(film.width) / f64::from(film.height);
    let focal_length = focal_length(object)?;
    let Some(fov) = object.float("fov")? else {
        return Ok(span_of_width(DIAGONAL_35MM / (2.0 * focal_length), Axis::Diagonal, aspect));
    };
    match fov > 0.0 && fov < 180.0 {
        true => Ok(span_of_width(libm::tan(fov.to_radians() / 2.0), axis, aspect)),
        false => {
            Err(object.error_at("fov", format!("`fov` must lie between 0 and 180 degrees, but is {fov}")))
        }
    }
}

fn focal_length(object: Object) -> Result<f64, LoadError> {
    let Some(text) = object.string("focal_length")? else { return Ok(50.0) };
    let number = text.trim().trim_end_matches("mm").trim_end().parse::<f64>();
    number.ok().filter(|mm| mm.is_finite() && *mm > 0.0).ok_or_else(|| {
        object.error_at("focal_length", format!("`{text}` is no focal length")).help("write `50mm`")
    })
}

/// The angle that the film's width spans, from the tangent of half the angle along some axis.
fn span_of_width(tangent: f64, axis: Axis, aspect: f64) -> f64 {
    let half_width = match axis {
        Axis::X => tangent,
        Axis::Y => tangent * aspect,
        Axis::Smaller => tangent * aspect.max(1.0),
        Axis::Larger => tangent * aspect.min(1.0),
        Axis::Diagonal => tangent * aspect / (aspect * aspect + 1.0).sqrt(),
    };
    2.0 * libm::atan(half_width)
}

pub(super) fn sampler(sensor: Object, files: &mut Files) -> Result<Sampler, LoadError> {
    let default = Sampler::default();
    let Some(sampler) = sensor.child(Class::Sampler)? else { return Ok(default) };
    if !sampler.class().supported().contains(&sampler.plugin()) {
        return Err(sampler.unknown_plugin());
    }
    if sampler.plugin() != "independent" {
        files.warnings.push(sampler.warning(format!(
            "the sampler `{}` is not supported: `independent` is used in its place",
            sampler.plugin()
        )));
        sampler.boolean("jitter", true)?;
    }
    let result = Sampler {
        sample_count: sampler.count("sample_count", default.sample_count, 1, i32::MAX as u32)?,
        seed: sampler.count("seed", default.seed, 0, u32::MAX)?,
    };
    sampler.finish()?;
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_width_spans_what_the_axis_says() {
        let half = |axis, aspect| (span_of_width(0.5, axis, aspect) / 2.0).tan();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        close(half(Axis::X, 2.0), 0.5);
        close(half(Axis::Y, 2.0), 1.0);
        close(half(Axis::Smaller, 2.0), 1.0);
        close(half(Axis::Smaller, 0.5), 0.5);
        close(half(Axis::Larger, 2.0), 0.5);
        close(half(Axis::Larger, 0.5), 0.25);
        // Width 3, height 4, diagonal 5.
        close(half(Axis::Diagonal, 0.75), 0.3);
    }

    #[test]
    fn fifty_millimetres_span_42_degrees_at_two_to_one() {
        let fov = span_of_width(DIAGONAL_35MM / 100.0, Axis::Diagonal, 2.0).to_degrees();
        assert!((fov - 42.31).abs() < 0.005, "{fov}");
    }
}
