//! A vertex of a path: a surface, its material there, and the three things that light does at it.

use super::integrator::Path;
use crate::compile::{Scene, Surface};
use crate::geometry::{REACH, offset_origin};
use crate::light::{Light, LightId, SurfacePoint, power_heuristic};
use crate::material::{Appearance, MaterialId, Point};
use crate::simd::{Bits, Mask, Real, Vector3};

/// Points where paths have arrived, all of one material.
#[derive(Clone, Debug)]
pub(super) struct Vertex<'s, R: Real> {
    pub(super) path: Path<R>,
    /// Origin of the ray that arrived.
    pub(super) from: Vector3<R>,
    /// Its parameter.
    pub(super) t: R,
    pub(super) surface: Surface<R>,
    /// cos θ_o as the surface stores its normal.
    cos_o: R,
    appearance: Appearance<'s, R>,
}

/// A path that goes on: in which lanes, along which ray (org, dir), and what it is worth.
pub(super) type Continuation<R> = (<R as Real>::Mask, (Vector3<R>, Vector3<R>), Path<R>);

/// Which lights each vertex samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sampled {
    /// Every one.
    All,
    /// One, by the scene's choice.
    One,
}

impl Sampled {
    /// Of a light, at the vertices `from`.
    #[inline]
    fn probability<R: Real>(self, scene: &Scene, light: usize, from: Vector3<R>) -> R {
        match self {
            Self::All => R::one(),
            Self::One => scene.light_choice.probability(light, from),
        }
    }
}

/// Light from one emitter, to be added if it is not blocked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Connection<R: Real> {
    pub(super) lanes: R::Mask,
    /// (org, dir, t_far).
    pub(super) ray: (Vector3<R>, Vector3<R>, R),
    pub(super) radiance: Vector3<R>,
}

impl<'s, R: Real> Vertex<'s, R> {
    /// The vertices where rays (org, dir) met `primitive` at (t, u, v).
    #[inline]
    pub(super) fn new(
        scene: &'s Scene,
        path: Path<R>,
        (org, dir): (Vector3<R>, Vector3<R>),
        (t, u, v): (R, R, R),
        primitive: R::Bits,
        material: MaterialId,
    ) -> Self {
        let oriented = scene.materials.is_oriented(material);
        let surface = scene.surface((org, dir), (t, u, v), primitive, oriented);
        let wo = surface.frame.to_local(-dir);
        let tangents = match oriented {
            true => surface.partials.map(|partial| surface.frame.to_local(partial)),
            false => surface.partials,
        };
        let point = Point { wo, uv: surface.uv, tangents };
        let appearance = scene.materials.appearance(material, &scene.textures, &point);
        Self { path, from: org, t, surface, cos_o: wo.z, appearance }
    }

    /// f |cos θ_i| for a world direction, and the density with which it is sampled.
    #[inline]
    fn eval(&self, wi: Vector3<R>) -> (Vector3<R>, R) {
        self.appearance.eval(self.surface.frame.to_local(wi))
    }

    /// The ray from the surface along a world direction.
    #[inline]
    fn leave(&self, dir: Vector3<R>) -> (Vector3<R>, Vector3<R>) {
        let surface = &self.surface;
        (offset_origin(surface.position, surface.extent, surface.n_g, dir), dir)
    }

    /// A BSDF sample as the ray that goes on: (lanes, ray, path).
    #[inline]
    pub(super) fn scatter(&self, lobe: R, u: (R, R)) -> Continuation<R> {
        let sample = self.appearance.sample(lobe, u);
        let beta = self.path.beta * sample.weight;
        let path = Path {
            beta,
            pdf: R::select(sample.delta, R::splat(f32::INFINITY), sample.pdf),
            eta2: self.path.eta2 * sample.eta * sample.eta,
            depth: self.path.depth + 1,
            ..self.path
        };
        let lanes = sample.valid & beta.max_element().gt(R::zero());
        (lanes, self.leave(self.surface.frame.to_world(sample.wi)), path)
    }

    /// The delta lobes as rays that go on: reflection, refraction.
    #[inline]
    pub(super) fn branches(&self) -> [Continuation<R>; 2] {
        self.appearance.branches().map(|branch| {
            let beta = self.path.beta * branch.weight;
            let lanes = branch.valid & beta.max_element().gt(R::zero());
            let path = Path { beta, depth: self.path.depth + 1, ..self.path };
            (lanes, self.leave(self.surface.frame.to_world(branch.wi)), path)
        })
    }

