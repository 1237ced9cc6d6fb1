//! A vertex of a path: a surface, its material there, and the three things that light does at it.

use std::cell::Cell;

use super::departure::{Connection, Departure, distinct};
use super::integrator::{Line, Path};
use crate::compile::{Asked, Scene, Surface};
use crate::light::{Light, LightId, SurfacePoint, power_heuristic};
use crate::material::{Appearance, Branch, MaterialId, Point};
use crate::simd::{Bits, Mask, Real, Vector3};

/// How many pairs are kept where layers need random numbers too.
const FIRST: usize = 2;

/// Points where paths have arrived, all of one material.
#[derive(Clone, Debug)]
pub(super) struct Vertex<'s, R: Real> {
    pub(super) path: Path<R>,
    /// Origin of the ray that arrived.
    pub(super) from: Vector3<R>,
    /// Its direction.
    pub(super) dir: Vector3<R>,
    /// Its parameter.
    pub(super) t: R,
    pub(super) material: MaterialId,
    /// [`PrimitiveId`](crate::geometry::PrimitiveId)s.
    pub(super) primitive: R::Bits,
    pub(super) surface: Surface<R>,
    /// cos θ_o as the surface stores its normal.
    cos_o: R,
    appearance: Appearance<'s, R>,
    /// Where it is the first of a path, and somebody will ask for [`first_random`](Self::first_random).
    kept: Option<&'s Kept<R>>,
}

/// First pairs that have been drawn.
#[derive(Clone, Debug)]
pub(super) struct Kept<R: Real> {
    pairs: [Cell<Pair<R>>; FIRST],
    /// Which of them: bits.
    drawn: Cell<u32>,
}

impl<R: Real> Kept<R> {
    /// None.
    #[inline]
    pub(super) fn new() -> Self {
        Self { pairs: std::array::from_fn(|_| Cell::new((R::zero(), R::zero()))), drawn: Cell::new(0) }
    }

    #[inline]
    fn keep(&self, index: u32, pair: Pair<R>) {
        if let Some(kept) = self.pairs.get(index as usize) {
            kept.set(pair);
            self.drawn.set(self.drawn.get() | 1 << index);
        }
    }

    #[inline]
    fn get(&self, index: u32) -> Option<Pair<R>> {
        let drawn = self.drawn.get() >> index & 1 != 0;
        self.pairs.get(index as usize).filter(|_| drawn).map(Cell::get)
    }
}

/// A pair of random numbers.
type Pair<R> = (R, R);

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

impl<'s, R: Real> Vertex<'s, R> {
    /// The vertices where rays (org, dir) met `primitive` at (t, u, v).
    #[inline(always)]
    pub(super) fn new(
        scene: &'s Scene,
        path: Path<R>,
        (org, dir): (Vector3<R>, Vector3<R>),
        (t, u, v): (R, R, R),
        primitive: R::Bits,
        material: MaterialId,
    ) -> Self {
        let oriented = scene.materials.is_oriented(material);
        // Layers are said of what the camera sees, and of nothing behind it.
        let asked = Asked { oriented, mapped: scene.shows_uv && path.depth == 0 };
        let surface = scene.surface((org, dir), (t, u, v), primitive, asked);
        let wo = surface.frame.to_local(-dir);
        let tangents = match oriented {
            true => surface.partials.map(|partial| surface.frame.to_local(partial)),
            false => surface.partials,
        };
        let point = Point { wo, uv: surface.uv, tangents };
        let appearance = scene.materials.appearance(material, &scene.textures, &point);
        Self { path, from: org, dir, t, material, primitive, surface, cos_o: wo.z, appearance, kept: None }
    }

    /// Somebody will ask for [`first_random`](Self::first_random) of this vertex, the first of its paths.
    #[inline]
    pub(super) fn keep_randoms(&mut self, kept: &'s Kept<R>) {
        self.kept = Some(kept);
    }

    /// Random numbers: the `index`-th of at most `count` pairs that the integrator uses at a vertex.
    #[inline]
    pub(super) fn random(&self, count: u32, index: u32) -> Pair<R> {
        // Drawn together, two pairs take hardly longer than one.
        if index > 0 && self.kept.is_some_and(|kept| kept.get(0).is_none()) {
            let [pair, _] = self.randoms(count, [index, 0]);
            return pair;
        }
        let [pair] = self.randoms(count, [index]);
        pair
    }

    /// Several of these pairs, in less time than one after the other.
    #[inline]
    pub(super) fn randoms<const N: usize>(&self, count: u32, indices: [u32; N]) -> [Pair<R>; N] {
        let pairs = self.path.randoms(count, indices);
        if let Some(kept) = self.kept {
            (0..N).for_each(|i| kept.keep(indices[i], pairs[i]));
        }
        pairs
    }

    /// One of the first two pairs of a path's first vertex, whatever its integrator uses them for.
    #[inline]
    pub(super) fn first_random(&self, index: u32) -> Pair<R> {
        let kept = self.kept.and_then(|kept| kept.get(index));
        kept.unwrap_or_else(|| self.path.random(FIRST as u32, index))
    }

    /// β f |cos θ_i| for a world direction, and the density with which it is sampled.
    #[inline]
    fn worth(&self, wi: Vector3<R>) -> (Vector3<R>, R) {
        let (f, pdf) = self.appearance.eval(self.surface.frame.to_local(wi));
        (self.path.beta * f, pdf)
    }

