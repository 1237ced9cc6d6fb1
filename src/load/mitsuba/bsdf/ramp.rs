//! The ramp of a `toon`: bands, or stops written as text.
//!
//! ```text
//! 0.1: 0.1 0 0.3; 0.5: 0.5 0.2 0.1; 0.9: 1        cosine: colour; cosine: colour; …
//! ```

use super::super::{files::Files, properties::Object};
use crate::{
    load::LoadError,
    scene::{Ramp, Rgb, Stop},
};

/// More stops than a lane should be asked for.
const MAX_STOPS: usize = 64;

/// `bands`, or `ramp` and whether it is `smooth`.
pub(super) fn ramp(object: Object, files: &mut Files) -> Result<Ramp, LoadError> {
    object.exclude("bands", "ramp")?;
    let Some(text) = object.string("ramp")? else {
        return Ok(Ramp::Bands(object.count("bands", 3, 2, 256)?));
    };
    let smooth = object.boolean("smooth", false)?;
    let stops = text.split(';').filter(|part| !part.trim().is_empty());
    let stops = stops.map(|part| stop(object, part.trim())).collect::<Result<Vec<_>, _>>()?;
    let wrong = |why: String| object.error_at("ramp", why).help(FORM);
    if stops.is_empty() || stops.len() > MAX_STOPS {
        return Err(wrong(format!("a ramp has 1 to {MAX_STOPS} stops, not {}", stops.len())));
    }
    if let Some(pair) = stops.windows(2).find(|pair| pair[0].cos >= pair[1].cos) {
        return Err(wrong(format!("stops must ascend, but {} stands before {}", pair[0].cos, pair[1].cos)));
    }
    let ramp = if smooth { Ramp::Smooth(stops) } else { Ramp::Steps(stops) };
    let albedo = ramp.albedo().max_element();
    if albedo > 1.0 {
        files.warnings.push(object.span("ramp").warning(format!(
            "the ramp reflects {albedo:.2} times the light that arrives, before `reflectance`"
        )));
    }
    Ok(ramp)
}

const FORM: &str =
    "write cosine: colour; cosine: colour, as in `0.1: 0.1 0 0.3; 0.5: 0.5 0.2 0.1; 0.9: 1`, all from 0 to 1";

fn stop(object: Object, text: &str) -> Result<Stop, LoadError> {
    let refused = || object.error_at("ramp", format!("`{text}` is no stop of a ramp")).help(FORM);
    let unit = |word: &str| word.trim().parse::<f32>().ok().filter(|x| (0.0..=1.0).contains(x));
    let (cos, color) = text.split_once(':').ok_or_else(refused)?;
    let color = color.split([' ', ',']).filter(|word| !word.is_empty()).map(unit).collect::<Option<Vec<_>>>();
    let color = match color.as_deref() {
        Some(&[grey]) => Rgb::splat(grey),
        Some(&[r, g, b]) => Rgb::new(r, g, b),
        _ => return Err(refused()),
    };
    Ok(Stop { cos: unit(cos).ok_or_else(refused)?, color })
}
