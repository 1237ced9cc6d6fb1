//! Groups of one material, from rows to what their vertices say.

use super::census::Ends;
use super::group::{Group, Outputs};
use super::integrator::Integrator;
use super::layers::Layers;
use super::rows::{Hits, Packet, Paths, fill};
use super::vertex::{Kept, Vertex};
use crate::compile::Scene;
use crate::film::sums::Quad;
use crate::material::MaterialId;
use crate::simd::{Eights, LANES, ONE_REGISTER, f32x8, f32x16};

/// The vertices of a round, and where they say what they have to say.
pub(super) struct Shading<'s, 'a, I> {
    pub(super) scene: &'s Scene,
    pub(super) integrator: &'s I,
    pub(super) paths: &'s Paths<'a>,
    pub(super) hits: &'s Hits<'a>,
    pub(super) out: &'s mut Outputs<'a>,
    /// Where the camera sees more than light.
    pub(super) layers: Option<&'s mut Layers<'a>>,
    pub(super) sums: &'s mut [Quad],
    pub(super) ends: Option<&'s mut Ends>,
    pub(super) depth: u32,
    /// The key of those that met nothing.
    pub(super) miss: u32,
}

impl<I: Integrator> Shading<'_, '_, I> {
    /// Slots of one key, at most [`MOST`](crate::simd::MOST): in as many lanes as they fill.
    pub(super) fn group(&mut self, key: u32, slots: &[u32]) {
        if ONE_REGISTER && slots.len() > LANES {
            self.in_lanes::<f32x16>(key, slots);
        } else {
            self.in_lanes::<f32x8>(key, slots);
        }
    }

    #[inline]
    fn in_lanes<R: Eights>(&mut self, key: u32, slots: &[u32]) {
        let Self { scene, integrator, paths, hits, out, layers, sums, ends, depth, miss } = self;
        let at = fill(slots);
        let Packet::<R> { org, dir, path, pixel, .. } = paths.packet(&at, *depth);
        let mut group = Group::<R> { slots: at, count: slots.len(), pixel, out, ends: ends.as_deref_mut() };
        if key == *miss {
            integrator.miss(scene, &path, (org, dir), &mut group);
            if let Some(layers) = layers {
                layers.put::<R>(pixel, sums, |aovs, out| {
                    aovs.miss(scene, &path, (org, dir), out);
                });
            }
            return;
        }
        let (tuv, primitive) = hits.packet(&at);
        let kept = layers.as_ref().filter(|layers| layers.draws()).map(|_| Kept::new());
        let mut vertex = Vertex::new(scene, path, (org, dir), tuv, primitive, MaterialId(key));
        if let Some(kept) = &kept {
            vertex.keep_randoms(kept);
        }
        integrator.shade(scene, &vertex, &mut group);
        if let Some(layers) = layers {
            layers.put::<R>(pixel, sums, |aovs, out| aovs.shade(scene, &vertex, out));
        }
    }
}
