//! Colours: reflectances, optical constants and emission, each with its range.

use super::{document::Value, properties::Object};
use crate::{load::LoadError, scene::Rgb};

/// A `spectrum` in an emitter means equal energy at every wavelength: not white in linear sRGB.
const EQUAL_ENERGY: [f64; 3] = [1.2048, 0.9483, 0.9089];

/// A colour in [0, 1]; `None` if the property is absent or is not a plain colour.
pub(super) fn reflectance(object: Object, name: &'static str) -> Result<Option<Rgb>, LoadError> {
    if let Some(Value::Curve(curve)) = object.value(name)
        && curve.most() <= 1.0
    {
        // Saturated colours that surfaces can have, but sRGB can't.
        let rgb = curve.reflected();
        return Ok(Some(single(in_gamut(object, name, rgb.map(|band| band.clamp(0.0, 1.0)), rgb))));
    }
    let Some(rgb) = plain(object, name) else { return Ok(None) };
    match rgb.iter().all(|band| (0.0..=1.0).contains(band)) {
        true => Ok(Some(single(rgb))),
        false => Err(object
            .error_at(name, format!("`{name}` must lie between 0 and 1"))
            .label("out of range")
            .help("a surface can't reflect more light than it receives")),
    }
}

/// A colour from 0 up, such as an index of refraction.
pub(super) fn coefficient(object: Object, name: &'static str, default: f32) -> Result<Rgb, LoadError> {
    if !object.has(name) {
        object.value(name);
        return Ok(Rgb::splat(default));
    }
    let rgb = plain(object, name).ok_or_else(|| object.wrong_kind(name, "`rgb`"))?;
    not_negative(object, name, rgb)
}

/// A number in [0, 1].
pub(super) fn unit(object: Object, name: &'static str, default: f64) -> Result<f64, LoadError> {
    let number = match object.value(name) {
        None => default,
        Some(&Value::Spectrum(grey) | &Value::Float(grey)) => grey,
        Some(&Value::Integer(grey)) => grey as f64,
        Some(&Value::Rgb([r, g, b])) if r == g && g == b => r,
        Some(_) => return Err(object.wrong_kind(name, "`float` or `texture`")),
    };
    match (0.0..=1.0).contains(&number) {
        true => Ok(number),
        false => Err(object
            .error_at(name, format!("`{name}` must lie between 0 and 1, but is {number}"))
            .label("out of range")),
    }
}

/// Radiance, intensity or irradiance; 1 if it is absent.
pub(super) fn emission(object: Object, name: &'static str) -> Result<Rgb, LoadError> {
    let rgb = match object.value(name) {
        None => return Ok(Rgb::ONE),
        Some(&Value::Rgb(rgb)) => rgb,
        Some(&Value::Spectrum(number)) => EQUAL_ENERGY.map(|band| band * number),
        Some(&Value::Float(grey)) => [grey; 3],
        Some(&Value::Integer(grey)) => [grey as f64; 3],
        Some(Value::Curve(curve)) => {
            let rgb = curve.emitted();
            in_gamut(object, name, rgb.map(|band| band.max(0.0)), rgb)
        }
        Some(Value::Object(_)) => {
            return Err(object
                .error_at(name, format!("a texture as `{name}` is not supported yet"))
                .help(format!("write <rgb name=\"{name}\" value=\"1, 1, 1\"/>")));
        }
        Some(_) => return Err(object.wrong_kind(name, "`rgb`")),
    };
    not_negative(object, name, rgb)
}

fn plain(object: Object, name: &'static str) -> Option<[f64; 3]> {
    match *object.value(name)? {
        Value::Rgb(rgb) => Some(rgb),
        Value::Spectrum(grey) | Value::Float(grey) => Some([grey; 3]),
        Value::Integer(grey) => Some([grey as f64; 3]),
        Value::Curve(ref curve) => {
            let rgb = curve.reflected();
            Some(in_gamut(object, name, rgb.map(|band| band.max(0.0)), rgb))
        }
        _ => None,
    }
}

/// The nearest colour that sRGB has, with a warning if it is another one.
fn in_gamut(object: Object, name: &str, clamped: [f64; 3], [r, g, b]: [f64; 3]) -> [f64; 3] {
    // A step of rounding is no other colour.
    if clamped.iter().zip([r, g, b]).any(|(inside, band)| (inside - band).abs() > 1e-6) {
        let colour =
            format!("`{name}` is the colour ({r:.4}, {g:.4}, {b:.4}), which sRGB lacks: it is clamped");
        object.warn_at(name, colour);
    }
    clamped
}

fn not_negative(object: Object, name: &str, rgb: [f64; 3]) -> Result<Rgb, LoadError> {
    let colour = single(rgb);
    match rgb.iter().all(|band| *band >= 0.0) && colour.is_finite() {
        true => Ok(colour),
        false => Err(object.error_at(name, format!("`{name}` must not be negative or exceed 32 bits"))),
    }
}

fn single(rgb: [f64; 3]) -> Rgb {
    Rgb::from_array(rgb.map(|band| band as f32))
}
