//! Reflection models, one a file: equation, source, and the three verbs.
//!
//! Directions are unit vectors in the shading frame: z is the normal, x the first tangent; `wo` points
//! towards the viewer and `wi` towards the light, both **away from the surface**.
//!
//! - `eval(wo, wi)` = f(wo, wi) |cos θ_i|, per steradian; 0 for the delta part of a model.
//! - `sample(wo, lobe, u)` draws `wi` and gives the weight f |cos θ_i| / pdf.
//! - `pdf(wo, wi)` is the density of `sample` per solid angle, without the delta part.

mod conductor;
mod dielectric;
pub mod fresnel;
mod lambert;
mod phong;
#[cfg(test)]
mod proof;
mod table;

pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use lambert::Lambert;
pub use phong::Phong;
pub use table::{MaterialId, MaterialRow, MaterialTable, Model};

use crate::simd::{Mask, Real, Vector3};

/// A direction drawn from a model.
#[derive(Clone, Copy, Debug)]
pub struct Sample<R: Real> {
    /// Towards the light, shading frame.
    pub wi: Vector3<R>,
    /// f |cos θ_i| / pdf.
    pub weight: Vector3<R>,
    /// Density per solid angle; of no meaning where `delta`.
    pub pdf: R,
    /// Ratio of the indices of refraction across the surface, n(wi)/n(wo): 1 for reflection.
    pub eta: R,
    /// Lanes that drew a delta direction.
    pub delta: R::Mask,
    /// Lanes that drew anything that carries light.
    pub valid: R::Mask,
}

/// A branch of a mirror or of glass: all of its light comes from one direction.
#[derive(Clone, Copy, Debug)]
pub struct Branch<R: Real> {
    /// Towards the light, shading frame.
    pub wi: Vector3<R>,
    /// Share of the radiance from there that leaves along `wo`.
    pub weight: Vector3<R>,
    /// Lanes where the branch exists.
    pub valid: R::Mask,
}

impl<R: Real> Branch<R> {
    fn none(wo: Vector3<R>) -> Self {
        Self { wi: wo, weight: Vector3::zero(), valid: R::Mask::splat(false) }
    }
}

/// A reflection model with its parameters at each lane's point.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<R: Real> {
    /// Ideal diffuse.
    Lambert(Lambert<R>),
    /// Ideal mirror.
    Conductor(Conductor<R>),
    /// Ideal glass.
    Dielectric(Dielectric<R>),
    /// Diffuse and a cosine lobe.
    Phong(Phong<R>),
}

impl<R: Real> Bsdf<R> {
    /// Does [`Bsdf::eval`] ever give anything but 0?
    #[inline]
    pub fn is_smooth(&self) -> bool {
        matches!(self, Self::Lambert(_) | Self::Phong(_))
    }

    /// f(wo, wi) |cos θ_i|.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        match self {
            Self::Lambert(model) => model.eval(wo, wi),
            Self::Phong(model) => model.eval(wo, wi),
            Self::Conductor(_) | Self::Dielectric(_) => Vector3::zero(),
        }
    }

    /// Density of [`Bsdf::sample`] per solid angle.
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        match self {
            Self::Lambert(model) => model.pdf(wo, wi),
            Self::Phong(model) => model.pdf(wo, wi),
            Self::Conductor(_) | Self::Dielectric(_) => R::zero(),
        }
    }

    /// Draws a direction; `lobe` and `u` are in [0, 1).
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, lobe: R, u: (R, R)) -> Sample<R> {
        match self {
            Self::Lambert(model) => model.sample(wo, u),
            Self::Conductor(model) => model.sample(wo),
            Self::Dielectric(model) => model.sample(wo, lobe),
            Self::Phong(model) => model.sample(wo, lobe, u),
        }
    }

    /// The delta part of the model: reflection, then refraction.
    #[inline]
    pub fn branches(&self, wo: Vector3<R>) -> [Branch<R>; 2] {
        match self {
            Self::Conductor(model) => [model.reflect(wo), Branch::none(wo)],
            Self::Dielectric(model) => model.branches(wo),
            Self::Lambert(_) | Self::Phong(_) => [Branch::none(wo), Branch::none(wo)],
        }
    }
}
