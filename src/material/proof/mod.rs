//! What every reflection model must satisfy, measured: reciprocity, a density that integrates to one,
//! samples that follow it.
//!
//! The measures are generic over lanes: tests ask them of one lane at fixed inputs, the certificate of
//! `packlight brdf --check` of eight. They tell numbers; whoever asks decides what is good enough.

#[cfg(test)]
mod assertions;
mod chi_squared;
mod pairs;
mod quadrature;

use glam::Vec3;

use super::{Bsdf, Sample};
use crate::simd::{Mask, Real, Vector3};

#[cfg(test)]
pub(crate) use assertions::*;
pub use chi_squared::{Fit, chi_squared_tail, sidak};
pub use pairs::{Turned, Worst, isotropy, reciprocity};
pub use quadrature::integrate;

/// What can be proven: a model, or a material at a point.
pub trait Reflector<R: Real> {
    /// f |cos θ_i|, and the density with which [`sample`](Self::sample) draws `wi`; without delta lobes.
    fn eval_pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> (Vector3<R>, R);
    /// Draws a direction; `lobe` and `u` are in [0, 1).
    fn sample(&self, wo: Vector3<R>, lobe: R, u: (R, R)) -> Sample<R>;
    /// Can light leave on the other side, but for straight through?
    fn transmits(&self) -> bool;
}

impl<R: Real> Reflector<R> for Bsdf<'_, R> {
    fn eval_pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> (Vector3<R>, R) {
        Bsdf::eval_pdf(self, wo, wi)
    }

    fn sample(&self, wo: Vector3<R>, lobe: R, u: (R, R)) -> Sample<R> {
        Bsdf::sample(self, wo, lobe, u)
    }

    fn transmits(&self) -> bool {
        match self {
            Self::RoughDielectric(_) => true,
            Self::Principled(principled) => principled.spec_trans.gt(R::zero()).any(),
            _ => false,
        }
    }
}

/// A repeatable sequence, by Steele, Lea and Flood's "SplitMix" (2014): numbers drawn in threes must not
/// lie on planes.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Another seed, another sequence.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x5851_f42d_4c95_7f2d))
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 40) as f32 / 16_777_216.0
    }

    /// Three numbers a lane: a lane's own stand together in the sequence.
    pub fn triple<R: Real>(&mut self) -> [R; 3] {
        let mut lanes = [[0.0f32; 3]; 8];
        for lane in &mut lanes[..R::LANES] {
            *lane = [self.unit(), self.unit(), self.unit()];
        }
        [0, 1, 2].map(|k| R::from_fn(|i| lanes[i][k]))
    }

    /// A direction of the upper half, or of both.
    pub fn direction(&mut self, both: bool) -> Vec3 {
        let z = self.unit() * if both { 2.0 } else { 1.0 } - if both { 1.0 } else { 0.0 };
        let (s, c) = (self.unit() * std::f32::consts::TAU).sin_cos();
        Vec3::new((1.0 - z * z).max(0.0).sqrt() * c, (1.0 - z * z).max(0.0).sqrt() * s, z)
    }
}

/// The direction with this angle from the normal, in degrees, at an azimuth that no model prefers.
pub fn at(degrees: f32) -> Vec3 {
    let (s, c) = degrees.to_radians().sin_cos();
    Vec3::new(s * 0.6, -s * 0.8, c)
}
