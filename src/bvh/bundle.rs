//! Sixty-four rays as four bundles of sixteen.
//!
//! Rays that come as squares of eight by eight, row by row, are dealt out to bundles of four by four: what
//! encloses a square is smaller than what encloses two rows of eight.

use super::{HitLanes, Hitx8, Hitx16, run::RUN};
use crate::geometry::{Rayx8, Rayx16};
use crate::simd::{LANES, Real, Vector3, f32x8, f32x16, u32x8};

/// Rays in a bundle: two packets.
pub(super) const BUNDLE: usize = 2 * LANES;

/// Which ray is where. Places count bundle by bundle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Grouping {
    /// In their order.
    Rows,
    /// Four of a row, four of the next, and so on.
    Squares,
}

impl Grouping {
    /// Squares, if the first ray is nearer to the first of the next eight than to the fifth; `self` is how
    /// these are grouped.
    pub(super) fn better(self, bundles: &[Rayx16]) -> Self {
        let steps = |v: fn(&Rayx16) -> &Vector3<f32x16>| {
            let [first, along, across] = [0, 4, 8].map(|ray| {
                let place = self.place(ray);
                v(&bundles[place / BUNDLE]).lane(place % BUNDLE)
            });
            ((along - first).length_squared(), (across - first).length_squared())
        };
        let (dir, org) = (steps(|ray| &ray.dir), steps(|ray| &ray.org));
        let nearer = dir.1 <= dir.0 && org.1 <= org.0 && dir.1 + org.1 < dir.0 + org.0;
        if nearer { Self::Squares } else { Self::Rows }
    }

    /// The number of the ray at a place.
    #[inline]
    pub(super) fn ray(self, place: usize) -> usize {
        match self {
            Self::Rows => place,
            Self::Squares => place & 0b10_0011 | place >> 2 & 0b100 | place << 1 & 0b1_1000,
        }
    }

    /// The place of a ray.
    #[inline]
    pub(super) fn place(self, ray: usize) -> usize {
        match self {
            Self::Rows => ray,
            Self::Squares => ray & 0b10_0011 | ray << 2 & 0b1_0000 | ray >> 1 & 0b1100,
        }
    }

    /// Bits of places as bits of rays.
    #[inline]
    pub(super) fn in_order(self, places: u64) -> u64 {
        match self {
            Self::Rows => places,
            // Four places stay together: sixteen nibbles.
            Self::Squares => {
                (0..RUN).step_by(4).fold(0, |rays, ray| rays | (places >> self.place(ray) & 0xf) << ray)
            }
        }
    }

    /// Puts eight rays, the first of which has this number, into their places.
    #[inline(always)]
    pub(super) fn put(self, rays: &Rayx8, first: usize, bundles: &mut [Rayx16]) {
        for half in 0..2 {
            let place = self.place(first + half * 4);
            bundles[place / BUNDLE].put_quarter(place % BUNDLE / 4, rays, half);
        }
    }

    /// The hits of eight rays, the first of which has this number.
    #[inline(always)]
    pub(super) fn hits(self, first: usize, bundles: &[Hitx16]) -> Hitx8 {
        let [low, high] = [0, 4].map(|ray| self.place(first + ray));
        let (low, high) =
            ((&bundles[low / BUNDLE], low % BUNDLE / 4), (&bundles[high / BUNDLE], high % BUNDLE / 4));
        let of = |component: fn(&Hitx16) -> &f32x16| {
            f32x8::of_halves(component(low.0).quarter(low.1), component(high.0).quarter(high.1))
        };
        let (low_id, high_id) = (low.0.primitive.quarter(low.1), high.0.primitive.quarter(high.1));
        HitLanes {
            t: of(|hit| &hit.t),
            u: of(|hit| &hit.u),
            v: of(|hit| &hit.v),
            primitive: u32x8::of_halves(low_id, high_id),
        }
    }
}

impl Hitx16 {
    /// The hits of one of its packets.
    #[inline(always)]
    pub fn half(&self, i: usize) -> Hitx8 {
        let primitive = self.primitive.half(i);
        HitLanes { t: self.t.half(i), u: self.u.half(i), v: self.v.half(i), primitive }
    }

