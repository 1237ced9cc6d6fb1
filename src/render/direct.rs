//! The reflection equation: emitted light plus what every light sends directly.
//!
//! ```text
//! L(x, ω_o) = L_e(x, ω_o) + Σ over lights ∫ f(ω_i, ω_o) L_light(ω_i) cos θ_i dω_i
//! ```
//!
//! Each light is sampled once, the BSDF once, and both estimates are combined by the power heuristic
//! \[VG95\]. Mirrors and glass show lights, nothing else.

use super::integrator::{Integrator, Line, Outgoing, Path};
use super::vertex::{Sampled, Vertex, environment};
use crate::compile::Scene;
use crate::simd::Real;

/// Direct light.
pub(super) struct Direct {
    /// Emitters seen directly are left out.
    pub(super) hide_emitters: bool,
}

impl Integrator for Direct {
    fn shadow_rays(&self, scene: &Scene) -> usize {
        scene.lights.len()
    }

    fn miss<R: Real>(&self, scene: &Scene, path: &Path<R>, ray: Line<R>, out: &mut impl Outgoing<R>) {
        if path.depth > 0 || !self.hide_emitters {
            out.add_rgb(environment(scene, path, ray, Sampled::All));
        }
    }

    fn shade<R: Real>(&self, scene: &Scene, vertex: &Vertex<'_, R>, out: &mut impl Outgoing<R>) {
        let path = &vertex.path;
        if path.depth > 0 || !self.hide_emitters {
            out.add_rgb(vertex.emitted(scene, Sampled::All));
        }
        if path.depth > 0 {
            return;
        }
        let pairs = scene.lights.len() as u32 + 2;
        vertex.connect_all(
            scene,
            true,
            |k| vertex.random(pairs, k),
            |k, c| out.shadow(k, c.lanes, c.ray, c.radiance),
        );
        let (lobe, _) = vertex.random(pairs, pairs - 2);
        let (lanes, ray, next) = vertex.scatter(lobe, vertex.random(pairs, pairs - 1));
        out.next(0, lanes, ray, &next);
    }
}
