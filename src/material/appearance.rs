//! What a material looks like at a point: its layers, each in its own frame and with its weight.
//!
//! ```text
//! f = Σ w_k f_k        Σ w_k = 1
//! ```
//!
//! `blendbsdf` and `mask` are such sums, the open part of a mask being a model that lets light pass.
//! `twosided`, `bumpmap` and `normalmap` turn directions before a model sees them. All of them nest, and
//! all of them flatten to this.

use super::{
    Branch, Bsdf, Sample,
    table::{Layer, Relief, Step},
};
use crate::math::Frame;
use crate::simd::{Mask, Real, Vector3, vector3};
use crate::texture::{Coordinates, TextureTable};

/// Points of a surface, in their shading frames.
#[derive(Clone, Copy, Debug)]
pub struct Point<R: Real> {
    /// Towards the viewer, in the shading frame; unit length.
    pub wo: Vector3<R>,
    /// Where its textures are looked up.
    pub uv: Coordinates<R>,
    /// ∂p/∂u and ∂p/∂v, where the material is oriented.
    pub tangents: [Vector3<R>; 2],
}

/// The layers of a material at some points.
#[derive(Clone, Debug)]
pub struct Appearance<'t, R: Real> {
    first: Placed<'t, R>,
    others: Vec<Placed<'t, R>>,
}

/// A model as it stands on the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<'t, R: Real> {
    bsdf: Bsdf<'t, R>,
    weight: R,
    view: View<R>,
    /// Towards the viewer, as the model sees it.
    wo: Vector3<R>,
}

/// How a model sees directions of the surface's shading frame.
#[derive(Clone, Copy, Debug)]
enum View<R> {
    /// As they are.
    Plain,
    /// z times this: −1 turns the model round.
    Turned(R),
    /// In a frame of its own, which `parity` times has been turned round. Directions that are on one
    /// side of the surface and on the other of the model don't exist; those near the horizon are shadowed
    /// by microfacets of roughness² `spread`.
    Leaning { frame: Frame<R>, parity: R, spread: R },
}

impl<R: Real> View<R> {
    #[inline]
    fn to_model(self, w: Vector3<R>) -> Vector3<R> {
        match self {
            Self::Plain => w,
            Self::Turned(side) => vector3(w.x, w.y, w.z * side),
            Self::Leaning { frame, .. } => frame.to_local(w),
        }
    }

    #[inline]
    fn to_surface(self, w: Vector3<R>) -> Vector3<R> {
        match self {
            Self::Plain => w,
            Self::Turned(side) => vector3(w.x, w.y, w.z * side),
            Self::Leaning { frame, .. } => frame.to_world(w),
        }
    }

    /// Lanes in which surface and model agree on the side of a direction; `None` is all.
    #[inline]
    fn agrees(self, at_surface: Vector3<R>, at_model: Vector3<R>) -> Option<R::Mask> {
        match self {
            Self::Leaning { parity, .. } => Some((at_surface.z * at_model.z * parity).gt(R::zero())),
            _ => None,
        }
    }

    /// What reaches a leaning model: G1 of GGX for light from `wi` at the surface.
    #[inline]
    fn shadow(self, wi: Vector3<R>, f: Vector3<R>) -> Vector3<R> {
        match self {
            Self::Leaning { spread, .. } => {
                let z2 = (wi.z * wi.z).max(R::splat(f32::MIN_POSITIVE));
                let tan2 = (wi.x * wi.x + wi.y * wi.y) / z2;
                f.scale(R::splat(2.0) / (R::one() + (R::one() + spread * tan2).sqrt()))
            }
            _ => f,
        }
    }

    /// Turned round where `side` is −1.
    #[inline]
    fn turned(self, side: R) -> Self {
        match self {
            Self::Plain => Self::Turned(side),
            Self::Turned(other) => Self::Turned(other * side),
            Self::Leaning { frame, parity, spread } => Self::Leaning {
                frame: Frame { n: frame.n.scale(side), ..frame },
                parity: parity * side,
                spread,
            },
        }
    }

    /// In a frame about `n`, given in the frame so far, in which the viewer is at `wo`.
    #[inline]
    fn leaning(self, wo: Vector3<R>, n: Vector3<R>, along: Vector3<R>, relief: Relief) -> Self {
        let x = vector3(R::one(), R::zero(), R::zero());
        let hidden = if relief.flips { (n.dot(wo) * wo.z).lt(R::zero()) } else { R::Mask::splat(false) };
        let n = Vector3::select(hidden, vector3(-n.x, -n.y, n.z), n);
        let s = (along - n.scale(n.dot(along))).normalize_or(x - n.scale(n.x)).normalize_or(x);
        let t = n.cross(s);
        let frame = Frame { s: self.to_surface(s), t: self.to_surface(t), n: self.to_surface(n) };
        let (parity, outer) = match self {
            Self::Plain => (R::one(), R::zero()),
            Self::Turned(side) => (side, R::zero()),
            Self::Leaning { parity, spread, .. } => (parity, spread),
        };
        // An eighth of tan² of the angle by which the normal leans.
        let z2 = (n.z * n.z).max(R::splat(f32::MIN_POSITIVE));
        let spread = ((n.x * n.x + n.y * n.y) / z2 * R::splat(0.125)).min(R::one());
        let spread = if relief.shadows { outer.max(spread) } else { outer };
        Self::Leaning { frame, parity, spread }
    }
}

