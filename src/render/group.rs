//! What a group says while it is shaded: light, shadow rays, and how its paths go on.

use bumpalo::collections::Vec as BumpVec;

use super::census::Ends;
use super::connections::Connections;
use super::integrator::{End, Outgoing, Path};
use super::rows::{Packet, Paths, reserve};
use crate::film::sums::{Quad, place};
use crate::simd::{Eights, LANES, MOST, Mask, Real, Vector3, f32x8, transpose, u32x8};

/// What the groups of a round have said, by slot.
pub(super) struct Outputs<'a> {
    /// The integrator's channels are so many quads of a row, in which nothing is said where the weight is.
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

/// A group of at most as many slots as `R` has lanes that is being shaded.
pub(super) struct Group<'g, 'a, R: Eights> {
    pub(super) slots: [u32; MOST],
    pub(super) count: usize,
    pub(super) pixel: R::Bits,
    pub(super) out: &'g mut Outputs<'a>,
    pub(super) ends: Option<&'g mut Ends>,
}

impl<R: Eights> Outgoing<R> for Group<'_, '_, R> {
    #[inline]
    fn add(&mut self, channel: usize, value: R) {
        // Most surfaces don't shine.
        if (!value.equal(R::zero())).none() {
            return;
        }
        let at = place(channel);
        for (i, &slot) in self.slots[..self.count].iter().enumerate() {
            self.out.added[slot as usize * self.out.quads + at / 4][at % 4] = value.lane(i);
        }
    }

    #[inline]
    fn add_rgb(&mut self, color: Vector3<R>) {
        let dark = [color.x, color.y, color.z].map(|c| c.equal(R::zero()));
        if (!(dark[0] & dark[1] & dark[2])).none() {
            return;
        }
        let quads = self.out.quads;
        for (i, slots) in self.slots[..self.count].chunks(LANES).enumerate() {
            let ([r, g, b], zero) = ([color.x, color.y, color.z].map(|c| c.eight(i)), f32x8::zero());
            let rows = transpose([r, g, b, zero, zero, zero, zero, zero]);
            for (row, &slot) in rows.iter().zip(slots) {
                self.out.added[slot as usize * quads][..3].copy_from_slice(&row.to_array()[..3]);
            }
        }
    }

    #[inline]
    fn shadow(
        &mut self,
        _: usize,
        lanes: R::Mask,
        (org, dir, t_far): (Vector3<R>, Vector3<R>, R),
        radiance: Vector3<R>,
    ) {
        let lanes = lanes.to_bitmask() & ((1 << self.count) - 1);
        for (i, slots) in self.slots.as_chunks::<LANES>().0.iter().enumerate().take(R::LANES / LANES) {
            let lanes = lanes >> (i * LANES) & 0xff;
            if lanes != 0 {
                let [org, dir, radiance] = [org, dir, radiance].map(|v| v.map(|v| v.eight(i)));
                let ray = (org, dir, t_far.eight(i));
                self.out.connections.push(lanes, ray, radiance, u32x8::new(*slots));
            }
        }
    }

    #[inline]
    fn next(&mut self, index: usize, lanes: R::Mask, (org, dir): (Vector3<R>, Vector3<R>), path: &Path<R>) {
        let lanes = lanes.to_bitmask();
        if lanes == 0 {
            return;
        }
        let branches = self.out.branches as u32;
        let at: [u32; MOST] = std::array::from_fn(|i| self.slots[i] * branches + index as u32);
        let packet = Packet { org, dir, t_far: R::splat(f32::INFINITY), path: *path, pixel: self.pixel };
        // Rows of paths that end here are written too, and left where they are.
        self.out.next.store(&at[..self.count], &packet);
        for (i, &at) in at[..self.count].iter().enumerate() {
            self.out.alive[at as usize] = lanes >> i & 1 != 0;
        }
    }

    #[inline]
    fn end(&mut self, why: End, lanes: R::Mask) {
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
    use crate::simd::{Bits, Mask8, Vec3x8, vector3};

    #[test]
    fn lanes_beyond_the_count_say_nothing() {
        let arena = Bump::new();
        let mut out = Outputs {
            quads: 2,
            added: BumpVec::new_in(&arena),
            connections: Connections::new(&arena),
            next: Paths::new(&arena),
            alive: BumpVec::new_in(&arena),
            branches: 1,
        };
        out.clear(16, 1);
        let all = Mask8::splat(true);
        let (zero, one) = (Vec3x8::zero(), f32x8::splat(1.0));
        let mut group = Group::<f32x8> {
            slots: fill(&[3, 9]),
            count: 2,
            pixel: u32x8::splat(7),
            out: &mut out,
            ends: None,
        };
        group.add(3, one);
        group.add_rgb(vector3(zero.x, f32x8::from_fn(|i| i as f32), one));
        group.shadow(0, all, (zero, zero, one), zero);
        group.next(0, all, (zero, zero), &Path::start(u32x8::splat(1), u32x8::splat(0)));
        let rows = out.added.as_chunks::<2>().0;
        let said: Vec<usize> = (0..16).filter(|&slot| rows[slot] != [[0.0; 4]; 2]).collect();
        assert_eq!(said, [3, 9]);
        // The fourth channel is behind the weight's place.
        let fourth = [1.0, 0.0, 0.0, 0.0];
        assert_eq!((rows[3], rows[9]), ([[0.0, 0.0, 1.0, 0.0], fourth], [[0.0, 1.0, 1.0, 0.0], fourth]));
        assert_eq!(out.connections.len, 2);
        let alive: Vec<usize> = (0..16).filter(|&slot| out.alive[slot]).collect();
        assert_eq!(alive, [3, 9]);
        out.next.keep(&out.alive);
        assert_eq!((out.next.len, out.next.pixel(1)), (2, 7));
    }
}
