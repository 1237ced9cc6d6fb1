//! Toon: light in steps, as cartoons are painted.
//!
//! ```text
//! f cos θ_i = ρ/π r(cos θ_i)                    r is the ramp
//! r(c) = ⌊n c⌋/(n − 1), at most 1               n bands from black to full light
//! r(c) = the colour of the last stop up to c    a free ramp; or linear between stops
//! ```
//!
//! The ramp stands in place of the cosine, not beside it: divided by cos θ_i it is not reciprocal, and no
//! surface is like that. The albedo is 2ρ ∫ r dc; bands have ∫ r = ½ as the cosine has, so theirs is ρ.

use glam::Vec3;

use super::{Sample, lambert::above};
use crate::math::{INV_PI, warp};
use crate::simd::{Mask, Real, Vector3};

/// What stands in place of the cosine.
#[derive(Clone, Debug, PartialEq)]
pub enum Ramp {
    /// So many bands of grey, at least 2.
    Bands(u32),
    /// Each colour from its cosine up to the next one's; black before the first.
    Steps(Vec<Stop>),
    /// Linear between the stops, and the same beyond them.
    Smooth(Vec<Stop>),
}

/// A colour of a ramp. Stops ascend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// cos θ_i, in [0, 1].
    pub cos: f32,
    /// Linear sRGB.
    pub color: Vec3,
}

impl Ramp {
    /// 2 ∫ r dc by channel: the albedo for ρ = 1.
    pub fn albedo(&self) -> Vec3 {
        let stops = match self {
            Self::Bands(_) => return Vec3::ONE,
            Self::Steps(stops) | Self::Smooth(stops) => stops,
        };
        let first = stops.first().map_or(Vec3::ZERO, |stop| stop.color * stop.cos);
        let before = if matches!(self, Self::Smooth(_)) { first } else { Vec3::ZERO };
        let last = stops.last().map_or(Vec3::ZERO, |stop| stop.color * (1.0 - stop.cos));
        let between = stops.windows(2).map(|pair| {
            let mean = match self {
                Self::Smooth(_) => (pair[0].color + pair[1].color) * 0.5,
                _ => pair[0].color,
            };
            mean * (pair[1].cos - pair[0].cos)
        });
        (before + between.sum::<Vec3>() + last) * 2.0
    }

    #[inline]
    fn at<R: Real>(&self, cos: R) -> Vector3<R> {
        match self {
            Self::Bands(bands) => {
                let bands = R::splat(*bands as f32);
                let top = bands - R::one();
                let grey = (bands * cos).floor().min(top) / top;
                Vector3 { x: grey, y: grey, z: grey }
            }
            Self::Steps(stops) => stops.iter().fold(Vector3::zero(), |color, stop| {
                let reached = cos.ge(R::splat(stop.cos));
                Vector3::select(reached, Vector3::splat(stop.color), color)
            }),
            Self::Smooth(stops) => {
                let first = stops.first().map_or(Vec3::ZERO, |stop| stop.color);
                stops.windows(2).fold(Vector3::splat(first), |color, pair| {
                    let part = (cos - R::splat(pair[0].cos)) / R::splat(pair[1].cos - pair[0].cos);
                    let more = Vector3::splat(pair[1].color - pair[0].color);
                    color + more.scale(part.clamp(0.0, 1.0))
                })
            }
        }
    }
}

/// Bands of light, black from behind.
#[derive(Clone, Copy, Debug)]
pub struct Toon<'t, R> {
    /// ρ.
    pub reflectance: Vector3<R>,
    /// r.
    pub ramp: &'t Ramp,
}

impl<R: Real> Toon<'_, R> {
    /// ρ/π times the ramp.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        let ramp = self.ramp.at(wi.z).map(|r| (r * R::splat(INV_PI)).only(above(wo, wi)));
        self.reflectance * ramp
    }

    /// cos θ_i/π.
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        warp::cosine_hemisphere_pdf(wi.z).only(above(wo, wi))
    }

    /// A cosine-distributed direction.
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, (u, v): (R, R)) -> Sample<R> {
        let wi = warp::cosine_hemisphere(u, v);
        Sample::quotient(wi, self.eval(wo, wi), self.pdf(wo, wi), R::Mask::splat(true))
    }
}

#[cfg(test)]
mod tests;
