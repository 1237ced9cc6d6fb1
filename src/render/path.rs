//! The rendering equation \[Kaj86\], by paths from the eye.
//!
//! Each vertex adds what it emits, samples one light (chosen by what it would bring) and draws the next ray from the
//! BSDF; a light that is found both ways is weighted by the power heuristic \[VG95\]. Russian roulette goes
//! by the throughput without the squared index of refraction that glass puts into it.

use super::departure::draws_one;
use super::integrator::{End, Integrator, Line, Outgoing, Path};
use super::vertex::{Sampled, Vertex, environment};
use crate::compile::Scene;
use crate::simd::{Mask, Real};

/// Pairs of random numbers at a vertex: light, direction, lobe and roulette.
const PAIRS: u32 = 3;
/// A path never survives with more certainty than this.
const MAX_SURVIVAL: f32 = 0.95;

/// Global illumination.
pub(super) struct PathTracer {
    /// Vertices counted from the eye; [`u32::MAX`] is no limit.
    pub(super) max_depth: u32,
    /// Roulette begins after this many.
    pub(super) rr_depth: u32,
    /// Emitters seen directly are left out.
    pub(super) hide_emitters: bool,
}

impl Integrator for PathTracer {
    fn shadow_rays(&self, _: &Scene) -> usize {
        1
    }

    fn miss<R: Real>(&self, scene: &Scene, path: &Path<R>, ray: Line<R>, out: &mut impl Outgoing<R>) {
        if path.depth > 0 || !self.hide_emitters {
            out.add_rgb(environment(scene, path, ray, Sampled::One));
        }
    }

    fn shade<R: Real>(&self, scene: &Scene, vertex: &Vertex<'_, R>, out: &mut impl Outgoing<R>) {
        let path = &vertex.path;
        if path.depth > 0 || !self.hide_emitters {
            out.add_rgb(vertex.emitted(scene, Sampled::One));
        }
        if path.depth + 1 >= self.max_depth {
            out.end(End::Depth, R::Mask::splat(true));
            return;
        }
        let survives_by_chance = path.depth + 1 >= self.rr_depth;
        let unused = (R::zero(), R::zero());
        let smooth = vertex.is_smooth();
        let chance = survives_by_chance || vertex.chooses_lobes();
        let [light, direction, (lobe, roulette)] = match (smooth && draws_one(scene), smooth, chance) {
            (true, _, true) => vertex.randoms(PAIRS, [0, 1, 2]),
            (true, _, false) => {
                let [light, direction] = vertex.randoms(PAIRS, [0, 1]);
                [light, direction, unused]
            }
            (false, true, true) => {
                let [direction, lobe] = vertex.randoms(PAIRS, [1, 2]);
                [unused, direction, lobe]
            }
            (false, true, false) => [unused, vertex.random(PAIRS, 1), unused],
            (false, false, true) => [unused, unused, vertex.random(PAIRS, 2)],
            (false, false, false) => [unused; 3],
        };
        if let Some(c) = vertex.connect_one(scene, light) {
            out.shadow(0, c.lanes, c.ray, c.radiance);
        }
        let (mut lanes, ray, mut next) = vertex.scatter(lobe, direction);
        if next.depth + 1 >= self.max_depth {
            let may_find = scene.sight.may_find(ray);
            out.end(End::Depth, lanes & !may_find);
            lanes = lanes & may_find;
        }
        if survives_by_chance {
            let survival = (next.beta.max_element() * next.eta2).min(R::splat(MAX_SURVIVAL));
            let survives = roulette.lt(survival);
            out.end(End::Roulette, lanes & !survives);
            lanes = lanes & survives;
            next.beta = next.beta.scale(R::one() / survival);
        }
        out.next(0, lanes, ray, &next);
    }
}