impl<R: Real> Point<R> {
    /// A layer's model where the layer's steps lead.
    // Models are large: `bsdf` is called where its result is to be, and nothing is copied.
    #[inline(always)]
    pub(super) fn place<'t>(
        &self,
        bsdf: impl FnOnce() -> Bsdf<'t, R>,
        layer: &Layer,
        textures: &TextureTable,
    ) -> Placed<'t, R> {
        let (weight, view) = self.view(layer, textures);
        Placed { bsdf: bsdf(), weight, view, wo: view.to_model(self.wo) }
    }

    /// A layer's weight, and how its model sees directions.
    #[inline]
    fn view(&self, layer: &Layer, textures: &TextureTable) -> (R, View<R>) {
        let mut weight = R::one();
        for factor in &layer.factors {
            let value = textures.fetch_number::<R>(factor.texture, self.uv);
            weight = weight * if factor.complement { R::one() - value } else { value };
        }
        let mut view = View::Plain;
        for step in &layer.steps {
            let wo = view.to_model(self.wo);
            let below = wo.z.lt(R::zero());
            match *step {
                Step::Turn => view = view.turned(R::select(below, -R::one(), R::one())),
                Step::Front => weight = R::select(below, R::zero(), weight),
                Step::Back => {
                    weight = weight.only(below);
                    view = view.turned(-R::one());
                }
                Step::Bump { texture, scale, relief } => {
                    let (along_u, along_v) = textures.gradient::<R>(texture, self.uv);
                    let [p_u, p_v] = self.tangents;
                    let p_u = vector3(p_u.x, p_u.y, along_u * R::splat(scale));
                    let p_v = vector3(p_v.x, p_v.y, along_v * R::splat(scale));
                    let up = vector3(R::zero(), R::zero(), R::one());
                    let n = p_u.cross(p_v).normalize_or(up);
                    let n = Vector3::select(n.z.lt(R::zero()), -n, n);
                    view = view.leaning(wo, n, p_u, relief);
                }
                Step::Normal { texture, relief } => {
                    let color = textures.fetch::<R>(texture, self.uv);
                    let up = vector3(R::zero(), R::zero(), R::one());
                    let n = color.map(|c| c + c - R::one()).normalize_or(up);
                    let x = vector3(R::one(), R::zero(), R::zero());
                    view = view.leaning(wo, n, x, relief);
                }
            }
        }
        (weight, view)
    }
}

impl<R: Real> Placed<'_, R> {
    #[inline]
    fn eval(&self, wi: Vector3<R>) -> (Vector3<R>, R) {
        let at_model = self.view.to_model(wi);
        let (f, pdf) = self.bsdf.eval_pdf(self.wo, at_model);
        match self.view.agrees(wi, at_model) {
            None => (f, pdf),
            Some(lanes) => (self.view.shadow(wi, f).only(lanes), pdf.only(lanes)),
        }
    }

    #[inline]
    fn sample(&self, lobe: R, u: (R, R)) -> Sample<R> {
        let sample = self.bsdf.sample(self.wo, lobe, u);
        let wi = self.view.to_surface(sample.wi);
        let valid = match self.view.agrees(wi, sample.wi) {
            None => sample.valid,
            Some(lanes) => sample.valid & lanes,
        };
        Sample { wi, weight: self.view.shadow(wi, sample.weight), valid, ..sample }
    }

    #[inline]
    fn branches(&self) -> [Branch<R>; 2] {
        let at_surface = |branch: Branch<R>| {
            let wi = self.view.to_surface(branch.wi);
            let valid = match self.view.agrees(wi, branch.wi) {
                None => branch.valid,
                Some(lanes) => branch.valid & lanes,
            };
            Branch { wi, weight: self.view.shadow(wi, branch.weight), valid }
        };
        let [reflection, refraction] = self.bsdf.branches(self.wo);
        [at_surface(reflection), at_surface(refraction)]
    }
}

impl<'t, R: Real> Appearance<'t, R> {
    #[inline(always)]
    pub(super) fn new(first: Placed<'t, R>, others: Vec<Placed<'t, R>>) -> Self {
        Self { first, others }
    }

