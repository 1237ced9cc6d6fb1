use glam::DVec3;

use super::*;
use crate::geometry::{
    Rayx8,
    seeds::{Kernel, Random, at_random, in_every_lane, nan_misses, with_ends},
};
use crate::simd::{Mask8, f32x8};

impl Kernel for Triangle {
    fn bounds(&self) -> Aabb {
        self.bounds()
    }

    fn scalar(&self, ray: &Ray) -> Option<[f32; 3]> {
        self.intersect(ray).map(|(t, u, v)| [t, u, v])
    }

    fn lanes(surfaces: &[Self; 8], rays: &Rayx8, active: Mask8) -> Option<(Mask8, [f32x8; 3])> {
        let row = |of: fn(&Self) -> Vec3| Vector3::from_fn(|i| of(&surfaces[i]));
        let triangles = TriangleLanes {
            v0: row(|triangle| triangle.v0),
            v1: row(|triangle| triangle.v1),
            v2: row(|triangle| triangle.v2),
            edges: f32x8::from_fn(|i| surfaces[i].edges()),
        };
        let (hit, t, u, v) = triangles.intersect(rays, active);
        // Whoever answers at once has the same answer.
        let aspect = triangles.aspect(rays.org);
        let margin = aspect.margin(triangles.edges, rays.margin);
        let seen = triangles.intersect_seen(&aspect, margin, rays, active);
        let ahead = triangles.intersect_ahead(&aspect, margin, rays, active);
        for (seen, quick_t, quick_u, quick_v) in [seen, ahead].into_iter().flatten() {
            assert_eq!(seen.to_bitmask(), hit.to_bitmask(), "{surfaces:?} {rays:?}");
            for (quick, all) in [(quick_t, t), (quick_u, u), (quick_v, v)] {
                let bits = |x: f32x8| f32x8::select(hit, x, f32x8::zero()).to_array().map(f32::to_bits);
                assert_eq!(bits(quick), bits(all));
            }
        }
        Some((hit, [t, u, v]))
    }
}

const UNIT: Triangle = Triangle { v0: Vec3::ZERO, v1: Vec3::X, v2: Vec3::Y };

fn ray(org: [f32; 3], dir: [f32; 3]) -> Ray {
    Ray::new(org.into(), dir.into(), 0.0, f32::INFINITY)
}

/// The unit triangle from above: middle, edges, vertices, outside, and the rest of what goes wrong.
fn seeds() -> Vec<(Ray, Triangle)> {
    let down = |x: f32, y: f32| ray([x, y, 1.0], [0.0, 0.0, -1.0]);
    let mut rays = vec![
        down(0.25, 0.25),
        down(0.5, 0.0),
        down(0.0, 0.5),
        down(0.5, 0.5),
        down(0.3, 0.7),
        down(0.0, 0.0),
        down(1.0, 0.0),
        down(0.0, 1.0),
        down(-0.0, -0.0),
        down(1.1, 0.1),
        down(-0.1, 0.5),
        down(0.5, -1e-30),
        down(0.5_f32.next_up(), 0.5),
        // From below, behind, on the plane, skew, along the plane, in it.
        ray([0.25, 0.25, -1.0], [0.0, 0.0, 1.0]),
        ray([0.25, 0.25, 1.0], [0.0, 0.0, 1.0]),
        ray([0.25, 0.25, 0.0], [0.0, 0.0, 1.0]),
        ray([0.25, 0.25, -0.0], [0.0, 0.0, -1.0]),
        ray([-1.0, -2.0, 3.0], [1.2, 2.2, -3.0]),
        ray([-1.0, 0.25, 1.0], [1.0, 0.0, 0.0]),
        ray([-1.0, 0.25, 0.0], [1.0, 0.0, 0.0]),
        ray([-1.0, 0.0, 0.0], [1.0, -0.0, 0.0]),
        ray([-1.0, 0.25, 0.0], [1.0, -0.0, 1e-38]),
        // Signed zeros, and directions of other lengths.
        ray([0.25, 0.25, 1.0], [-0.0, -0.0, -1.0]),
        ray([0.25, -0.0, 1.0], [0.0, -0.0, -1e-20]),
        ray([0.25, 0.25, 1.0], [0.0, 0.0, -1e20]),
        ray([0.25, 0.25, 1e15], [0.0, 0.0, -1.0]),
        ray([0.25, 0.25, 1e-30], [0.0, 0.0, -1.0]),
        ray([0.25, 0.25, 1.0], [0.0, 0.0, 0.0]),
    ];
    rays.extend([
        Ray::new(Vec3::new(0.25, 0.25, 1.0), -Vec3::Z, 0.0, 0.5),
        Ray::new(Vec3::new(0.25, 0.25, 1.0), -Vec3::Z, 2.0, 5.0),
        Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::Z, -2.0, 5.0),
        Ray::new(Vec3::new(0.25, 0.25, 1.0), -Vec3::Z, 3.0, 1.0),
    ]);
    let mut triangles = vec![
        UNIT,
        Triangle { v0: Vec3::ZERO, v1: Vec3::Y, v2: Vec3::X },
        // Not in an axis plane, and without area: a line, a point, nearly a line.
        Triangle::new(Vec3::new(0.1, 0.0, 0.2), Vec3::new(0.9, 0.1, -0.3), Vec3::new(0.2, 0.8, 0.4)),
        Triangle { v0: Vec3::ZERO, v1: Vec3::X, v2: Vec3::X },
        Triangle::new(Vec3::new(0.25, 0.25, 0.0), Vec3::new(0.25, 0.25, 0.0), Vec3::new(0.25, 0.25, 0.0)),
        Triangle { v0: Vec3::ZERO, v1: Vec3::ONE, v2: Vec3::new(1.0, 1.0, 1.000_000_1) },
    ];
    for scale in [1e-30, 1e-12, 1e12, 1e15] {
        triangles.push(Triangle { v0: UNIT.v0, v1: UNIT.v1 * scale, v2: UNIT.v2 * scale });
    }
    let mut seeds: Vec<_> = triangles.iter().flat_map(|&t| rays.iter().map(move |&ray| (ray, t))).collect();
    for scale in [1e-30, 1e-12, 1e12, 1e15] {
        let triangle = Triangle { v0: UNIT.v0, v1: UNIT.v1 * scale, v2: UNIT.v2 * scale };
        seeds.extend(rays.iter().map(|ray| {
            (Ray::new(ray.org * scale, ray.dir, ray.t_near * scale, ray.t_far * scale), triangle)
        }));
    }
    seeds
}

