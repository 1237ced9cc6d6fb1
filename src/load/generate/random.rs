//! Random numbers for meshes: a counter through splitmix64.

use std::f32::consts::TAU;

use glam::{Vec3, vec3};

/// One step of splitmix64 (Steele, Lea & Flood 2014): a bijection that leaves no pattern.
pub(super) fn scramble(word: u64) -> u64 {
    let z = word.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The top 24 bits as a number in [0, 1): every step is exact.
pub(super) fn fraction(word: u64) -> f32 {
    (word >> 40) as f32 / 16_777_216.0
}

/// A stream of numbers.
pub(super) struct Stream {
    counter: u64,
}

impl Stream {
    pub(super) fn seeded(seed: u64) -> Self {
        Self { counter: scramble(seed) }
    }

    /// In [0, 1).
    pub(super) fn number(&mut self) -> f32 {
        self.counter = self.counter.wrapping_add(1);
        fraction(scramble(self.counter))
    }

    /// In the unit cube; x is drawn first.
    pub(super) fn point(&mut self) -> Vec3 {
        let [x, y, z] = std::array::from_fn(|_| self.number());
        vec3(x, y, z)
    }

    /// On the unit sphere; the height is drawn first.
    pub(super) fn direction(&mut self) -> Vec3 {
        let height = 1.0 - 2.0 * self.number();
        let (sin, cos) = (TAU * self.number()).sin_cos();
        let radius = (1.0 - height * height).max(0.0).sqrt();
        vec3(radius * cos, radius * sin, height)
    }
}
