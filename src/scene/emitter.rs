//! Lights that are not shapes.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::Rgb;
use crate::picture::Picture;

/// A light without a surface. Area lights are [`Shape::radiance`](super::Shape::radiance).
#[derive(Clone, Debug, PartialEq)]
pub enum Emitter {
    /// Isotropic point: irradiance I cos θ / d² at distance d.
    Point {
        /// World space.
        position: DVec3,
        /// Radiant intensity, W/sr.
        intensity: Rgb,
    },
    /// A cone of light from a point, full inside `beam_width`, then linear **in the angle** down to
    /// zero at `cutoff_angle`.
    Spot {
        /// World space.
        position: DVec3,
        /// Axis, the way the light travels; unit length, world space.
        direction: DVec3,
        /// Radiant intensity on the axis, W/sr.
        intensity: Rgb,
        /// Half angle of the cone, radians.
        cutoff_angle: f64,
        /// Half angle of the part at full intensity, radians.
        beam_width: f64,
    },
    /// Parallel light from infinitely far away.
    Directional {
        /// The way the light travels; unit length, world space.
        direction: DVec3,
        /// Irradiance of a surface at right angles to the light, W/m².
        irradiance: Rgb,
    },
    /// The same radiance from everywhere: the environment of whatever is in the scene.
    Constant {
        /// W/(m² sr).
        radiance: Rgb,
    },
    /// A picture all around: row 0 at local +y, columns from −z over +x, rows aligned to the poles,
    /// bilinear.
    Envmap {
        /// `R G B`, W/(m² sr), finite; what is negative is taken as 0.
        picture: Arc<Picture>,
        /// Radiance is the picture's times this.
        scale: f32,
        /// Turns, and perhaps mirrors: orthonormal columns.
        to_world: DMat3,
    },
    /// Light from all around, without shadows, in nine spherical harmonics about local axes.
    Sh {
        /// W/(m² sr), by l, then m.
        coefficients: [Rgb; 9],
        /// Turns, and perhaps mirrors: orthonormal columns.
        to_world: DMat3,
    },
}
