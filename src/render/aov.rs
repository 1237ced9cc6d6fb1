//! What the camera sees, in place of light: arbitrary output variables, averaged over the pixel.

use super::integrator::{Integrator, Line, Outgoing, Path};
use super::vertex::Vertex;
use crate::compile::Scene;
use crate::scene::{Aov, AovChannel};
use crate::simd::{Real, Vector3};

/// Channels in the order of the description.
pub(super) struct AovIntegrator {
    pub(super) channels: Vec<AovChannel>,
}

fn suffixes(kind: Aov) -> &'static [&'static str] {
    match kind {
        Aov::Depth => &["T"],
        Aov::Uv => &["U", "V"],
        Aov::Position | Aov::GeoNormal | Aov::ShNormal => &["X", "Y", "Z"],
    }
}

impl Integrator for AovIntegrator {
    fn channels(&self) -> Vec<String> {
        let name = |c: &AovChannel| suffixes(c.kind).iter().map(move |s| format!("{}.{s}", c.name)).collect();
        self.channels.iter().flat_map(|c| -> Vec<String> { name(c) }).collect()
    }

    fn shadow_rays(&self, _: &Scene) -> usize {
        0
    }

    fn miss<R: Real>(&self, _: &Scene, _: &Path<R>, _: Line<R>, _: &mut impl Outgoing<R>) {}

    fn shade<R: Real>(&self, _: &Scene, vertex: &Vertex<'_, R>, out: &mut impl Outgoing<R>) {
        let surface = &vertex.surface;
        let mut channel = 0;
        let mut put = |values: &[R]| {
            for &value in values {
                out.add(channel, value);
                channel += 1;
            }
        };
        for c in &self.channels {
            match c.kind {
                Aov::Depth => put(&[vertex.t]),
                Aov::Uv => put(&[surface.uv.0, surface.uv.1]),
                Aov::Position => put(&components(surface.position)),
                Aov::GeoNormal => put(&components(surface.n_g)),
                Aov::ShNormal => put(&components(surface.frame.n)),
            }
        }
    }
}

fn components<R: Real>(v: Vector3<R>) -> [R; 3] {
    [v.x, v.y, v.z]
}
