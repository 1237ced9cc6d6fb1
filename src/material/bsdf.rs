//! Any reflection model, and what its verbs give.

use super::{
    Conductor, Dielectric, Lambert, Measured, Phong, Plastic, Principled, RoughConductor, RoughDielectric,
    RoughPlastic, Toon, Ward, transparent,
};
use crate::simd::{Mask, Real, Vector3};

/// A direction drawn from a model.
#[derive(Clone, Copy, Debug)]
pub struct Sample<R: Real> {
    /// Towards the light, shading frame.
    pub wi: Vector3<R>,
    /// f |cos θ_i| / pdf.
    pub weight: Vector3<R>,
    /// Density per solid angle; where `delta`, the probability with which the lobe was chosen.
    pub pdf: R,
    /// Ratio of the indices of refraction across the surface, n(wi)/n(wo): 1 for reflection.
    pub eta: R,
    /// Lanes that drew a delta direction.
    pub delta: R::Mask,
    /// Lanes that drew anything that carries light.
    pub valid: R::Mask,
}

impl<R: Real> Sample<R> {
    /// A direction of a smooth lobe with f |cos θ_i| and its density, in these lanes.
    #[inline]
    pub(super) fn quotient(wi: Vector3<R>, eval: Vector3<R>, pdf: R, lanes: R::Mask) -> Self {
        let valid = pdf.gt(R::zero()) & lanes;
        let weight = eval.scale(R::one() / R::select(valid, pdf, R::one()));
        Self { wi, weight, pdf, eta: R::one(), delta: R::Mask::splat(false), valid }
    }

    /// `if mask { a } else { b }`, lane by lane.
    #[inline]
    pub fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        Self {
            wi: Vector3::select(mask, a.wi, b.wi),
            weight: Vector3::select(mask, a.weight, b.weight),
            pdf: R::select(mask, a.pdf, b.pdf),
            eta: R::select(mask, a.eta, b.eta),
            delta: (mask & a.delta) | (!mask & b.delta),
            valid: (mask & a.valid) | (!mask & b.valid),
        }
    }
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
    pub(super) fn none(wo: Vector3<R>) -> Self {
        Self { wi: wo, weight: Vector3::zero(), valid: R::Mask::splat(false) }
    }
}

/// A reflection model with its parameters at each lane's point.
#[derive(Clone, Copy, Debug)]
pub enum Bsdf<'t, R: Real> {
    /// Ideal diffuse.
    Lambert(Lambert<R>),
    /// Diffuse and a cosine lobe.
    Phong(Phong<R>),
    /// Diffuse and a Gaussian of slopes.
    Ward(Ward<R>),
    /// Bands of light.
    Toon(Toon<'t, R>),
    /// Microfacets of metal.
    RoughConductor(RoughConductor<R>),
    /// Microfacets over a diffuse base.
    RoughPlastic(RoughPlastic<'t, R>),
    /// Microfacets of glass.
    RoughDielectric(RoughDielectric<R>),
    /// Burley's model.
    Principled(Principled<R>),
    /// A table.
    Measured(Measured<'t>),
    /// A mirror over a diffuse base.
    Plastic(Plastic<R>),
    /// Ideal mirror.
    Conductor(Conductor<R>),
    /// Ideal glass.
    Dielectric(Dielectric<R>),
    /// Nothing.
    Transparent,
}

/// A verb that smooth models have, and delta models answer with `$none`.
macro_rules! smooth_verb {
    ($self:ident, $model:ident => $verb:expr, $none:expr) => {
        match $self {
            Self::Lambert($model) => $verb,
            Self::Phong($model) => $verb,
            Self::Ward($model) => $verb,
            Self::Toon($model) => $verb,
            Self::RoughConductor($model) => $verb,
            Self::RoughPlastic($model) => $verb,
            Self::RoughDielectric($model) => $verb,
            Self::Principled($model) => $verb,
            Self::Measured($model) => $verb,
            Self::Plastic($model) => $verb,
            Self::Conductor(_) | Self::Dielectric(_) | Self::Transparent => $none,
        }
    };
}

impl<R: Real> Bsdf<'_, R> {
    /// Does [`Bsdf::eval`] ever give anything but 0?
    #[inline]
    pub fn is_smooth(&self) -> bool {
        !matches!(self, Self::Conductor(_) | Self::Dielectric(_) | Self::Transparent)
    }

    /// Does [`Bsdf::branches`] ever give any?
    #[inline]
    pub fn is_split(&self) -> bool {
        matches!(self, Self::Conductor(_) | Self::Plastic(_) | Self::Dielectric(_) | Self::Transparent)
    }

    /// Does [`Bsdf::sample`] look at `lobe`?
    #[inline]
    pub fn chooses_lobes(&self) -> bool {
        match self {
            Self::Lambert(_)
            | Self::Toon(_)
            | Self::RoughConductor(_)
            | Self::Conductor(_)
            | Self::Transparent => false,
            Self::Phong(_)
            | Self::Ward(_)
            | Self::RoughPlastic(_)
            | Self::RoughDielectric(_)
            | Self::Principled(_)
            | Self::Measured(_)
            | Self::Plastic(_)
            | Self::Dielectric(_) => true,
        }
    }

    /// f(wo, wi) |cos θ_i|.
    #[inline]
    pub fn eval(&self, wo: Vector3<R>, wi: Vector3<R>) -> Vector3<R> {
        smooth_verb!(self, model => model.eval(wo, wi), Vector3::zero())
    }

    /// Density of [`Bsdf::sample`] per solid angle.
    #[inline]
    pub fn pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> R {
        smooth_verb!(self, model => model.pdf(wo, wi), R::zero())
    }

    /// [`Bsdf::eval`] and [`Bsdf::pdf`].
    #[inline]
    pub fn eval_pdf(&self, wo: Vector3<R>, wi: Vector3<R>) -> (Vector3<R>, R) {
        smooth_verb!(self, model => (model.eval(wo, wi), model.pdf(wo, wi)), (Vector3::zero(), R::zero()))
    }

    /// Draws a direction; `lobe` and `u` are in [0, 1).
    #[inline]
    pub fn sample(&self, wo: Vector3<R>, lobe: R, u: (R, R)) -> Sample<R> {
        match self {
            Self::Lambert(model) => model.sample(wo, u),
            Self::Phong(model) => model.sample(wo, lobe, u),
            Self::Ward(model) => model.sample(wo, lobe, u),
            Self::Toon(model) => model.sample(wo, u),
            Self::RoughConductor(model) => model.sample(wo, u),
            Self::RoughPlastic(model) => model.sample(wo, lobe, u),
            Self::RoughDielectric(model) => model.sample(wo, lobe, u),
            Self::Principled(model) => model.sample(wo, lobe, u),
            Self::Measured(model) => model.sample(wo, lobe, u),
            Self::Plastic(model) => model.sample(wo, lobe, u),
            Self::Conductor(model) => model.sample(wo),
            Self::Dielectric(model) => model.sample(wo, lobe),
            Self::Transparent => transparent::sample(wo),
        }
    }

    /// The delta part of the model: reflection, then refraction.
    #[inline]
    pub fn branches(&self, wo: Vector3<R>) -> [Branch<R>; 2] {
        match self {
            Self::Conductor(model) => [model.reflect(wo), Branch::none(wo)],
            Self::Plastic(model) => [model.reflect(wo), Branch::none(wo)],
            Self::Dielectric(model) => model.branches(wo),
            Self::Transparent => [Branch::none(wo), transparent::pass(wo)],
            _ => [Branch::none(wo), Branch::none(wo)],
        }
    }
}
