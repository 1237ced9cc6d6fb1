//! Emitters to lights.

use crate::light::{Light, Spot};
use crate::scene::Emitter;

/// Lights without a surface, in the order of the description; area lights follow them.
pub(super) fn without_surface(emitters: &[Emitter]) -> Vec<Light> {
    emitters
        .iter()
        .map(|emitter| match emitter {
            Emitter::Point { position, intensity } => {
                Light::Point { position: position.as_vec3(), intensity: *intensity }
            }
            Emitter::Spot { position, direction, intensity, cutoff_angle, beam_width } => {
                Light::Spot(Spot::new(
                    position.as_vec3(),
                    direction.as_vec3(),
                    *intensity,
                    *cutoff_angle as f32,
                    *beam_width as f32,
                ))
            }
            Emitter::Directional { direction, irradiance } => {
                Light::Directional { towards: -direction.as_vec3(), irradiance: *irradiance }
            }
            Emitter::Constant { radiance } => Light::Constant { radiance: *radiance },
        })
        .collect()
}
