//! What the camera sees besides light, of eight paths at a time, on its way to their pixels.
//!
//! It is said once a pixel, in the first round, when no path has been sorted away from its pixel yet. So it
//! goes straight to what the pixel has, row by row of eight channels, and never through what rounds add up.

use std::ops::Range;

use bumpalo::{Bump, collections::Vec as BumpVec, vec};

use super::aov::{AovIntegrator, Beside};
use super::integrator::{Line, Outgoing, Path};
use crate::compile::Scene;
use crate::simd::{LANES, Mask8, Real, Vec3x8, f32x8, transpose};

/// Four channels, added by one instruction.
pub(super) type Quad = [f32; 4];

/// Quads in a row of eight channels.
const ROW: usize = LANES / 4;

/// The layers of a scene, and room for those of one group.
pub(super) struct Layers<'a> {
    aovs: AovIntegrator,
    /// Channels before the first layer.
    first: usize,
    /// All channels of eight pixels, padded to whole rows.
    values: BumpVec<'a, f32x8>,
}

impl<'a> Layers<'a> {
    /// Layers that are these channels of the picture.
    pub(super) fn new(arena: &'a Bump, scene: &Scene, channels: Range<usize>) -> Self {
        let values = vec![in arena; f32x8::zero(); channels.end.next_multiple_of(LANES)];
        Self { aovs: AovIntegrator { channels: scene.aovs.clone() }, first: channels.start, values }
    }

    /// What a pixel takes, its other channels included.
    pub(super) fn quads(&self) -> usize {
        self.values.len() / LANES * ROW
    }

    /// Puts what `say` says of a group into the sums of its pixels, which are 0 before. Lanes without a pixel
    /// say nothing.
    #[inline]
    pub(super) fn put(
        &mut self,
        pixels: &[u32],
        sums: &mut [Quad],
        say: impl FnOnce(&AovIntegrator, &mut Beside<'_, Lanes<'_>>),
    ) {
        self.values.fill(f32x8::zero());
        say(&self.aovs, &mut Beside { out: &mut Lanes(&mut self.values), first: self.first });
        let quads = self.quads();
        for (k, eight) in self.values.chunks_exact(LANES).enumerate() {
            let rows = transpose(std::array::from_fn(|i| eight[i]));
            for (row, &pixel) in rows.iter().zip(pixels) {
                let place = pixel as usize * quads + k * ROW;
                sums[place..][..ROW].as_flattened_mut().copy_from_slice(&row.to_array());
            }
        }
    }
}

/// A register a channel.
pub(super) struct Lanes<'v>(&'v mut [f32x8]);

impl Outgoing<f32x8> for Lanes<'_> {
    /// A sum of one, as everything else that a pixel has: −0 is 0.
    #[inline]
    fn add(&mut self, channel: usize, value: f32x8) {
        self.0[channel] = self.0[channel] + value;
    }

    fn shadow(&mut self, _: usize, _: Mask8, _: (Vec3x8, Vec3x8, f32x8), _: Vec3x8) {}

    fn next(&mut self, _: usize, _: Mask8, _: Line<f32x8>, _: &Path<f32x8>) {}
}