    fn layers(&self) -> impl Iterator<Item = &Placed<'t, R>> {
        [&self.first].into_iter().chain(&self.others)
    }

    /// Is there anything but delta lobes?
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.first.bsdf.is_smooth() || self.others.iter().any(|layer| layer.bsdf.is_smooth())
    }

    /// Does [`branches`](Self::branches) ever give any?
    #[inline]
    pub fn is_split(&self) -> bool {
        self.layers().any(|layer| layer.bsdf.is_split())
    }

    /// Does [`sample`](Self::sample) look at `lobe`?
    #[inline]
    pub fn chooses_lobes(&self) -> bool {
        !self.others.is_empty() || self.first.bsdf.chooses_lobes()
    }

    /// f |cos θ_i|, and the density with which [`sample`](Self::sample) draws the direction.
    #[inline]
    pub fn eval(&self, wi: Vector3<R>) -> (Vector3<R>, R) {
        if self.others.is_empty() {
            return self.first.eval(wi);
        }
        let mut sum = (Vector3::zero(), R::zero());
        for layer in self.layers() {
            let (f, pdf) = layer.eval(wi);
            // 0 · ∞ where a layer isn't there.
            let there = layer.weight.gt(R::zero());
            sum.0 = sum.0 + f.scale(layer.weight).only(there);
            sum.1 = sum.1 + (pdf * layer.weight).only(there);
        }
        sum
    }

    /// Draws a direction: a layer by its weight, then of that layer.
    #[inline]
    pub fn sample(&self, lobe: R, u: (R, R)) -> Sample<R> {
        let mut sample = self.first.sample(if self.others.is_empty() { lobe } else { self.rest(0, lobe) }, u);
        if self.others.is_empty() {
            return sample;
        }
        let mut there = self.first.weight.gt(R::zero());
        let mut below = self.first.weight;
        for (i, layer) in self.others.iter().enumerate() {
            let chosen = lobe.ge(below);
            sample = Sample::select(chosen, layer.sample(self.rest(i + 1, lobe), u), sample);
            let weighs = layer.weight.gt(R::zero());
            there = (chosen & weighs) | (!chosen & there);
            below = below + layer.weight;
        }
        sample.valid = sample.valid & there;
        let (f, pdf) = self.eval(sample.wi);
        let smooth = Sample::quotient(sample.wi, f, pdf, sample.valid);
        Sample {
            weight: Vector3::select(sample.delta, sample.weight, smooth.weight),
            pdf: R::select(sample.delta, sample.pdf, smooth.pdf),
            valid: (sample.delta & sample.valid) | (!sample.delta & smooth.valid),
            ..sample
        }
    }

    /// The weight of [`sample`](Self::sample) where it is valid, else 0.
    #[inline]
    pub fn sampled_weight(&self, lobe: R, u: (R, R)) -> Vector3<R> {
        match (&self.first, self.others.is_empty()) {
            (Placed { bsdf: Bsdf::Lambert(model), view: View::Plain | View::Turned(_), wo, .. }, true) => {
                model.sampled_weight(*wo, u)
            }
            _ => {
                let sample = self.sample(lobe, u);
                sample.weight.only(sample.valid)
            }
        }
    }

    /// What is left of the number that chose a layer: uniform again in [0, 1).
    #[inline]
    fn rest(&self, index: usize, lobe: R) -> R {
        let before = self.layers().take(index).fold(R::zero(), |sum, layer| sum + layer.weight);
        let weight = self.layers().nth(index).map_or(R::one(), |layer| layer.weight);
        let there = weight.gt(R::zero());
        ((lobe - before) / R::select(there, weight, R::one())).clamp(0.0, 1.0 - f32::EPSILON / 2.0)
    }

    /// The delta lobes: reflection, then refraction. Where layers disagree on a direction, the one that
    /// carries most light has its own.
    #[inline]
    pub fn branches(&self) -> [Branch<R>; 2] {
        let first = self.first.branches();
        if self.others.is_empty() {
            return first;
        }
        let weigh = |branch: Branch<R>, layer: &Placed<R>| Branch {
            weight: branch.weight.scale(layer.weight).only(branch.valid & layer.weight.gt(R::zero())),
            valid: branch.valid & layer.weight.gt(R::zero()),
            ..branch
        };
        let mut sum = first.map(|branch| weigh(branch, &self.first));
        let mut most = sum.map(|branch| branch.weight.max_element());
        for layer in &self.others {
            for (i, branch) in layer.branches().into_iter().enumerate() {
                let branch = weigh(branch, layer);
                let more = branch.weight.max_element().gt(most[i]);
                sum[i] = Branch {
                    wi: Vector3::select(more, branch.wi, sum[i].wi),
                    weight: sum[i].weight + branch.weight,
                    valid: sum[i].valid | branch.valid,
                };
                most[i] = branch.weight.max_element().max(most[i]);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests;
