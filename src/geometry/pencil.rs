//! Rays through one point against the edges of a triangle: a test that only culls.
//!
//! The planes through an origin and the three edges of a triangle have the normals U = e₂ × s, V = s × e₁
//! and W = e₂ × e₁ − U − V, with s = org − v₀. A ray from that origin has the barycentric coordinates
//! u : v : w = dir·U : dir·V : dir·W \[MT97\], so one that hits the triangle has no two of these products
//! with different signs. If over a whole box of directions one of them is positive and another negative,
//! none of its rays hits.
//!
//! Both sides are rounded, so "positive" means beyond [`EdgePlanes::margin`], which bounds what the kernel
//! and this test can differ by.

use glam::Vec3;

use super::{Aspect, triangle::roundings};
use crate::simd::{LANES, Mask16, Real, Vec3x8, Vec3x16, f32x8, f32x16};

/// Roundings, in ulps of |dir|·(|s|·(|e₁| + |e₂|) + |e₁|·|e₂|): the kernel's products take part with at
/// most 10 each, these with as many, and the middle and the radius of the directions with 4.
const ULPS: f32 = 48.0 * f32::EPSILON;
/// Against products that underflow.
const LEAST: f32 = 1e-34;
/// A component whose reciprocal overflows is taken for 0: directions count as no shorter than what that is a rounding of.
const SHORTEST: f32 = 1e-32;
/// Beyond this margin the products themselves may overflow, and say nothing.
const GREATEST: f32 = 1e31;

/// Boxes of directions from one origin, one a lane.
#[derive(Clone, Copy, Debug)]
pub struct Pencils {
    org: Vec3,
    /// Do the rays point into the negative direction of an axis?
    negative: [bool; 3],
    middle: Vec3x16,
    radius: Vec3x16,
    /// Greatest |x| + |y| + |z| of a direction.
    length: f32x16,
    /// That of all.
    longest: f32,
    /// What all of them have to do with the margins of triangles.
    rounding: Vec3,
}

impl Pencils {
    /// Directions between two corners, which may be off by an ulp or two, into one octant.
    #[inline]
    pub fn new(org: Vec3, negative: [bool; 3], low: Vec3x16, high: Vec3x16) -> Self {
        let half = f32x16::splat(0.5);
        let greatest = low.abs().max(high.abs());
        let length = greatest.element_sum().max(f32x16::splat(SHORTEST));
        Self {
            org,
            negative,
            middle: low.scale(half) + high.scale(half),
            radius: (high - low).scale(half),
            length,
            longest: length.reduce_max(),
            rounding: roundings(greatest).map(f32x16::reduce_max).into(),
        }
    }

    /// What the directions have to do with [margins](Aspect::margin_towards), by components.
    #[inline]
    pub fn rounding(&self) -> Vec3 {
        self.rounding
    }

    /// The origin.
    #[inline]
    pub fn org(&self) -> Vec3 {
        self.org
    }

    /// Whether the rays point into the negative direction of each axis.
    #[inline]
    pub fn negative(&self) -> [bool; 3] {
        self.negative
    }

    /// Which pencils may hold a ray that hits the triangle in a lane of the planes.
    #[inline]
    pub fn meet(&self, planes: &EdgePlanes, lane: usize) -> Mask16 {
        let margin = f32x16::splat(planes.margin[lane]).fused(self.length, f32x16::splat(LEAST));
        let along = |plane: &[[f32; LANES]; 3]| {
            let [x, y, z] = [0, 1, 2].map(|axis| f32x16::splat(plane[axis][lane]));
            let middle = self.middle.z.fused(z, self.middle.y.fused(y, self.middle.x * x));
            let radius = self.radius.z.fused(z.abs(), self.radius.y.fused(y.abs(), self.radius.x * x.abs()));
            (middle - radius, middle + radius)
        };
        let [u, v, w] = [along(&planes.u), along(&planes.v), along(&planes.w)];
        let negative = u.1.min(v.1).min(w.1).lt(-margin);
        let positive = margin.lt(u.0.max(v.0).max(w.0));
        !(negative & positive)
    }
}