#[test]
fn lanes_equal_scalar_on_seeds() {
    in_every_lane(&with_ends(&seeds()));
}

#[test]
fn lanes_equal_scalar_at_random() {
    at_random(200_000, |random| {
        let triangle = Triangle::new(random.vector(), random.vector(), random.vector());
        let target = triangle.v0 + triangle.e1() * random.signed() + triangle.e2() * random.signed();
        let org = random.vector() * 4.0;
        (Ray::new(org, target - org, 0.0, f32::INFINITY), triangle)
    });
}

/// Directions so short, or triangles so large, that a bound on rounding would itself be rounded to nothing, or beyond the
/// greatest float.
#[test]
fn lanes_equal_scalar_at_the_ends_of_the_floats() {
    at_random(400_000, |random| {
        let scale = [1e3, 1e9, 1e15, 9e17][random.below(4) as usize];
        let length = [1e-45, 1e-43, 1e-40, 1e-38, 1e-30, 1e20, 1e30][random.below(7) as usize];
        let triangle =
            Triangle::new(random.vector() * scale, random.vector() * scale, random.vector() * scale);
        // At an edge, most of them.
        let (u, v) = (random.signed().abs(), [0.0, 0.0, 1e-6, 0.3][random.below(4) as usize]);
        let target = triangle.v0 + triangle.e1() * u + triangle.e2() * v;
        let org = random.vector() * (scale * [1.0, 4.0, 1e6][random.below(3) as usize]);
        let dir = (target - org) / scale;
        let dir = dir / dir.abs().max_element() * length;
        let dir = if dir == Vec3::ZERO { Vec3::splat(length) } else { dir };
        (Ray::new(org, dir, 0.0, f32::INFINITY), triangle)
    });
}

#[test]
fn lanes_equal_scalar_on_a_grid() {
    at_random(200_000, |random| {
        let triangle = Triangle::new(random.grid(), random.grid(), random.grid());
        let t_far = [f32::INFINITY, 1.0, 2.0, 0.5][random.below(4) as usize];
        let t_near = [0.0, -0.0, 1.0, -2.0][random.below(4) as usize];
        (Ray::new(random.grid(), random.grid_direction(), t_near, t_far), triangle)
    });
}