    /// Light that the surface itself sends along the ray, times `beta`. Where the ray was drawn with a
    /// density, it is weighted against light sampling.
    #[inline]
    pub(super) fn emitted(&self, scene: &Scene, sampled: Sampled) -> Vector3<R> {
        let mut total = Vector3::zero();
        for (light, lanes) in distinct::<R>(self.surface.light) {
            let Some(Light::Area(area)) = scene.lights.get(light as usize) else {
                continue;
            };
            let lanes = lanes & self.cos_o.gt(R::zero());
            let point = SurfacePoint { position: self.surface.position, n_g: self.surface.n_g };
            let light_pdf =
                area.pdf(self.from, &point) * sampled.probability(scene, light as usize, self.from);
            let weight = mis_weight(self.path.pdf, light_pdf);
            total = total + (self.path.beta * Vector3::splat(area.radiance)).scale(weight).only(lanes);
        }
        total
    }

    /// Light from one emitter, with the probability that it was picked. `mis` weighs it against BSDF
    /// sampling.
    #[inline]
    pub(super) fn connect(&self, light: &Light, pick: R, mis: bool, u: (R, R)) -> Connection<R> {
        let sample = light.sample(self.surface.position, u);
        let (f, bsdf_pdf) = self.eval(sample.wi);
        let light_pdf = sample.pdf * pick;
        let can_be_hit = sample.pdf.gt(R::zero());
        let weight = if mis {
            R::select(can_be_hit, power_heuristic(light_pdf, bsdf_pdf), R::one())
        } else {
            R::one()
        };
        let radiance = (self.path.beta * f * sample.weight).scale(weight * (R::one() / pick));
        let (org, _) = self.leave(sample.wi);
        let (dir, t_far) = if sample.at_infinity {
            (sample.wi, R::splat(f32::INFINITY))
        } else {
            (sample.target - org, R::splat(REACH))
        };
        Connection {
            lanes: sample.valid & radiance.max_element().gt(R::zero()),
            ray: (org, dir, t_far),
            radiance,
        }
    }

    /// Light from all emitters, one connection each: `connect` for those that can contribute.
    #[inline]
    pub(super) fn connect_all(
        &self,
        scene: &Scene,
        mis: bool,
        random: impl Fn(u32) -> (R, R),
        mut shadow: impl FnMut(usize, Connection<R>),
    ) {
        if !self.appearance.is_smooth() {
            return;
        }
        for (index, light) in scene.lights.iter().enumerate() {
            shadow(index, self.connect(light, R::one(), mis, random(index as u32)));
        }
    }

    /// Light from one emitter a lane, chosen by [`LightChoice`](crate::light::LightChoice).
    #[inline]
    pub(super) fn connect_one(&self, scene: &Scene, (u, v): (R, R)) -> Option<Connection<R>> {
        if scene.lights.is_empty() || !self.appearance.is_smooth() {
            return None;
        }
        let at = self.surface.position;
        let (chosen, rest) = scene.light_choice.choose(u, at);
        let mut all: Option<Connection<R>> = None;
        for (index, lanes) in distinct::<R>(chosen) {
            let pick = scene.light_choice.probability(index as usize, at);
            let one = self.connect(&scene.lights[index as usize], pick, true, (rest, v));
            all = Some(match all {
                None => Connection { lanes: one.lanes & lanes, ..one },
                Some(all) => Connection {
                    lanes: (all.lanes & !lanes) | (one.lanes & lanes),
                    ray: (
                        Vector3::select(lanes, one.ray.0, all.ray.0),
                        Vector3::select(lanes, one.ray.1, all.ray.1),
                        R::select(lanes, one.ray.2, all.ray.2),
                    ),
                    radiance: Vector3::select(lanes, one.radiance, all.radiance),
                },
            });
        }
        all
    }
}

/// Light from infinity along rays (org, dir) that leave the scene, times `beta`; weighted as by
/// [`Vertex::emitted`].
#[inline]
pub(super) fn environment<R: Real>(
    scene: &Scene,
    path: &Path<R>,
    (from, dir): (Vector3<R>, Vector3<R>),
    sampled: Sampled,
) -> Vector3<R> {
    let mut total = Vector3::zero();
    for &LightId(index) in &scene.environments {
        let (radiance, pdf) = scene.lights[index as usize].environment(dir);
        let weight = mis_weight(path.pdf, pdf * sampled.probability(scene, index as usize, from));
        total = total + (path.beta * radiance).scale(weight);
    }
    total
}

/// The power heuristic, 1 for rays that no light sample could have drawn.
#[inline]
fn mis_weight<R: Real>(pdf: R, light_pdf: R) -> R {
    let only_way = pdf.equal(R::splat(f32::INFINITY));
    R::select(only_way, R::one(), power_heuristic(pdf, light_pdf))
}

/// The different values among lanes, each with its lanes.
#[inline]
fn distinct<R: Real>(values: R::Bits) -> impl Iterator<Item = (u32, R::Mask)> {
    let mut left = (1u32 << R::LANES) - 1;
    std::iter::from_fn(move || {
        if left == 0 {
            return None;
        }
        let value = values.lane(left.trailing_zeros() as usize);
        let lanes = values.equal(R::Bits::splat(value));
        left &= !lanes.to_bitmask();
        Some((value, lanes))
    })
}
