//! Lights: how much arrives at a point, from where, and with what density a direction is drawn.
//!
//! `sample` gives a direction towards the light, unit length, and the radiance over its density per
//! solid angle; a light without extent (point, spot, directional) has no density and can't be hit.

mod area;
mod choice;
mod distribution;
mod envmap;
mod rectangle;
mod sh;
mod sight;
mod spot;

pub use area::{AreaLight, Emitting, SurfacePoint};
pub use choice::{Glimpse, LightChoice};
pub use envmap::{Envmap, ShCoefficients, sh_irradiance};
pub use rectangle::Rectangle;
pub use sh::ShLight;
pub use sight::Sight;
pub use spot::Spot;

use std::f32::consts::PI;

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
        /// Towards the light, in world space; unit length.
        towards: Vec3,
        /// W/m² on a surface at right angles.
        irradiance: Vec3,
    },
    /// The same radiance from everywhere.
    Constant {
        /// W/(m² sr).
        radiance: Vec3,
    },
    /// A picture all around.
    Envmap(Envmap),
    /// Nine coefficients, all around, without shadows.
    Sh(ShLight),
    /// A shape.
    Area(AreaLight),
}

/// Points that receive light.
#[derive(Clone, Copy, Debug)]
pub struct Receiver<R> {
    /// World space.
    pub position: Vector3<R>,
    /// Unit length, on the side that is lit.
    pub n: Vector3<R>,
}

/// How far a shadow ray has to go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// To the target.
    Target,
    /// Out of the scene.
    Infinity,
    /// Nowhere: the light has no shadows.
    Unhindered,
}

/// Light that arrives at some points, one direction each.
#[derive(Clone, Copy, Debug)]
pub struct LightSample<R: Real> {
    /// Towards the light; unit length.
    pub wi: Vector3<R>,
    /// The point on the light in world space, moved off its surface towards the receiver, if that is where it is.
    pub target: Vector3<R>,
    /// Where the light is.
    pub reach: Reach,
    /// Radiance / pdf, or intensity/d², or irradiance.
    pub weight: Vector3<R>,
    /// Density per solid angle; 0 for lights that can't be hit by chance.
    pub pdf: R,
    /// Lanes that receive anything, visibility aside.
    pub valid: R::Mask,
}

impl Light {
    /// Draws a direction for light that arrives.
    #[inline]
    pub fn sample<R: Real>(&self, receiver: &Receiver<R>, (u, v): (R, R)) -> LightSample<R> {
        let from = receiver.position;
        match self {
            Self::Point { position, intensity } => {
                from_point(from, *position, |_| Vector3::splat(*intensity))
            }
            Self::Spot(spot) => from_point(from, spot.position, |wi| spot.intensity(wi)),
            Self::Directional { towards, irradiance } => LightSample {
                wi: Vector3::splat(*towards),
                target: from,
                reach: Reach::Infinity,
                weight: Vector3::splat(*irradiance),
                pdf: R::zero(),
                valid: R::Mask::splat(true),
            },
            Self::Constant { .. } => self.drawn_at_infinity(from, warp::sphere(u, v)),
            Self::Envmap(map) => self.drawn_at_infinity(from, map.sample((u, v))),
            Self::Sh(light) => LightSample {
                wi: receiver.n,
                target: from,
                reach: Reach::Unhindered,
                weight: light.irradiance(receiver.n),
                pdf: R::zero(),
                valid: R::Mask::splat(true),
            },
            Self::Area(light) => light.sample(from, (u, v)),
        }
    }

    /// Does [`sample`](Self::sample) look at its random numbers?
    #[inline]
    pub fn is_drawn(&self) -> bool {
        match self {
            Self::Point { .. } | Self::Spot(_) | Self::Directional { .. } | Self::Sh(_) => false,
            Self::Constant { .. } | Self::Envmap(_) | Self::Area(_) => true,
        }
    }

    /// A sample of the environment.
    #[inline]
    fn drawn_at_infinity<R: Real>(&self, from: Vector3<R>, wi: Vector3<R>) -> LightSample<R> {
        let (radiance, pdf) = self.environment(wi);
        LightSample {
            wi,
            target: from,
            reach: Reach::Infinity,
            weight: radiance.scale(R::one() / pdf),
            pdf,
            valid: pdf.gt(R::zero()),
        }
    }

    /// Is it all around, seen by rays that leave the scene?
    pub fn is_environment(&self) -> bool {
        matches!(self, Self::Constant { .. } | Self::Envmap(_) | Self::Sh(_))
    }

    /// What rays that leave the scene along `wi` see, and the density per solid angle with which
    /// [`sample`](Self::sample) draws that direction.
    #[inline]
    pub fn environment<R: Real>(&self, wi: Vector3<R>) -> (Vector3<R>, R) {
        match self {
            Self::Constant { radiance } => (Vector3::splat(*radiance), warp::cone_pdf(R::splat(2.0))),
            Self::Envmap(map) => map.arriving(wi),
            // Whoever samples lights has it all, whatever the density: only mirrors and eyes see it.
            Self::Sh(light) => (light.radiance(wi), R::splat(f32::INFINITY)),
            _ => (Vector3::zero(), R::zero()),
        }
    }

    /// Power in W, in the brightest band, for choosing among many. Of what comes from infinity, the part
    /// that passes through a scene of this radius.
    pub fn power(&self, scene_radius: f32) -> f32 {
        let disk = PI * scene_radius * scene_radius;
        let Glimpse { steady, intensity, .. } = self.glimpse();
        (4.0 * disk * steady + 4.0 * PI * intensity).min(f32::MAX)
    }

    /// What the light is from afar, in the brightest band. Irradiance and intensity are means over all
    /// sides.
    pub fn glimpse(&self) -> Glimpse {
        let steady = |flux: Vec3| Glimpse { steady: flux.max_element().min(f32::MAX), ..Glimpse::default() };
        let point = |middle: Vec3, radius: f32, intensity: Vec3| {
            let intensity = intensity.max_element().min(f32::MAX);
            Glimpse { intensity, middle, radius, steady: 0.0 }
        };
        match self {
            Self::Point { position, intensity } => point(*position, 0.0, *intensity),
            Self::Spot(spot) => point(spot.position, 0.0, spot.intensity_on_axis()),
            Self::Directional { irradiance, .. } => steady(0.25 * *irradiance),
            Self::Constant { radiance } => steady(PI * *radiance),
            Self::Envmap(map) => steady(0.25 * map.flux()),
            Self::Sh(light) => steady(0.25 * light.flux()),
            Self::Area(light) => {
                let (middle, radius) = light.shape.ball();
                point(middle, radius, light.power() / (4.0 * PI))
            }
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
        reach: Reach::Target,
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
