//! Irradiance: what a light meter reads.
//!
//! ```text
//! E(x, n) = ∫ L(x, ω) max(n·ω, 0) dω   W/m²
//! ```
//!
//! At what the camera sees, whatever it is made of, on the side that is seen; or at one point, or over a
//! surface, which every pixel then measures for itself, so that their spread is an honest error. Lights are sampled, the
//! cosine is sampled, both are weighed by the power heuristic \[VG95\], and what comes back from other
//! surfaces is found by paths.

use glam::Vec3;

use super::departure::Departure;
use super::integrator::{Integrator, Line, Outgoing, Path};
use super::path::PathTracer;
use super::vertex::Vertex;
use crate::compile::Scene;
use crate::math::{Frame, INV_PI, warp};
use crate::simd::{Mask, Real, Vector3};

/// Pairs of random numbers at the receiver: light, direction.
const PAIRS: u32 = 2;

/// What receives light, from one side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Receiver {
    /// One point.
    Point {
        /// World space.
        position: Vec3,
        /// Unit length.
        normal: Vec3,
    },
    /// The surface that the scene's sensor measures, each part of it by its area; nothing if the sensor is a
    /// camera.
    Sensor,
}

/// Irradiance of surfaces.
pub(super) struct Irradiance {
    /// How light gets there; the receiver counts as a vertex.
    pub(super) paths: PathTracer,
    /// In place of what the camera sees.
    pub(super) receiver: Option<Receiver>,
}

impl Irradiance {
    fn receive<R: Real>(
        &self,
        scene: &Scene,
        departure: &Departure<R>,
        path: &Path<R>,
        out: &mut impl Outgoing<R>,
    ) {
        if self.paths.max_depth <= 1 {
            return;
        }
        let eval = |wi: Vector3<R>| {
            let cos = wi.dot(departure.n).max(R::zero());
            (Vector3 { x: cos, y: cos, z: cos }, cos * R::splat(INV_PI))
        };
        if let Some(c) = departure.connect_one(scene, path.random(PAIRS, 0), &eval) {
            out.shadow(0, c.lanes, c.ray, c.radiance);
        }
        let (u, v) = path.random(PAIRS, 1);
        let local = warp::cosine_hemisphere(u, v);
        let dir = Frame::around(departure.n).to_world(local);
        let next = Path {
            beta: Vector3::splat(Vec3::splat(std::f32::consts::PI)),
            pdf: warp::cosine_hemisphere_pdf(local.z),
            depth: 1,
            ..*path
        };
        out.next(0, R::Mask::splat(true), departure.leave(dir), &next);
    }
}

impl Integrator for Irradiance {
    fn shadow_rays(&self, _: &Scene) -> usize {
        1
    }

    fn begins(&self) -> bool {
        self.receiver.is_some()
    }

    fn begin<R: Real>(&self, scene: &Scene, path: &Path<R>, out: &mut impl Outgoing<R>) {
        let (position, extent, n) = match (self.receiver, &scene.metered) {
            // As far off what the point may lie upon as rounding could put that surface.
            (Some(Receiver::Point { position, normal }), _) => {
                (Vector3::splat(position), scene.extent(), Vector3::splat(normal))
            }
            (Some(Receiver::Sensor), Some(surface)) => {
                let (position, n) = surface.sample(path.on_film());
                (position, surface.extent, n)
            }
            _ => return,
        };
        self.receive(scene, &Departure { position, extent: Vector3::splat(extent), n_g: n, n }, path, out);
    }

    fn miss<R: Real>(&self, scene: &Scene, path: &Path<R>, ray: Line<R>, out: &mut impl Outgoing<R>) {
        if path.depth > 0 {
            self.paths.miss(scene, path, ray, out);
        }
    }

    fn shade<R: Real>(&self, scene: &Scene, vertex: &Vertex<'_, R>, out: &mut impl Outgoing<R>) {
        match vertex.path.depth {
            0 => self.receive(scene, &vertex.departure(), &vertex.path, out),
            _ => self.paths.shade(scene, vertex, out),
        }
    }
}
