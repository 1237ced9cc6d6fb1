//! Emitters to lights.

use glam::{DMat3, DVec3, Vec3};

use crate::light::{Envmap, Light, LightChoice, ShLight, Spot};
use crate::picture::Picture;
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
            Emitter::Envmap { picture, scale, to_world } => Light::Envmap(envmap(picture, *scale, *to_world)),
            Emitter::Sh { coefficients, to_world } => Light::Sh(ShLight::new(*coefficients, axes(*to_world))),
        })
        .collect()
}

/// The choice among the lights of a scene of this radius.
pub(super) fn choice(lights: &[Light], radius: f32) -> LightChoice {
    let powers: Vec<f32> = lights.iter().map(|light| light.power(radius)).collect();
    LightChoice::new(lights.iter().map(Light::glimpse).collect(), &powers)
}

/// The light of a picture with planes `R G B`, finite; what is negative is taken as 0.
pub fn envmap(picture: &Picture, scale: f32, to_world: DMat3) -> Envmap {
    let planes = ["R", "G", "B"].map(|name| picture.plane(name).unwrap_or_default());
    let texels = (0..picture.width as usize * picture.height as usize)
        .map(|i| planes.map(|plane| scale * plane[i].max(0.0)))
        .collect();
    Envmap::new(texels, picture.width, axes(to_world))
}

fn axes(to_world: DMat3) -> [Vec3; 3] {
    [to_world.x_axis, to_world.y_axis, to_world.z_axis].map(DVec3::as_vec3)
}
