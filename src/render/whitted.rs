//! Whitted's recursion \[Whi80\]: direct light at smooth surfaces, both branches at mirrors and glass.

use super::integrator::{Integrator, Line, Outgoing, Path};
use super::vertex::{Sampled, Vertex, environment};
use crate::compile::Scene;
use crate::math::Sampler;
use crate::simd::Real;

/// The classic picture. Shadow rays go to every light and are blocked by glass.
pub(super) struct Whitted {
    /// Vertices counted from the eye.
    pub(super) max_depth: u32,
}

impl Integrator for Whitted {
    fn shadow_rays(&self, scene: &Scene) -> usize {
        scene.lights.len()
    }

    fn branches(&self) -> usize {
        2
    }

    fn miss<R: Real>(&self, scene: &Scene, path: &Path<R>, ray: Line<R>, out: &mut impl Outgoing<R>) {
        out.add_rgb(environment(scene, path, ray, Sampled::All));
    }

    fn shade<R: Real>(&self, scene: &Scene, vertex: &Vertex<'_, R>, out: &mut impl Outgoing<R>) {
        let path = &vertex.path;
        out.add_rgb(vertex.emitted(scene, Sampled::All));
        if path.depth + 1 >= self.max_depth {
            return;
        }
        let pairs = scene.lights.len() as u32;
        vertex.connect_all(
            scene,
            false,
            |k| vertex.random(pairs, k),
            |k, c| out.shadow(k, c.lanes, c.ray, c.radiance),
        );
        if !vertex.is_split() {
            return;
        }
        let [(reflects, mirrored, reflected), (refracts, through, refracted)] = vertex.branches();
        out.next(0, reflects, mirrored, &reflected);
        let key = Sampler::<R>::new(path.key, path.sample).branch_key();
        out.next(1, refracts, through, &Path { key, ..refracted });
    }
}