    /// Where rays leave.
    #[inline]
    pub(super) fn departure(&self) -> Departure<R> {
        let Surface { position, extent, n_g, ref frame, .. } = self.surface;
        let n = Vector3::select(self.cos_o.lt(R::zero()), -frame.n, frame.n);
        Departure { position, extent, n_g, n }
    }

    /// The ray from the surface along a world direction.
    #[inline]
    fn leave(&self, dir: Vector3<R>) -> Line<R> {
        self.departure().leave(dir)
    }

    /// Does [`scatter`](Self::scatter) look at its number for lobes?
    #[inline]
    pub(super) fn chooses_lobes(&self) -> bool {
        self.appearance.chooses_lobes()
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

    /// What a BSDF sample weighs: on average the directional albedo, ∫ f |cos θ_i| dω.
    #[inline]
    pub(super) fn albedo(&self, lobe: R, u: (R, R)) -> Vector3<R> {
        self.appearance.sampled_weight(lobe, u)
    }

    /// Is there anything but delta lobes? If not, [`scatter`](Self::scatter) does not look at its pair of numbers.
    #[inline]
    pub(super) fn is_smooth(&self) -> bool {
        self.appearance.is_smooth()
    }

    /// Is there a delta lobe?
    #[inline]
    pub(super) fn is_split(&self) -> bool {
        self.appearance.is_split()
    }

    /// The delta lobes as rays that go on: reflection, refraction.
    #[inline]
    pub(super) fn branches(&self) -> [Continuation<R>; 2] {
        let follow = |branch: Branch<R>| {
            let beta = self.path.beta * branch.weight;
            let lanes = branch.valid & beta.max_element().gt(R::zero());
            let path = Path { beta, depth: self.path.depth + 1, ..self.path };
            (lanes, self.leave(self.surface.frame.to_world(branch.wi)), path)
        };
        let [reflection, refraction] = self.appearance.branches();
        [follow(reflection), follow(refraction)]
    }

    /// Light that the surface itself sends along the ray, times `beta`. Where the ray was drawn with a
    /// density, it is weighted against light sampling.
    #[inline]
    pub(super) fn emitted(&self, scene: &Scene, sampled: Sampled) -> Vector3<R> {
        let mut total = Vector3::zero();
        if (!self.surface.light.equal(R::Bits::splat(LightId::NONE.0))).none() {
            return total;
        }
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
        let departure = self.departure();
        for (index, light) in scene.lights.iter().enumerate() {
            let u = if light.is_drawn() { random(index as u32) } else { (R::zero(), R::zero()) };
            shadow(index, departure.connect(light, R::one(), mis, u, &|wi| self.worth(wi)));
        }
    }

    /// Light from one emitter a lane.
    #[inline]
    pub(super) fn connect_one(&self, scene: &Scene, u: (R, R)) -> Option<Connection<R>> {
        match self.appearance.is_smooth() {
            true => self.departure().connect_one(scene, u, &|wi| self.worth(wi)),
            false => None,
        }
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

#[cfg(test)]
mod tests {
    use std::hint::black_box;

    use glam::{DAffine3, Vec3};

    use super::*;
    use crate::compile::compile;
    use crate::scene::{Geometry, Material, MaterialIndex, SceneDescription, Shape};

    #[test]
    fn pairs_that_light_has_drawn_are_those_that_layers_would_draw() {
        let disk = Shape {
            name: String::new(),
            geometry: Geometry::Disk,
            to_world: DAffine3::IDENTITY,
            flip_normals: false,
            material: MaterialIndex(0),
            radiance: None,
        };
        let description = SceneDescription {
            shapes: vec![disk],
            materials: vec![Material::default()],
            ..Default::default()
        };
        let scene = compile(&description).expect("it compiles");
        let line = (Vec3::Z.into(), Vec3::NEG_Z.into());
        let own = [0, 1].map(|index| Path::<f32>::start(7, 3).random(FIRST as u32, index));
        // The pairs that an integrator asks for, and which of the first two are there afterwards.
        type Ask = fn(&Vertex<'_, f32>);
        let asks: [(Ask, [bool; 2]); 5] = [
            (|_| {}, [false, false]),
            (
                |vertex| {
                    black_box(vertex.random(3, 0));
                },
                [true, false],
            ),
            (
                |vertex| {
                    black_box(vertex.random(3, 2));
                },
                [true, false],
            ),
            (
                |vertex| {
                    black_box(vertex.randoms(3, [1, 2]));
                },
                [false, true],
            ),
            (
                |vertex| {
                    black_box(vertex.randoms(3, [0, 1, 2]));
                },
                [true, true],
            ),
        ];
        for (number, (ask, there)) in asks.into_iter().enumerate() {
            let kept = Kept::new();
            let path = Path::<f32>::start(7, 3);
            let mut vertex = Vertex::new(&scene, path, line, (1.0, 0.0, 0.0), 0, MaterialId(0));
            vertex.keep_randoms(&kept);
            ask(&vertex);
            assert_eq!([0, 1].map(|index| kept.get(index).is_some()), there, "{number}");
            assert_eq!([0, 1].map(|index| vertex.first_random(index)), own, "{number}");
        }
    }
}