#[test]
fn the_middle_edges_and_vertices_are_hit_and_no_more() {
    let down = |x: f32, y: f32| UNIT.intersect(&ray([x, y, 1.0], [0.0, 0.0, -1.0]));
    for (x, y) in [(0.25, 0.25), (0.5, 0.0), (0.0, 0.5), (0.5, 0.5), (0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
        assert_eq!(down(x, y), Some((1.0, x, y)));
    }
    for (x, y) in [(-1e-30, 0.5), (0.5, -1e-30), (0.500_001, 0.5), (1.0_f32.next_up(), 0.0), (2.0, 2.0)] {
        assert_eq!(down(x, y), None, "{x} {y}");
    }
}

#[test]
fn small_and_large_triangles_are_hit() {
    for exponent in -11..=11 {
        let scale = 10f32.powi(exponent);
        let triangle = Triangle { v0: UNIT.v0, v1: UNIT.v1 * scale, v2: UNIT.v2 * scale };
        let org = Vec3::new(0.25, 0.25, 2.0) * scale;
        let (t, u, v) = triangle.intersect(&Ray::new(org, -Vec3::Z, 0.0, f32::INFINITY)).expect("a hit");
        assert!((t / scale - 2.0).abs() < 1e-6 && (u - 0.25).abs() < 1e-6 && (v - 0.25).abs() < 1e-6);
    }
}

#[test]
fn triangles_without_area_and_parallel_rays_miss() {
    for triangle in [
        Triangle { v0: Vec3::ZERO, v1: Vec3::ZERO, v2: Vec3::ZERO },
        Triangle { v0: Vec3::ZERO, v1: Vec3::X, v2: Vec3::X },
        Triangle { v0: Vec3::ZERO, v1: Vec3::X, v2: Vec3::X * -2.0 },
        Triangle { v0: Vec3::ZERO, v1: Vec3::ZERO, v2: Vec3::Y },
    ] {
        for org in [Vec3::Z, Vec3::new(0.5, 0.0, 1.0), Vec3::new(0.0, -1.0, 0.0)] {
            assert_eq!(triangle.intersect(&Ray::new(org, -Vec3::Z, 0.0, f32::INFINITY)), None);
            assert_eq!(triangle.intersect(&Ray::new(org, Vec3::Y - Vec3::Z, 0.0, f32::INFINITY)), None);
        }
    }
    assert_eq!(UNIT.intersect(&ray([-1.0, 0.25, 0.0], [1.0, 0.0, 0.0])), None);
}

#[test]
fn nan_is_a_miss() {
    nan_misses(ray([0.25, 0.25, 1.0], [0.0, 0.0, -1.0]), UNIT);
    let flat = Triangle { v1: Vec3::new(f32::NAN, 0.0, 0.0), ..UNIT };
    assert_eq!(flat.intersect(&ray([0.25, 0.25, 1.0], [0.0, 0.0, -1.0])), None);
}

/// Cramer's rule in double precision.
fn exact(ray: &Ray, triangle: &Triangle) -> (f64, f64, f64, f64) {
    let [org, dir, v0, e1, e2] =
        [ray.org, ray.dir, triangle.v0, triangle.e1(), triangle.e2()].map(Vec3::as_dvec3);
    let normal: DVec3 = e1.cross(e2);
    let det = -dir.dot(normal);
    let (s, c) = (org - v0, (org - v0).cross(dir));
    (det, s.dot(normal) / det, e2.dot(c) / det, -e1.dot(c) / det)
}

#[test]
fn hits_are_those_of_double_precision() {
    let mut random = Random::new(3);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..200_000 {
        let triangle = Triangle::new(random.vector(), random.vector(), random.vector());
        let target = triangle.v0 + triangle.e1() * random.signed() + triangle.e2() * random.signed();
        let org = random.vector() * 4.0;
        let ray = Ray::new(org, target - org, 0.0, f32::INFINITY);
        let (det, t, u, v) = exact(&ray, &triangle);
        // What rounding may do to Cramer's quotients.
        let [s, d, e1, e2] =
            [org - triangle.v0, ray.dir, triangle.e1(), triangle.e2()].map(|v| f64::from(v.length()));
        let bound = 1e-6 * s / det.abs();
        let bounds = [bound * e1 * e2, bound * d * e2, bound * d * e1];
        let doubt = bounds[0].max(bounds[1]).max(bounds[2]);
        if doubt > 1e-2 {
            continue;
        }
        let margin = u.min(v).min(1.0 - u - v).min(t);
        let got = triangle.intersect(&ray);
        if margin > 2.0 * doubt {
            let got = got.expect("a hit by a margin");
            for ((got, want), bound) in [(got.0, t), (got.1, u), (got.2, v)].into_iter().zip(bounds) {
                assert!((f64::from(got) - want).abs() < bound, "{got} {want} {ray:?} {triangle:?}");
            }
            let on = triangle.v0 + triangle.e1() * got.1 + triangle.e2() * got.2;
            let apart = f64::from((ray.org + ray.dir * got.0 - on).length());
            assert!(apart < bounds[0] * d + bounds[1] * e1 + bounds[2] * e2, "{ray:?} {triangle:?}");
            hits += 1;
        } else if margin < -2.0 * doubt {
            assert_eq!(got, None, "a miss by a margin: {ray:?} {triangle:?}");
            misses += 1;
        }
    }
    assert!(hits > 10_000 && misses > 10_000, "{hits} {misses}");
}

/// What sorts out is no less than what it spares.
#[test]
fn the_bound_on_margins_is_one() {
    let mut random = Random::new(31);
    for round in 0..40_000 {
        let scale = [1.0, 1e-4, 1e4, 1e9][round % 4];
        let away = [0.0, 1.0, 1e3][round % 3];
        let mut point = || (random.vector() + random.signed() * away) * scale;
        let [v0, v1, v2, org] = std::array::from_fn(|_| point());
        let (dir, triangle) = (random.vector(), Triangle::new(v0, v1, v2));
        let lanes =
            TriangleLanes::<f32> { v0: v0.into(), v1: v1.into(), v2: v2.into(), edges: triangle.edges() };
        let aspect = lanes.aspect(org.into());
        let bound = aspect.margin(lanes.edges, rounding(dir.into()));
        // For this direction, and for a bundle in which this is one of several.
        let other = roundings(random.vector().into());
        let towards = [roundings(dir.into()), roundings(dir.into()).max(other)];
        let (e, d) = ((v1 - v0).abs() + (v2 - v0).abs(), dir.abs().as_dvec3());
        let (a, e) = (((org - v0).abs() + e).as_dvec3(), e.as_dvec3());
        let products = DVec3::new(a.y * e.z + a.z * e.y, a.z * e.x + a.x * e.z, a.x * e.y + a.y * e.x);
        let margin = 6.0 * f64::from(f32::EPSILON) * d.dot(products);
        for bound in [bound, aspect.margin_towards(towards[0]), aspect.margin_towards(towards[1])] {
            assert!(f64::from(bound) >= margin, "{bound} {margin} {triangle:?} {org} {dir}");
        }
        // The same again, by a fifth more: what it is there for is to be smaller than the bound.
        assert!(f64::from(aspect.margin_towards(towards[0])) <= 1.21 * margin + 1e-33);
    }
}

/// A ray that begins next to a triangle, by a few roundings on either side, or on it.
fn leaving(random: &mut Random) -> (Ray, Triangle) {
    // At the last, products overflow where their sum would not.
    let scale = [1.0, 1e-3, 1e3, 7e12][random.below(4) as usize];
    let away = random.vector() * [0.0, 1.0, 300.0][random.below(3) as usize];
    let [v0, v1, v2] = [random.vector(), random.vector(), random.vector()].map(|v| (v + away) * scale);
    let triangle = Triangle::new(v0, v1, v2);
    let (u, v) = (random.signed().abs(), random.signed().abs());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    let on = v0 + triangle.e1() * u + triangle.e2() * v;
    let off = random.signed() * [0.0, 1e-7, 1e-6, 1e-4, 1e-2][random.below(5) as usize];
    let org = on + triangle.e1().cross(triangle.e2()).normalize_or_zero() * off * on.length();
    let t_near = [0.0, 0.0, -1.0, f32::MIN_POSITIVE][random.below(4) as usize] * scale;
    (Ray::new(org, random.vector(), t_near, f32::INFINITY), triangle)
}

#[test]
fn rays_that_leave_a_triangle_find_what_they_find_alone() {
    at_random(400_000, leaving);
}

/// What is called behind is behind in double precision; next to the surface nothing is said.
#[test]
fn what_is_behind_is_crossed_before_the_ray_begins() {
    let (mut random, mut behind, mut not) = (Random::new(5), 0, 0);
    for _ in 0..400_000 {
        let (ray, triangle) = leaving(&mut random);
        let [v0, v1, v2] = [triangle.v0, triangle.v1, triangle.v2].map(Into::into);
        let lanes = TriangleLanes::<f32> { v0, v1, v2, edges: triangle.edges() };
        let rays = RayLanes::<f32>::splat(&ray);
        let aspect = lanes.aspect(rays.org);
        let tested = aspect.test(aspect.margin(lanes.edges, rays.margin), &rays, true);
        if !(tested.near && tested.certain) {
            continue;
        }
        // By the vertices themselves: edges as they are rounded are another triangle's.
        let [org, v0, v1, v2] = [ray.org, triangle.v0, triangle.v1, triangle.v2].map(Vec3::as_dvec3);
        let normal = (v1 - v0).cross(v2 - v0);
        let t = (v0 - org).dot(normal) / ray.dir.as_dvec3().dot(normal);
        if aspect.behind(lanes.edges, &tested, &rays) {
            assert!(t < 0.0 && ray.t_near >= 0.0, "{t} {ray:?} {triangle:?}");
            behind += 1;
        } else if t < 0.0 && ray.t_near >= 0.0 {
            not += 1;
        }
    }
    assert!(behind > 20_000 && not > 20_000, "{behind} {not}");
}