    /// Replaces the hits of one of its packets.
    #[inline(always)]
    pub fn put_half(&mut self, i: usize, hits: &Hitx8) {
        self.t.put_half(i, hits.t);
        self.u.put_half(i, hits.u);
        self.v.put_half(i, hits.v);
        self.primitive.put_half(i, hits.primitive);
    }

    /// The hits of its two packets.
    pub fn halves(&self) -> [Hitx8; 2] {
        [self.half(0), self.half(1)]
    }

    /// Two packets' hits.
    pub fn of_halves([low, high]: [Hitx8; 2]) -> Self {
        let id = [low, high].map(|hits| f32x8::from_bits(hits.primitive));
        Self {
            t: f32x16::of_halves([low.t, high.t]),
            u: f32x16::of_halves([low.u, high.u]),
            v: f32x16::of_halves([low.v, high.v]),
            primitive: f32x16::of_halves(id).to_bits(),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geometry::{Ray, RayLanes};
    use crate::simd::{Mask, Mask8};

    /// Rays of an 8 × 8 square, and where they are in both groupings.
    #[test]
    fn a_ray_is_found_where_it_was_put() {
        let nothing = RayLanes::splat(&Ray::new(Vec3::ZERO, Vec3::ONE, 0.0, 1.0));
        for grouping in [Grouping::Rows, Grouping::Squares] {
            let mut bundles = [nothing; 4];
            let mut hits = [Hitx16::nothing(f32x16::zero()); 4];
            for first in (0..RUN).step_by(LANES) {
                let number = f32x8::from_fn(|i| (first + i) as f32);
                let zero = Vector3::zero();
                let rays = RayLanes::new(Vector3 { x: number, ..zero }, zero, number, number);
                grouping.put(&rays, first, &mut bundles);
            }
            for (bundle, hit) in bundles.iter().zip(&mut hits) {
                hit.t = bundle.org.x;
                hit.primitive = bundle.t_far.to_bits();
            }
            for ray in 0..RUN {
                let place = grouping.place(ray);
                assert_eq!(grouping.ray(place), ray);
                assert_eq!(bundles[place / BUNDLE].t_near.lane(place % BUNDLE), ray as f32);
                assert_eq!(grouping.in_order(1 << place), 1 << ray);
                let (x, y) = (ray % 8, ray / 8);
                let square = (y / 4 * 2 + x / 4, y % 4 * 4 + x % 4);
                let want = if grouping == Grouping::Squares { square } else { (ray / BUNDLE, ray % BUNDLE) };
                assert_eq!((place / BUNDLE, place % BUNDLE), want);
            }
            for first in (0..RUN).step_by(LANES) {
                let row = grouping.hits(first, &hits).or_miss(Mask8::splat(true));
                for i in 0..LANES {
                    assert_eq!(row.t.lane(i), (first + i) as f32);
                    assert_eq!(f32x8::from_bits(row.primitive).lane(i), (first + i) as f32);
                }
            }
            for hit in &hits {
                let again = Hitx16::of_halves(hit.halves());
                assert_eq!(again.t.to_array(), hit.t.to_array());
            }
        }
    }

    #[test]
    fn squares_are_seen_in_directions_and_in_origins() {
        // Rows of eight one beside the other, or sixty-four in one line.
        for (width, want) in [(8, Grouping::Squares), (64, Grouping::Rows)] {
            for moving in [false, true] {
                for now in [Grouping::Rows, Grouping::Squares] {
                    let mut bundles = [RayLanes::splat(&Ray::new(Vec3::ZERO, Vec3::ONE, 0.0, 1.0)); 4];
                    for first in (0..RUN).step_by(LANES) {
                        let at = |i: usize| {
                            Vec3::new(((first + i) % width) as f32, ((first + i) / width) as f32, 9.0)
                        };
                        let at = Vector3::from_fn(at);
                        let still = Vector3::splat(Vec3::Z);
                        let (org, dir) = if moving { (at, still) } else { (still, at) };
                        now.put(&RayLanes::new(org, dir, f32x8::zero(), f32x8::one()), first, &mut bundles);
                    }
                    assert_eq!(now.better(&bundles), want);
                }
            }
        }
    }
}
