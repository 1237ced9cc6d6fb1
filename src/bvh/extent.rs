//! Bounds on the rays of a run, taken once: to see how far they spread, and for the beams of a tile.

use glam::Vec3;

use super::{bundle::BUNDLE, run::BUNDLES};
use crate::geometry::Rayx16;
use crate::simd::{Mask, Mask16, Real, f32x8, f32x16, transpose};

/// Least and greatest of a quantity in each bundle.
pub(super) type Range = ([f32; BUNDLES], [f32; BUNDLES]);

/// Bounds on whole bundles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    /// Origins, axis by axis.
    pub(super) org: [Range; 3],
    /// Reciprocal directions.
    pub(super) rdir: [Range; 3],
    /// Least lower end of all.
    pub(super) t_near: f32,
}

impl Extent {
    /// `None` if the first bundle already points into several octants: most that do are found so.
    pub(super) fn of(bundles: &[Rayx16; BUNDLES]) -> Option<Self> {
        let rdir = bundles[0].rdir;
        for rdir in [rdir.x, rdir.y, rdir.z] {
            let negative = rdir.lt(f32x16::zero());
            if negative.any() && (!negative).any() {
                return None;
            }
        }
        let org = match origin(bundles) {
            Some(org) => org.to_array().map(|x| ([x; BUNDLES], [x; BUNDLES])),
            None => [
                range(bundles, |rays| &rays.org.x),
                range(bundles, |rays| &rays.org.y),
                range(bundles, |rays| &rays.org.z),
            ],
        };
        let rdir = [
            range(bundles, |rays| &rays.rdir.x),
            range(bundles, |rays| &rays.rdir.y),
            range(bundles, |rays| &rays.rdir.z),
        ];
        let [one, two, three, four] = bundles.each_ref().map(|rays| rays.t_near);
        Some(Self { org, rdir, t_near: one.min(two).min(three.min(four)).reduce_min() })
    }

    /// The diagonal of the box around the directions, in lengths of its middle; `None` if they point into several
    /// octants.
    pub(super) fn spread(&self) -> Option<f32> {
        let mut least = [1.0; 8];
        let mut greatest = [1.0; 8];
        for (axis, (low, high)) in self.rdir.iter().enumerate() {
            least[axis] = low.iter().copied().fold(f32::INFINITY, Real::min);
            greatest[axis] = high.iter().copied().fold(f32::NEG_INFINITY, Real::max);
            if !(least[axis] >= 0.0 || greatest[axis] < 0.0) {
                return None;
            }
        }
        // With one sign, least and greatest are each other's reciprocals.
        let [[lx, ly, lz, ..], [hx, hy, hz, ..]] =
            [greatest, least].map(|r| (f32x8::one() / f32x8::new(r)).to_array());
        Some(diagonal([(lx, hx), (ly, hy), (lz, hz)]))
    }
}

/// The diagonal of a box of directions, from its sides along the axes, in lengths of its middle.
pub(super) fn diagonal(sides: [(f32, f32); 3]) -> f32 {
    let (mut diagonal, mut length) = (0.0, 0.0);
    for (low, high) in sides {
        diagonal += (high - low) * (high - low);
        length += (high + low) * (high + low) * 0.25;
    }
    (diagonal / length).sqrt()
}

/// Where all rays start, if that is one point.
fn origin(bundles: &[Rayx16; BUNDLES]) -> Option<Vec3> {
    let first = bundles[0].org.lane(0);
    let [x, y, z] = first.to_array().map(f32x16::splat);
    let same = bundles.iter().fold(Mask16::splat(true), |same, rays| {
        same & x.equal(rays.org.x) & y.equal(rays.org.y) & z.equal(rays.org.z)
    });
    (same.count() as usize == BUNDLE).then_some(first)
}

/// Of each bundle's sixteen. Transposed, a bundle is a lane, and what was a reduction is an operation for all: the
/// lower lanes take the least, the upper ones the least of the negated.
#[inline]
fn range(bundles: &[Rayx16; BUNDLES], of: impl Fn(&Rayx16) -> &f32x16) -> Range {
    let halves = bundles.each_ref().map(|rays| of(rays).halves());
    let [a, b, c, d] = halves.map(|[one, other]| one.min(other));
    let [e, f, g, h] = halves.map(|[one, other]| -one.max(other));
    let least = transpose([a, b, c, d, e, f, g, h]).into_iter().reduce(Real::min).unwrap_or_default();
    (least.half(0), (-least).half(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Ray, RayLanes, seeds::Random};
    use crate::simd::Vector3;

    fn rays(mut ray: impl FnMut(usize) -> Ray) -> [Rayx16; BUNDLES] {
        std::array::from_fn(|bundle| {
            let rays: [Ray; BUNDLE] = std::array::from_fn(|lane| ray(bundle * BUNDLE + lane));
            RayLanes::new(
                Vector3::from_fn(|i| rays[i].org),
                Vector3::from_fn(|i| rays[i].dir),
                f32x16::from_fn(|i| rays[i].t_near),
                f32x16::from_fn(|i| rays[i].t_far),
            )
        })
    }

    #[test]
    fn bounds_are_those_of_the_rays() {
        let mut random = Random::new(41);
        for round in 0..500 {
            let still = round % 2 == 0;
            let place = random.vector();
            // The last bundle points anywhere, the first one into one octant.
            let bundles = rays(|i| {
                let org = if still { place } else { random.vector() };
                let dir = random.vector();
                Ray::new(org, if i < 48 { dir.abs() } else { dir }, random.signed(), 9.0)
            });
            let extent = Extent::of(&bundles).expect("a first bundle in one octant");
            let mut t_near = f32::INFINITY;
            for (i, rays) in bundles.iter().enumerate() {
                for axis in 0..3 {
                    for (of, range) in [
                        ([rays.org.x, rays.org.y, rays.org.z][axis], extent.org[axis]),
                        ([rays.rdir.x, rays.rdir.y, rays.rdir.z][axis], extent.rdir[axis]),
                    ] {
                        let lanes = of.to_array();
                        assert_eq!(range.0[i], lanes.into_iter().fold(f32::INFINITY, f32::min));
                        assert_eq!(range.1[i], lanes.into_iter().fold(f32::NEG_INFINITY, f32::max));
                    }
                }
                t_near = rays.t_near.to_array().into_iter().fold(t_near, f32::min);
            }
            assert_eq!(extent.t_near, t_near);
        }
    }

    #[test]
    fn spread_is_the_diagonal_of_the_directions() {
        let towards = |i: usize| Vec3::new(-2.0 - (i % 8) as f32 / 7.0, 0.0, 3.0 + (i / 8) as f32 / 7.0);
        let spread = |towards: &dyn Fn(usize) -> Vec3| {
            Extent::of(&rays(|i| Ray::new(Vec3::ZERO, towards(i), 0.0, 1.0)))?.spread()
        };
        let one_octant = spread(&towards).unwrap_or_default();
        assert!((one_octant - (2.0 / (2.5 * 2.5 + 3.5 * 3.5)).sqrt()).abs() < 1e-5, "{one_octant}");
        // One of sixty-four points elsewhere, or is the other zero: the first, or the last.
        for other in [Vec3::ONE, Vec3::new(-2.0, -0.0, 3.0)] {
            for which in [0, 63] {
                assert!(spread(&|i| if i == which { other } else { towards(i) }).is_none());
            }
        }
    }
}