/// The planes through an origin and the edges of eight triangles, in columns: a lane is read from memory.
#[derive(Clone, Copy, Debug)]
pub struct EdgePlanes {
    u: [[f32; LANES]; 3],
    v: [[f32; LANES]; 3],
    w: [[f32; LANES]; 3],
    /// Bound on the rounding of a product with a direction, for each unit of its length.
    margin: [f32; LANES],
}

impl Aspect<f32x8> {
    /// The planes through the edges and the pencils' origin.
    #[inline]
    pub fn edge_planes(&self, pencils: &Pencils) -> EdgePlanes {
        let size = |v: Vec3x8| v.abs().element_sum();
        let (e1, e2) = (self.e1, self.e2);
        let (u, v) = (e2.cross(self.s), self.q);
        let w = e2.cross(e1) - u - v;
        let (e1, e2) = (size(e1), size(e2));
        let margin = f32x8::splat(ULPS) * (size(self.s) * (e1 + e2) + e1 * e2) + f32x8::splat(LEAST);
        let holds = (margin * f32x8::splat(pencils.longest)).lt(f32x8::splat(GREATEST));
        let margin = f32x8::select(holds, margin, f32x8::splat(f32::INFINITY));
        let columns = |v: Vec3x8| [v.x.to_array(), v.y.to_array(), v.z.to_array()];
        EdgePlanes { u: columns(u), v: columns(v), w: columns(w), margin: margin.to_array() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Ray, Triangle, TriangleLanes, seeds::Random};
    use super::*;
    use crate::simd::Mask;

    /// Sixteen pencils around eight rays each, from one origin, towards the edges of a triangle.
    #[test]
    fn no_ray_that_hits_is_culled() {
        let mut random = Random::new(29);
        let (mut hits, mut culled) = (0, 0);
        for round in 0..40_000 {
            let scale = [1.0, 1e-4, 1e4, 1e-12, 1e9][round % 5];
            let grid = round % 3 == 0;
            let mut point = || if grid { random.grid() } else { random.vector() };
            let [v0, v1, v2, org] = std::array::from_fn(|_| point() * scale);
            let triangle = Triangle::new(v0, v1, v2);
            let spread = [0.0, 1e-6, 1e-2, 0.5][round % 4];
            let mut low = [Vec3::INFINITY; 16];
            let mut high = [Vec3::NEG_INFINITY; 16];
            let mut hit = [false; 16];
            for lane in 0..16 {
                // Around a corner, a point of an edge, the inside or the outside.
                let (u, v) = [(0.0, 0.0), (0.5, 0.5), (0.3, 0.3), (0.7, 0.0), (-0.4, 0.2), (0.9, 0.8)]
                    [random.below(6) as usize];
                let target = v0 + triangle.e1() * u + triangle.e2() * v - org;
                for _ in 0..8 {
                    let dir = target + random.vector() * (spread * scale);
                    if dir == Vec3::ZERO {
                        continue;
                    }
                    let ray = Ray::new(org, dir, f32::NEG_INFINITY, f32::INFINITY);
                    (low[lane], high[lane]) = (low[lane].min(dir), high[lane].max(dir));
                    hit[lane] |= triangle.intersect(&ray).is_some();
                }
            }
            let [v0, v1, v2] = [triangle.v0, triangle.v1, triangle.v2].map(Vec3x8::splat);
            let lanes = TriangleLanes { v0, v1, v2, edges: f32x8::splat(triangle.edges()) };
            let pencils =
                Pencils::new(org, [false; 3], Vec3x16::from_fn(|i| low[i]), Vec3x16::from_fn(|i| high[i]));
            let planes = lanes.aspect(Vec3x8::splat(org)).edge_planes(&pencils);
            let meet = pencils.meet(&planes, 5).to_bitmask();
            for (lane, hit) in hit.into_iter().enumerate() {
                hits += u32::from(hit);
                culled += 1 - (meet >> lane & 1);
                assert!(!hit || meet >> lane & 1 != 0, "{triangle:?} from {org} in lane {lane}");
            }
        }
        assert!(hits > 50_000 && culled > 20_000, "{hits} hit, {culled} culled");
    }

    /// Directions that are made of their reciprocals, which overflow where a component is short; and products that do.
    #[test]
    fn no_ray_that_hits_is_culled_at_the_ends_of_the_floats() {
        let mut random = Random::new(37);
        // Length of edges, distance from the triangle, length of directions.
        let shapes = [(1e5, 1e4, 1e-38), (1e6, 1e6, 1e26), (1e12, 1e12, 1e14), (1e-2, 1e-2, 3e38)];
        for (edge, distance, length) in shapes {
            let mut hits = 0;
            for _ in 0..20_000 {
                let [v0, v1, v2] = std::array::from_fn(|_| random.vector() * edge);
                let triangle = Triangle::new(v0, v1, v2);
                // Within the distance of an edge.
                let target = v0 + triangle.e1() * random.signed().abs() + random.vector() * distance * 0.3;
                let dir = random.vector();
                let org = target - dir * distance;
                let dir = dir / dir.abs().max_element() * length;
                let ray = Ray::new(org, dir, f32::NEG_INFINITY, f32::INFINITY);
                if triangle.intersect(&ray).is_some() {
                    hits += 1;
                    let [v0, v1, v2] = [v0, v1, v2].map(Vec3x8::splat);
                    let lanes = TriangleLanes { v0, v1, v2, edges: f32x8::splat(triangle.edges()) };
                    let towards = Vec3x16::splat(ray.rdir.recip());
                    let pencils = Pencils::new(org, [false; 3], towards, towards);
                    let planes = lanes.aspect(Vec3x8::splat(org)).edge_planes(&pencils);
                    assert!(pencils.meet(&planes, 3).all(), "{triangle:?} from {org} along {dir}");
                }
            }
            assert!(hits > 1000, "{hits} hits of edges {edge} long");
        }
    }

    /// Rays at edges and vertices, where products are all rounding: each term of the margin has a row in which it
    /// is the greatest and decides.
    #[test]
    fn the_margin_covers_the_rounding_of_products() {
        // Length of edges, distance of the origin from the first vertex, factor of directions.
        let shapes = [(1e3, 1e6, 1.0), (1e-3, 10.0, 1.0), (1e4, 1.0, 1.0), (1e-17, 1e-17, 1e20)];
        let mut random = Random::new(31);
        for (edge, distance, factor) in shapes {
            let mut hits = 0;
            for _ in 0..4000 {
                let org = random.vector() * distance;
                let v0 = org + random.vector() * distance;
                let triangle = Triangle::new(v0, v0 + random.vector() * edge, v0 + random.vector() * edge);
                let [v0, v1, v2] = [triangle.v0, triangle.v1, triangle.v2].map(Vec3x8::splat);
                let lanes = TriangleLanes { v0, v1, v2, edges: f32x8::splat(triangle.edges()) };
                let aspect = lanes.aspect(Vec3x8::splat(org));
                let along = 0.5 + 0.5 * random.signed();
                for (u, v) in [(0.0, 0.0), (1.0, 0.0), (along, 0.0), (0.0, along), (along, 1.0 - along)] {
                    let dir = (triangle.v0 + triangle.e1() * u + triangle.e2() * v - org) * factor;
                    let ray = Ray::new(org, dir, f32::NEG_INFINITY, f32::INFINITY);
                    if dir != Vec3::ZERO && triangle.intersect(&ray).is_some() {
                        hits += 1;
                        let pencils = Pencils::new(org, [false; 3], Vec3x16::splat(dir), Vec3x16::splat(dir));
                        let planes = aspect.edge_planes(&pencils);
                        assert!(pencils.meet(&planes, 3).all(), "{triangle:?} from {org} along {dir}");
                    }
                }
            }
            assert!(hits > 4000, "{hits} hits of edges {edge} long");
        }
    }
}
