//! What a group of eight says while it is shaded: light, shadow rays, and how its paths go on.

use bumpalo::collections::Vec as BumpVec;

use super::census::Ends;
use super::connections::Connections;
use super::integrator::{End, Outgoing, Path};
use super::rows::{Packet, Paths, reserve};
use crate::film::sums::Quad;
use crate::simd::{LANES, Mask, Mask8, Real, Vec3x8, f32x8, u32x8};

/// What the groups of a round have said, by slot.
pub(super) struct Outputs<'a> {
    /// The integrator's channels are so many quads, the last one padded.
    pub(super) quads: usize,
    /// What the vertex adds, four channels at a time, slot after slot.
    pub(super) added: BumpVec<'a, Quad>,
    pub(super) connections: Connections<'a>,
    pub(super) next: Paths<'a>,
    /// Which of `next` are paths at all. Branches of a slot stand together.
    pub(super) alive: BumpVec<'a, bool>,
    pub(super) branches: usize,
}

impl Outputs<'_> {
    /// Room for what so many slots can say.
    pub(super) fn clear(&mut self, slots: usize, shadows: usize) {
        self.added.clear();
        self.added.resize(slots * self.quads, [0.0; 4]);
        self.connections.clear(slots * shadows);
        self.next.reserve(slots * self.branches);
        reserve(&mut self.alive, slots * self.branches, false);
        self.alive.fill(false);
    }
}

/// A group of at most eight slots that is being shaded.
pub(super) struct Group<'g, 'a> {
    pub(super) slots: [u32; LANES],
    pub(super) count: usize,
    pub(super) pixel: u32x8,
    pub(super) out: &'g mut Outputs<'a>,
    pub(super) ends: Option<&'g mut Ends>,
}

impl Outgoing<f32x8> for Group<'_, '_> {
    #[inline]
    fn add(&mut self, channel: usize, value: f32x8) {
        // Most surfaces don't shine.
        if value.equal(f32x8::zero()).all() {
            return;
        }
        for (&slot, value) in self.slots[..self.count].iter().zip(value.to_array()) {
            self.out.added[slot as usize * self.out.quads + channel / 4][channel % 4] = value;
        }
    }

    #[inline]
    fn shadow(&mut self, _: usize, lanes: Mask8, ray: (Vec3x8, Vec3x8, f32x8), radiance: Vec3x8) {
        let lanes = lanes.to_bitmask() & ((1 << self.count) - 1);
        if lanes == 0 {
            return;
        }
        self.out.connections.push(lanes, ray, radiance, u32x8::new(self.slots));
    }

    #[inline]
    fn next(&mut self, index: usize, lanes: Mask8, (org, dir): (Vec3x8, Vec3x8), path: &Path<f32x8>) {
        let lanes = lanes.to_bitmask();
        if lanes == 0 {
            return;
        }
        let branches = self.out.branches as u32;
        let at: [u32; LANES] = std::array::from_fn(|i| self.slots[i] * branches + index as u32);
        let packet = Packet { org, dir, t_far: f32x8::splat(f32::INFINITY), path: *path, pixel: self.pixel };
        // Rows of paths that end here are written too, and left where they are.
        self.out.next.store(&at[..self.count], &packet);
        for (i, &at) in at[..self.count].iter().enumerate() {
            self.out.alive[at as usize] = lanes >> i & 1 != 0;
        }
    }

    #[inline]
    fn end(&mut self, why: End, lanes: Mask8) {
        if let Some(ends) = &mut self.ends {
            ends.add(why, lanes.to_bitmask() & ((1 << self.count) - 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use bumpalo::Bump;

    use super::super::rows::fill;
    use super::*;
    use crate::simd::Bits;

    #[test]
    fn lanes_beyond_the_count_say_nothing() {
        let arena = Bump::new();
        let mut out = Outputs {
            quads: 1,
            added: BumpVec::new_in(&arena),
            connections: Connections::new(&arena),
            next: Paths::new(&arena),
            alive: BumpVec::new_in(&arena),
            branches: 1,
        };
        out.clear(16, 1);
        let all = Mask8::splat(true);
        let (zero, one) = (Vec3x8::zero(), f32x8::splat(1.0));
        let mut group =
            Group { slots: fill(&[3, 9]), count: 2, pixel: u32x8::splat(7), out: &mut out, ends: None };
        group.add(0, one);
        group.shadow(0, all, (zero, zero, one), zero);
        group.next(0, all, (zero, zero), &Path::start(u32x8::splat(1), 0));
        let said: Vec<usize> = (0..16).filter(|&slot| out.added[slot] != [0.0; 4]).collect();
        assert_eq!(said, [3, 9]);
        assert_eq!(out.connections.len, 2);
        let alive: Vec<usize> = (0..16).filter(|&slot| out.alive[slot]).collect();
        assert_eq!(alive, [3, 9]);
        out.next.keep(&out.alive);
        assert_eq!((out.next.len, out.next.pixel(1)), (2, 7));
    }
}
