//! What the camera sees besides light, of a group of paths at a time, on its way to their pixels.
//!
//! It is said once a pixel, in the first round, when no path has been sorted away from its pixel yet. So it
//! goes straight to what the pixel has, row by row of eight channels, and never through what rounds add up. Its rows are its
//! own: those of light are met by each round, and are the shorter without it.

use std::ops::Range;

use bumpalo::{Bump, collections::Vec as BumpVec, vec};

use super::aov::{AovIntegrator, Beside};
use super::integrator::{Line, Outgoing, Path};
use crate::compile::Scene;
use crate::film::sums::{self, Quad};
use crate::simd::{Bits, Eights, LANES, MOST, Real, Vector3, f32x8, transpose};

/// The layers of a scene, what they say of all pixels, and room for those of one group.
pub(super) struct Layers<'a> {
    aovs: AovIntegrator,
    /// Channels before the first layer.
    first: usize,
    /// Eight pixels' rows of the film, a register a number, for each eight of a group. What is not of layers stays as it is.
    values: BumpVec<'a, Lanes>,
    /// What is in the film's rows behind the quads that light has, pixel after pixel.
    rows: BumpVec<'a, f32x8>,
    /// In a row of these.
    eights: usize,
    /// In a row of light.
    quads: usize,
}

/// A number of each of a group's pixels.
type Lanes = [f32x8; MOST / LANES];

impl<'a> Layers<'a> {
    /// Layers that are these channels of the picture, the last ones.
    pub(super) fn new(arena: &'a Bump, scene: &Scene, channels: Range<usize>) -> Self {
        let quads = sums::quads(channels.start);
        let eights = (sums::quads(channels.end) - quads).div_ceil(2);
        let mut values = vec![in arena; [f32x8::zero(); MOST / LANES]; 4 * quads + LANES * eights];
        values[sums::WEIGHT] = [f32x8::one(); MOST / LANES];
        let aovs = AovIntegrator::new(scene.aovs.clone());
        Self { aovs, first: channels.start, values, rows: BumpVec::new_in(arena), eights, quads }
    }

    /// Do any of them need random numbers?
    #[inline]
    pub(super) fn draws(&self) -> bool {
        self.aovs.draws
    }

    /// Room for so many pixels. What is there stays, until something is said of them: nothing, if nobody ever does.
    pub(super) fn reserve(&mut self, len: usize) {
        self.rows.resize(len * self.eights, f32x8::zero());
    }

    /// Of these pixels.
    #[inline]
    pub(super) fn rows(&self, pixels: Range<usize>) -> &[f32x8] {
        &self.rows[pixels.start * self.eights..pixels.end * self.eights]
    }

    /// Puts what `say` says of a group, which is every channel, into the rows of its pixels.
    #[inline]
    pub(super) fn put<R: Eights>(
        &mut self,
        pixels: R::Bits,
        light: &mut [Quad],
        say: impl FnOnce(&AovIntegrator, &mut Beside<'_, Said<'_>>),
    ) {
        say(&self.aovs, &mut Beside { out: &mut Said(&mut self.values), first: self.first });
        for i in 0..R::LANES / LANES {
            // Lanes behind the last of a group say what it says.
            let pixels = std::array::from_fn(|lane| pixels.lane(i * LANES + lane));
            self.place(i, pixels, light);
        }
    }

    /// Puts one eight of a group into the rows of its pixels.
    #[inline]
    fn place(&mut self, i: usize, pixels: [u32; LANES], light: &mut [Quad]) {
        let (shared, own) = self.values.split_at(4 * self.quads);
        for (at, lanes) in shared.iter().enumerate().skip(sums::place(self.first)) {
            for (value, pixel) in lanes[i].to_array().into_iter().zip(pixels) {
                light[pixel as usize * self.quads + at / 4][at % 4] = value;
            }
        }
        for (k, eight) in own.as_chunks::<LANES>().0.iter().enumerate() {
            for (numbers, pixel) in transpose(eight.map(|lanes| lanes[i])).into_iter().zip(pixels) {
                self.rows[pixel as usize * self.eights + k] = numbers;
            }
        }
    }
}

/// What is said of a group, number by number.
pub(super) struct Said<'v>(&'v mut [Lanes]);

impl<R: Eights> Outgoing<R> for Said<'_> {
    /// A sum of one, as everything else that a pixel has: −0 is 0.
    #[inline]
    fn add(&mut self, channel: usize, value: R) {
        let value = R::zero() + value;
        let lanes = &mut self.0[sums::place(channel)];
        for (i, lanes) in lanes.iter_mut().enumerate().take(R::LANES / LANES) {
            *lanes = value.eight(i);
        }
    }

    fn shadow(&mut self, _: usize, _: R::Mask, _: (Vector3<R>, Vector3<R>, R), _: Vector3<R>) {}

    fn next(&mut self, _: usize, _: R::Mask, _: Line<R>, _: &Path<R>) {}
}
