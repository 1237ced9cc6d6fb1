//! Ambient occlusion: the share of a hemisphere, weighted by the cosine, in which nothing is near.
//!
//! ```text
//! A(x) = 1/π ∫ V(x, ω; distance) cos θ dω
//! ```
//!
//! One direction a sample, drawn by the cosine; 0 where the camera sees nothing.

use super::integrator::{Integrator, Line, Outgoing, Path};
use super::vertex::Vertex;
use crate::compile::Scene;
use crate::math::{Frame, warp};
use crate::simd::{Mask, Real, Vector3};

/// Ambient occlusion.
pub(super) struct AmbientOcclusion {
    /// What is farther does not count; +∞ is no limit.
    pub(super) distance: f32,
}

impl Integrator for AmbientOcclusion {
    fn shadow_rays(&self, _: &Scene) -> usize {
        1
    }

    fn miss<R: Real>(&self, _: &Scene, _: &Path<R>, _: Line<R>, _: &mut impl Outgoing<R>) {}

    fn shade<R: Real>(&self, _: &Scene, vertex: &Vertex<'_, R>, out: &mut impl Outgoing<R>) {
        let departure = vertex.departure();
        let (u, v) = vertex.path.random(1, 0);
        let dir = Frame::around(departure.n).to_world(warp::cosine_hemisphere(u, v));
        let (org, dir) = departure.leave(dir);
        let one = R::one();
        out.shadow(
            0,
            R::Mask::splat(true),
            (org, dir, R::splat(self.distance)),
            Vector3 { x: one, y: one, z: one },
        );
    }
}
