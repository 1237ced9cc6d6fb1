//! Numbers that are the same in every run.

use glam::{Vec3, vec3};

/// A small generator (PCG's output step on a counter).
pub(crate) struct Random(u32);

#[allow(dead_code)] // Not every bench draws everything.
impl Random {
    /// A stream of its own.
    pub(crate) fn new(seed: u32) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9))
    }

    /// In [0, 1).
    pub(crate) fn number(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277_803_737);
        ((word >> 22 ^ word) >> 8) as f32 / 16_777_216.0
    }

    /// In the unit cube.
    pub(crate) fn point(&mut self) -> Vec3 {
        vec3(self.number(), self.number(), self.number())
    }

    /// On the unit sphere.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.point() * 2.0 - Vec3::ONE;
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
}
