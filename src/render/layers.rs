//! What the camera sees besides light, of eight paths at a time, on its way to their pixels.
//!
//! It is said once a pixel, in the first round, when no path has been sorted away from its pixel yet. So it
//! goes straight to what the pixel has, row by row of eight channels, and never through what rounds add up.

use std::ops::Range;

use bumpalo::{Bump, collections::Vec as BumpVec, vec};

use super::aov::{AovIntegrator, Beside};
use super::integrator::{Line, Outgoing, Path};
use crate::compile::Scene;
use crate::film::sums::{self, Quad};
use crate::simd::{LANES, Mask8, Real, Vec3x8, f32x8, transpose};

/// The layers of a scene, and room for those of one group.
pub(super) struct Layers<'a> {
    aovs: AovIntegrator,
    /// Channels before the first layer.
    first: usize,
    /// Eight pixels' rows of the film, a register a number. Light is 0 in them, and what is behind the channels stays
    /// as it is.
    values: BumpVec<'a, f32x8>,
    /// In a row of the film.
    quads: usize,
}

impl<'a> Layers<'a> {
    /// Layers that are these channels of the picture, the last ones.
    pub(super) fn new(arena: &'a Bump, scene: &Scene, channels: Range<usize>) -> Self {
        let quads = sums::quads(channels.end);
        let mut values = vec![in arena; f32x8::zero(); (4 * quads).next_multiple_of(LANES)];
        values[channels.end] = f32x8::one();
        Self { aovs: AovIntegrator::new(scene.aovs.clone()), first: channels.start, values, quads }
    }

    /// Puts what `say` says of a group, which is every channel, into the rows of its pixels.
    #[inline]
    pub(super) fn put(
        &mut self,
        pixels: [u32; LANES],
        rows: &mut [Quad],
        say: impl FnOnce(&AovIntegrator, &mut Beside<'_, Lanes<'_>>),
    ) {
        say(&self.aovs, &mut Beside { out: &mut Lanes(&mut self.values), first: self.first });
        let rows = rows.as_flattened_mut();
        for (k, eight) in self.values.as_chunks::<LANES>().0.iter().enumerate() {
            let numbers = transpose(*eight);
            if self.quads == 1 {
                for (numbers, pixel) in numbers.iter().zip(pixels) {
                    rows[4 * pixel as usize..][..4].copy_from_slice(&numbers.to_array()[..4]);
                }
                return;
            }
            // Lanes behind the last of a group say what it says.
            for (numbers, pixel) in numbers.iter().zip(pixels) {
                let place = 4 * self.quads * pixel as usize + LANES * k;
                rows[place..][..LANES].copy_from_slice(&numbers.to_array());
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
        self.0[channel] = f32x8::zero() + value;
    }

    fn shadow(&mut self, _: usize, _: Mask8, _: (Vec3x8, Vec3x8, f32x8), _: Vec3x8) {}

    fn next(&mut self, _: usize, _: Mask8, _: Line<f32x8>, _: &Path<f32x8>) {}
}
