//! A point that shines into a cone.
//!
//! Full intensity within `beam_width`, then **linear in the angle** down to 0 at `cutoff_angle`.

use glam::Vec3;

use crate::math::acos;
use crate::simd::{Real, Vector3};

/// A spot light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// World space.
    pub position: Vec3,
    direction: Vec3,
    intensity: Vec3,
    cutoff_angle: f32,
    /// 1/(cutoff − beam).
    falloff: f32,
}

impl Spot {
    /// `direction` is the way the light travels; angles in radians from it, `beam_width` not above
    /// `cutoff_angle`.
    pub fn new(position: Vec3, direction: Vec3, intensity: Vec3, cutoff_angle: f32, beam_width: f32) -> Self {
        let falloff = if beam_width < cutoff_angle { 1.0 / (cutoff_angle - beam_width) } else { f32::MAX };
        Self { position, direction, intensity, cutoff_angle, falloff }
    }

    /// Within the beam, W/sr.
    pub(super) fn intensity_on_axis(&self) -> Vec3 {
        self.intensity
    }

    /// Radiant intensity towards a receiver that sees the light along `wi`.
    #[inline]
    pub fn intensity<R: Real>(&self, wi: Vector3<R>) -> Vector3<R> {
        let angle = acos(-wi.dot(Vector3::splat(self.direction)));
        let falloff = ((R::splat(self.cutoff_angle) - angle) * R::splat(self.falloff)).clamp(0.0, 1.0);
        Vector3::splat(self.intensity).scale(falloff)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intensity_is_linear_between_the_two_angles() {
        let spot = Spot::new(Vec3::ZERO, Vec3::NEG_Z, Vec3::splat(8.0), 0.4, 0.2);
        for (angle, want) in [(0.0f32, 8.0), (0.19, 8.0), (0.3, 4.0), (0.35, 2.0), (0.41, 0.0), (2.0, 0.0)] {
            let wi: Vector3<f32> = Vec3::new(angle.sin(), 0.0, angle.cos()).into();
            assert!((spot.intensity(wi).x - want).abs() < 2e-5, "{angle}");
        }
        let hard = Spot::new(Vec3::ZERO, Vec3::NEG_Z, Vec3::ONE, 0.3, 0.3);
        let at = |angle: f32| hard.intensity::<f32>(Vec3::new(angle.sin(), 0.0, angle.cos()).into()).x;
        assert_eq!((at(0.29), at(0.31)), (1.0, 0.0));
    }
}
