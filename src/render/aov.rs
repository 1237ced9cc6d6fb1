//! What the camera sees, in place of light or beside it: arbitrary output variables, averaged over the
//! pixel.

use super::integrator::{Integrator, Line, Outgoing, Path};
use super::measure::Counts;
use super::vertex::Vertex;
use crate::bvh::Traversal;
use crate::compile::Scene;
use crate::geometry::Ray;
use crate::scene::{Aov, AovChannel};
use crate::simd::{MOST, Real, Vector3};

/// Channels of the layers beside a picture, named as compositing programs know them: distance is `Z`.
pub(super) fn layers(aovs: &[AovChannel]) -> impl Iterator<Item = String> + '_ {
    let suffixes = |kind| if kind == Aov::Depth { &["Z"] } else { suffixes(kind) };
    aovs.iter().flat_map(move |c| suffixes(c.kind).iter().map(move |s| format!("{}.{s}", c.name)))
}

/// Where the layers beside a picture go: behind the channels that the integrator has. They send no rays.
pub(super) struct Beside<'a, O> {
    pub(super) out: &'a mut O,
    pub(super) first: usize,
}

impl<R: Real, O: Outgoing<R>> Outgoing<R> for Beside<'_, O> {
    fn add(&mut self, channel: usize, value: R) {
        self.out.add(self.first + channel, value);
    }

    fn shadow(&mut self, _: usize, _: R::Mask, _: (Vector3<R>, Vector3<R>, R), _: Vector3<R>) {}

    fn next(&mut self, _: usize, _: R::Mask, _: Line<R>, _: &Path<R>) {}
}

/// Channels in the order of the description.
pub(super) struct AovIntegrator {
    channels: Vec<AovChannel>,
    /// Does any of them ask for [`counts`]?
    counted: bool,
    /// Does any of them ask for random numbers?
    pub(super) draws: bool,
}

fn suffixes(kind: Aov) -> &'static [&'static str] {
    match kind {
        Aov::Depth => &["T"],
        Aov::Uv => &["U", "V"],
        Aov::DirectionalAlbedo => &["R", "G", "B"],
        Aov::MaterialId | Aov::PrimitiveId => &["I"],
        Aov::Nodes | Aov::Primitives => &["N"],
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

    /// Nothing is 0, which is said, but for the way to it through the tree.
    fn miss<R: Real>(&self, scene: &Scene, _: &Path<R>, ray: Line<R>, out: &mut impl Outgoing<R>) {
        let counts = self.counts(scene, ray);
        let mut channel = 0;
        for c in &self.channels {
            let value = match c.kind {
                Aov::Nodes => counts.0,
                Aov::Primitives => counts.1,
                _ => R::zero(),
            };
            for _ in suffixes(c.kind) {
                out.add(channel, value);
                channel += 1;
            }
        }
    }

    fn shade<R: Real>(&self, scene: &Scene, vertex: &Vertex<'_, R>, out: &mut impl Outgoing<R>) {
        let surface = &vertex.surface;
        let counts = self.counts(scene, (vertex.from, vertex.dir));
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
                Aov::Uv => put(&[surface.uv.u, surface.uv.v]),
                Aov::Position => put(&components(surface.position)),
                Aov::GeoNormal => put(&components(surface.n_g)),
                Aov::ShNormal => put(&components(surface.frame.n)),
                Aov::DirectionalAlbedo => {
                    let unused = (R::zero(), R::zero());
                    let random = |asked, index| if asked { vertex.first_random(index) } else { unused };
                    let (lobe, _) = random(vertex.chooses_lobes(), 1);
                    put(&components(vertex.albedo(lobe, random(vertex.is_smooth(), 0))));
                }
                Aov::MaterialId => put(&[R::splat(vertex.material.0 as f32 + 1.0)]),
                Aov::PrimitiveId => put(&[R::from_int(vertex.primitive) + R::one()]),
                Aov::Nodes => put(&[counts.0]),
                Aov::Primitives => put(&[counts.1]),
            }
        }
    }
}

impl AovIntegrator {
    /// Of these channels.
    pub(super) fn new(channels: Vec<AovChannel>) -> Self {
        let counted = channels.iter().any(|c| matches!(c.kind, Aov::Nodes | Aov::Primitives));
        let draws = channels.iter().any(|c| c.kind == Aov::DirectionalAlbedo);
        Self { channels, counted, draws }
    }

    #[inline]
    fn counts<R: Real>(&self, scene: &Scene, ray: Line<R>) -> (R, R) {
        if self.counted { counts(scene, ray) } else { (R::zero(), R::zero()) }
    }
}

/// Nodes and primitives that rays are tested against, each by itself: what packets do depends on their neighbours.
#[cold]
fn counts<R: Real>(scene: &Scene, (org, dir): Line<R>) -> (R, R) {
    let mut lanes = [Counts::default(); MOST];
    for (i, counts) in lanes[..R::LANES].iter_mut().enumerate() {
        let mut traversal = Traversal::new(Counts::default());
        scene.closest_hit(&Ray::new(org.lane(i), dir.lane(i), 0.0, f32::INFINITY), &mut traversal);
        *counts = traversal.tally;
    }
    (R::from_fn(|i| lanes[i].nodes as f32), R::from_fn(|i| lanes[i].primitives as f32))
}

fn components<R: Real>(v: Vector3<R>) -> [R; 3] {
    [v.x, v.y, v.z]
}
