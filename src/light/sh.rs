//! Light from all around that varies slowly: nine coefficients of spherical harmonics \[RH01\].
//!
//! The irradiance of a surface is a polynomial of its normal, E(n) = Σ Â_l L_lm Y_lm(n): no sampling, no
//! noise, and **no shadows**, for nothing is asked about what stands around. It arrives along the normal,
//! where a diffuse surface makes of it exactly ρ E/π; other materials answer as they would to light from
//! straight above. Mirrors and the eye see the radiance Σ L_lm Y_lm itself.

use glam::Vec3;

use crate::math::{Frame, sh_basis, sh_cosine};
use crate::simd::{Real, Vector3};

/// A light of nine coefficients.
#[derive(Clone, Debug)]
pub struct ShLight {
    radiance: [Vec3; 9],
    irradiance: [Vec3; 9],
    axes: [Vec3; 3],
}

impl ShLight {
    /// Coefficients of radiance, W/(m² sr), by l, then m; `axes` are the world images of the light's own,
    /// orthonormal.
    pub fn new(radiance: [Vec3; 9], axes: [Vec3; 3]) -> Self {
        let order = [0, 1, 1, 1, 2, 2, 2, 2, 2].map(|l| sh_cosine(l) as f32);
        let irradiance = std::array::from_fn(|i| order[i] * radiance[i]);
        Self { radiance, irradiance, axes }
    }

    /// Σ c Y(d), not below 0: where nine coefficients are too few, the sum swings through it.
    #[inline]
    fn sum<R: Real>(&self, coefficients: &[Vec3; 9], d: Vector3<R>) -> Vector3<R> {
        let [s, t, n] = self.axes.map(Vector3::splat);
        let basis = sh_basis(Frame { s, t, n }.to_local(d));
        let mut sum = Vector3::zero();
        for (y, c) in basis.into_iter().zip(coefficients) {
            sum = sum + Vector3::splat(*c).scale(y);
        }
        sum.max(Vector3::zero())
    }

    /// Radiance from a world direction of unit length.
    #[inline]
    pub fn radiance<R: Real>(&self, from: Vector3<R>) -> Vector3<R> {
        self.sum(&self.radiance, from)
    }

    /// Irradiance of a surface with this unit normal, W/m².
    #[inline]
    pub fn irradiance<R: Real>(&self, n: Vector3<R>) -> Vector3<R> {
        self.sum(&self.irradiance, n)
    }

    /// ∫L dω, W/m².
    pub(super) fn flux(&self) -> Vec3 {
        (4.0 * std::f32::consts::PI).sqrt() * self.radiance[0].max(Vec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    const UPRIGHT: [Vec3; 3] = [Vec3::X, Vec3::Y, Vec3::Z];

    fn light(set: &[(usize, f32)]) -> ShLight {
        let mut radiance = [Vec3::ZERO; 9];
        for &(i, value) in set {
            radiance[i] = Vec3::splat(value);
        }
        ShLight::new(radiance, UPRIGHT)
    }

    #[test]
    fn a_uniform_sky_of_one_is_an_irradiance_of_pi() {
        let sky = light(&[(0, (4.0 * PI).sqrt())]);
        for n in [Vec3::X, Vec3::NEG_Y, Vec3::new(0.6, 0.0, 0.8)] {
            assert!((sky.irradiance::<f32>(n.into()).x - PI).abs() < 1e-5);
            assert!((sky.radiance::<f32>(n.into()).x - 1.0).abs() < 1e-6);
        }
        assert!((sky.flux().x - 4.0 * PI).abs() < 1e-5);
    }

    #[test]
    fn light_of_order_one_is_two_thirds_of_pi_and_never_negative() {
        // L = z.
        let sky = light(&[(2, (4.0 * PI / 3.0).sqrt())]);
        assert!((sky.irradiance::<f32>(Vec3::Z.into()).x - 2.0 * PI / 3.0).abs() < 1e-5);
        assert_eq!(sky.irradiance::<f32>(Vec3::NEG_Z.into()).x, 0.0);
    }

    #[test]
    fn axes_turn_the_light() {
        let mut sky = light(&[(2, 1.0)]);
        sky.axes = [Vec3::Y, Vec3::Z, Vec3::X];
        assert!(sky.radiance::<f32>(Vec3::X.into()).x > 0.4);
        assert!(sky.radiance::<f32>(Vec3::Z.into()).x.abs() < 1e-6);
    }
}
