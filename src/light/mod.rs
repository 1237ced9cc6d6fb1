//! Lights: how much arrives at a point, from where, and with what density a direction is drawn.
//!
//! `sample` gives a direction towards the light, unit length, and the radiance over its density per
//! solid angle; a light without extent (point, spot, directional) has no density and can't be hit.

mod area;
mod spot;

pub use area::{AreaLight, Emitting, SurfacePoint};
pub use spot::Spot;

use glam::Vec3;

use crate::math::warp;
use crate::simd::{Mask, Real, Vector3};

/// Which light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightId(pub u32);

impl LightId {
    /// Not a light.
    pub const NONE: Self = Self(u32::MAX);
}

/// A light of a scene.
#[derive(Clone, Debug)]
pub enum Light {
    /// Isotropic point of intensity I: irradiance I cos θ/d².
    Point {
        /// World space.
        position: Vec3,
        /// W/sr.
        intensity: Vec3,
    },
    /// A point that shines into a cone.
    Spot(Spot),
    /// Parallel light.
    Directional {
        /// Towards the light; unit length.
        towards: Vec3,
        /// W/m² on a surface at right angles.
        irradiance: Vec3,
    },
    /// The same radiance from everywhere.
    Constant {
        /// W/(m² sr).
        radiance: Vec3,
    },
    /// A shape.
    Area(AreaLight),
}

/// Light that arrives at some points, one direction each.
#[derive(Clone, Copy, Debug)]
pub struct LightSample<R: Real> {
    /// Towards the light; unit length.
    pub wi: Vector3<R>,
    /// The point on the light, moved off its surface towards the receiver; of no meaning at infinity.
    pub target: Vector3<R>,
    /// Lights at infinity have no target.
    pub at_infinity: bool,
    /// Radiance / pdf, or intensity/d², or irradiance.
    pub weight: Vector3<R>,
    /// Density per solid angle; 0 for lights that can't be hit by chance.
    pub pdf: R,
    /// Lanes that receive anything, visibility aside.
    pub valid: R::Mask,
}

impl Light {
    /// Draws a direction for light that arrives at `from`.
    #[inline]
    pub fn sample<R: Real>(&self, from: Vector3<R>, (u, v): (R, R)) -> LightSample<R> {
        match self {
            Self::Point { position, intensity } => {
                from_point(from, *position, |_| Vector3::splat(*intensity))
            }
            Self::Spot(spot) => from_point(from, spot.position, |wi| spot.intensity(wi)),
            Self::Directional { towards, irradiance } => LightSample {
                wi: Vector3::splat(*towards),
                target: from,
                at_infinity: true,
                weight: Vector3::splat(*irradiance),
                pdf: R::zero(),
                valid: R::Mask::splat(true),
            },
            Self::Constant { radiance } => {
                let pdf = warp::cone_pdf(R::splat(2.0));
                LightSample {
                    wi: warp::sphere(u, v),
                    target: from,
                    at_infinity: true,
                    weight: Vector3::splat(*radiance).scale(R::one() / pdf),
                    pdf,
                    valid: R::Mask::splat(true),
                }
            }
            Self::Area(light) => light.sample(from, (u, v)),
        }
    }

    /// Is it at infinity, seen by rays that leave the scene?
    pub fn environment(&self) -> Option<Vec3> {
        match self {
            Self::Constant { radiance } => Some(*radiance),
            _ => None,
        }
    }

    /// Density per solid angle of a direction that leaves the scene.
    #[inline]
    pub fn environment_pdf<R: Real>(&self) -> R {
        match self {
            Self::Constant { .. } => warp::cone_pdf(R::splat(2.0)),
            _ => R::zero(),
        }
    }
}

/// Inverse-square light from a point.
#[inline]
fn from_point<R: Real>(
    from: Vector3<R>,
    position: Vec3,
    intensity: impl Fn(Vector3<R>) -> Vector3<R>,
) -> LightSample<R> {
    let target = Vector3::splat(position);
    let to = target - from;
    let squared = to.dot(to);
    let wi = to.scale(R::one() / squared.sqrt());
    LightSample {
        wi,
        target,
        at_infinity: false,
        weight: intensity(wi).scale(R::one() / squared),
        pdf: R::zero(),
        valid: squared.gt(R::zero()),
    }
}

/// The power heuristic for one sample of each of two densities \[VG95\]: p²/(p² + q²), without overflow.
#[inline]
pub fn power_heuristic<R: Real>(p: R, q: R) -> R {
    let ratio = q / p;
    let weight = R::one() / (R::one() + ratio * ratio);
    weight.only(p.gt(R::zero()))
}
