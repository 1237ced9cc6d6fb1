//! What the camera sees besides light, of a group of paths at a time, on its way to their pixels.
//!
//! It is said once a pixel, in the first round, when no path has been sorted away from its pixel yet. So it
//! goes straight to what the pixel has, row by row of eight channels, and never through what rounds add up.

use std::ops::Range;

use bumpalo::{Bump, collections::Vec as BumpVec, vec};

use super::aov::{AovIntegrator, Beside};
use super::integrator::{Line, Outgoing, Path};
use crate::compile::Scene;
use crate::film::sums::{self, Quad};
use crate::simd::{Bits, Eights, LANES, MOST, Real, Vector3, f32x8, transpose};

/// The layers of a scene, and room for those of one group.
pub(super) struct Layers<'a> {
    aovs: AovIntegrator,
    /// Channels before the first layer.
    first: usize,
    /// Eight pixels' rows of the film, a register a number, for each eight of a group. Light is 0 in them, and what is
    /// behind the channels stays as it is.
    values: [BumpVec<'a, f32x8>; MOST / LANES],
    /// In a row of the film.
    quads: usize,
}

impl<'a> Layers<'a> {
    /// Layers that are these channels of the picture, the last ones.
    pub(super) fn new(arena: &'a Bump, scene: &Scene, channels: Range<usize>) -> Self {
        let quads = sums::quads(channels.end);
        let values = std::array::from_fn(|_| {
            let mut values = vec![in arena; f32x8::zero(); 4 * quads];
            values[channels.end] = f32x8::one();
            values
        });
        Self { aovs: AovIntegrator::new(scene.aovs.clone()), first: channels.start, values, quads }
    }

    /// Puts what `say` says of a group, which is every channel, into the rows of its pixels.
    #[inline]
    pub(super) fn put<R: Eights>(
        &mut self,
        pixels: R::Bits,
        rows: &mut [Quad],
        say: impl FnOnce(&AovIntegrator, &mut Beside<'_, Lanes<'_, 'a>>),
    ) {
        say(&self.aovs, &mut Beside { out: &mut Lanes(&mut self.values), first: self.first });
        let rows = rows.as_flattened_mut();
        for (i, values) in self.values.iter().enumerate().take(R::LANES / LANES) {
            let pixels: [usize; LANES] = std::array::from_fn(|lane| pixels.lane(i * LANES + lane) as usize);
            let (eights, four) = values.as_chunks::<LANES>();
            // Lanes behind the last of a group say what it says.
            for (k, eight) in eights.iter().enumerate() {
                for (numbers, pixel) in transpose(*eight).iter().zip(pixels) {
                    let place = 4 * self.quads * pixel + LANES * k;
                    rows[place..][..LANES].copy_from_slice(&numbers.to_array());
                }
            }
            for four in four.as_chunks::<4>().0 {
                let eight = std::array::from_fn(|k| if k < 4 { four[k] } else { f32x8::zero() });
                for (numbers, pixel) in transpose(eight).iter().zip(pixels) {
                    let place = 4 * self.quads * pixel + LANES * eights.len();
                    rows[place..][..4].copy_from_slice(&numbers.half(0));
                }
            }
        }
    }
}

/// A register a channel, for each eight of a group.
pub(super) struct Lanes<'v, 'a>(&'v mut [BumpVec<'a, f32x8>; MOST / LANES]);

impl<R: Eights> Outgoing<R> for Lanes<'_, '_> {
    /// A sum of one, as everything else that a pixel has: −0 is 0.
    #[inline]
    fn add(&mut self, channel: usize, value: R) {
        for (i, values) in self.0.iter_mut().enumerate().take(R::LANES / LANES) {
            values[channel] = f32x8::zero() + value.eight(i);
        }
    }

    fn shadow(&mut self, _: usize, _: R::Mask, _: (Vector3<R>, Vector3<R>, R), _: Vector3<R>) {}

    fn next(&mut self, _: usize, _: R::Mask, _: Line<R>, _: &Path<R>) {}
}
