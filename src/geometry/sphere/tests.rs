use super::*;
use crate::geometry::{
    Rayx8,
    seeds::{Kernel, Random, at_random, in_every_lane, nan_misses, with_ends},
};
use crate::simd::{Mask8, f32x8};

impl Kernel for Sphere {
    fn bounds(&self) -> Aabb {
        self.bounds()
    }

    fn scalar(&self, ray: &Ray) -> Option<[f32; 3]> {
        self.intersect(ray).map(|t| [t, 0.0, 0.0])
    }

    fn lanes(surfaces: &[Self; 8], rays: &Rayx8, active: Mask8) -> Option<(Mask8, [f32x8; 3])> {
        let spheres = SphereLanes {
            center: Vector3::from_fn(|i| surfaces[i].center),
            radius: f32x8::from_fn(|i| surfaces[i].radius),
        };
        let (hit, t) = spheres.intersect(rays, active);
        Some((hit, [t, f32x8::zero(), f32x8::zero()]))
    }
}

const UNIT: Sphere = Sphere { center: Vec3::ZERO, radius: 1.0 };

fn ray(org: [f32; 3], dir: [f32; 3]) -> Ray {
    Ray::new(org.into(), dir.into(), 0.0, f32::INFINITY)
}

fn seeds() -> Vec<(Ray, Sphere)> {
    let mut rays = vec![
        // Through the middle, off it, tangent, past, behind.
        ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]),
        ray([0.3, 0.4, 3.0], [0.0, 0.0, -1.0]),
        ray([1.0, 0.0, 3.0], [0.0, 0.0, -1.0]),
        ray([1.0_f32.next_up(), 0.0, 3.0], [0.0, 0.0, -1.0]),
        ray([2.0, 0.0, 3.0], [0.0, 0.0, -1.0]),
        ray([0.0, 0.0, 3.0], [0.0, 0.0, 1.0]),
        // From inside: the middle (b = 0), elsewhere, almost on the surface.
        ray([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        ray([-0.0, 0.0, -0.0], [-1.0, -0.0, 0.0]),
        ray([0.5, 0.1, -0.2], [1.0, 2.0, 3.0]),
        ray([0.0, 0.0, 1.0_f32.next_down()], [0.0, 0.0, 1.0]),
        // On the surface: inwards, outwards, along it.
        ray([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]),
        ray([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]),
        ray([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        ray([0.6, 0.8, 0.0], [-0.6, -0.8, 1e-9]),
        // Far away, near zero, long and short directions, none.
        ray([0.0, 0.0, 1e6], [0.0, 0.0, -1.0]),
        ray([0.0, 0.0, 1e15], [0.0, 0.0, -1.0]),
        ray([0.5, 0.0, 3.0], [0.0, -0.0, -1e-15]),
        ray([0.5, 0.0, 3.0], [-0.0, 0.0, -1e15]),
        ray([1e-30, 0.0, 3.0], [0.0, 1e-30, -1.0]),
        ray([0.0, 0.0, 3.0], [0.0, 0.0, 0.0]),
    ];
    rays.push(Ray::new(Vec3::new(0.0, 0.0, 3.0), -Vec3::Z, 2.5, 10.0));
    rays.push(Ray::new(Vec3::new(0.0, 0.0, 3.0), -Vec3::Z, 0.0, 1.0));
    rays.push(Ray::new(Vec3::new(0.0, 0.0, 3.0), -Vec3::Z, 2.5, 3.0));
    rays.push(Ray::new(Vec3::new(0.0, 0.0, 3.0), Vec3::Z, -9.0, 3.0));
    let mut seeds: Vec<_> = rays.iter().map(|&ray| (ray, UNIT)).collect();
    for scale in [1e-30, 1e-12, 1e12, 1e15] {
        let sphere = Sphere { center: Vec3::new(0.0, -0.0, 0.0), radius: scale };
        seeds.extend(rays.iter().map(|&ray| (ray, sphere)));
        seeds.extend(
            rays.iter().map(|ray| {
                (Ray::new(ray.org * scale, ray.dir, ray.t_near * scale, ray.t_far * scale), sphere)
            }),
        );
    }
    seeds.extend(rays.iter().map(|&ray| (ray, Sphere { center: Vec3::new(0.0, 0.0, 1e6), radius: 0.5 })));
    seeds
}

#[test]
fn lanes_equal_scalar_on_seeds() {
    in_every_lane(&with_ends(&seeds()));
}

#[test]
fn lanes_equal_scalar_at_random() {
    at_random(200_000, |random| {
        let sphere = Sphere { center: random.vector(), radius: 0.01 + random.signed().abs() };
        let org = random.vector() * 4.0;
        let target = sphere.center + random.vector() * sphere.radius;
        (Ray::new(org, target - org, 0.0, f32::INFINITY), sphere)
    });
}

#[test]
fn lanes_equal_scalar_on_a_grid() {
    at_random(200_000, |random| {
        let sphere = Sphere { center: random.grid(), radius: 1.0 + random.below(3) as f32 };
        let t_far = [f32::INFINITY, 1.0, 2.0, 0.5][random.below(4) as usize];
        let t_near = [0.0, -0.0, 1.0, -2.0][random.below(4) as usize];
        (Ray::new(random.grid(), random.grid_direction(), t_near, t_far), sphere)
    });
}

#[test]
fn the_roots_are_the_textbook_ones() {
    let hit = |org: [f32; 3], dir: [f32; 3]| UNIT.intersect(&ray(org, dir));
    assert_eq!(hit([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]), Some(2.0));
    assert_eq!(hit([0.0, 0.0, 3.0], [0.0, 0.0, -0.5]), Some(4.0));
    assert_eq!(hit([0.0, 0.0, 0.0], [0.0, 0.0, -1.0]), Some(1.0));
    assert_eq!(hit([1.0, 0.0, 3.0], [0.0, 0.0, -1.0]), Some(3.0));
    assert_eq!(hit([1.0_f32.next_up(), 0.0, 3.0], [0.0, 0.0, -1.0]), None);
    assert_eq!(hit([0.0, 0.0, 3.0], [0.0, 0.0, 1.0]), None);
    // Behind, where a range reaches back: the least t is the nearest.
    let back = Ray::new(Vec3::new(0.0, 0.0, -3.0), -Vec3::Z, -9.0, 9.0);
    assert_eq!(UNIT.intersect(&back), Some(-4.0));
    // On the surface: t = 0 is excluded, the far side is not.
    assert_eq!(hit([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]), Some(2.0));
    assert_eq!(hit([0.0, 0.0, 1.0], [0.0, 0.0, 1.0]), None);
}

#[test]
fn nan_is_a_miss() {
    nan_misses(ray([0.0, 0.1, 3.0], [0.0, 0.0, -1.0]), UNIT);
    let broken = Sphere { radius: f32::NAN, ..UNIT };
    assert_eq!(broken.intersect(&ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0])), None);
}

#[test]
fn hits_are_those_of_double_precision() {
    let mut random = Random::new(5);
    let (mut hits, mut misses, mut inside) = (0, 0, 0);
    for i in 0..200_000 {
        let sphere = Sphere { center: random.vector(), radius: 0.01 + random.signed().abs() };
        let far = if i % 2 == 0 { 2.0 } else { 1000.0 };
        let org = random.vector() * far;
        let target = sphere.center + random.vector() * sphere.radius * 1.5;
        let ray = Ray::new(org, target - org, 0.0, f32::INFINITY);
        let (f, d) = ((ray.org.as_dvec3() - sphere.center.as_dvec3()), ray.dir.as_dvec3());
        let r = f64::from(sphere.radius);
        let (a, b) = (d.dot(d), -f.dot(d));
        let discriminant = r * r - (f + d * (b / a)).length_squared();
        // The centre's distance to the line is known to some ulps of the distance to the origin.
        let margin = 1e-6 * f.length() / r + 1e-3;
        if discriminant.abs() < 2.0 * margin * r * r {
            continue;
        }
        let got = sphere.intersect(&ray);
        if discriminant < 0.0 {
            assert_eq!(got, None, "{ray:?} {sphere:?}");
            misses += 1;
            continue;
        }
        let root = (discriminant / a).sqrt();
        let (near, t_far) = (b / a - root, b / a + root);
        if near.abs() < 1e-3 * root || t_far.abs() < 1e-3 * root {
            continue;
        }
        let want = if near > 0.0 { near } else { t_far };
        if want <= 0.0 {
            assert_eq!(got, None, "{ray:?} {sphere:?}");
            misses += 1;
            continue;
        }
        let t = f64::from(got.expect("a hit by a margin"));
        let length = (f + d * t).length();
        assert!((length - r).abs() < 1e-6 * (f.length() + 1.0), "{length} {r} {ray:?} {sphere:?}");
        assert!((t - want).abs() * a.sqrt() < 2e-5 * (f.length() + r), "{t} {want} {ray:?} {sphere:?}");
        hits += 1;
        inside += u32::from(near < 0.0);
    }
    assert!(hits > 50_000 && misses > 20_000 && inside > 1000, "{hits} {misses} {inside}");
}

#[test]
fn a_small_sphere_far_away_is_where_it_is() {
    // The textbook's discriminant b² − ac has no bit left here.
    let sphere = Sphere { center: Vec3::new(0.0, 0.0, 1e5), radius: 1.0 };
    let t = sphere.intersect(&Ray::new(Vec3::new(0.0, 0.0, 0.0), Vec3::Z, 0.0, f32::INFINITY));
    assert_eq!(t, Some(99_999.0));
    assert_eq!(sphere.intersect(&Ray::new(Vec3::new(1.01, 0.0, 0.0), Vec3::Z, 0.0, f32::INFINITY)), None);
    assert!(sphere.intersect(&Ray::new(Vec3::new(0.99, 0.0, 0.0), Vec3::Z, 0.0, f32::INFINITY)).is_some());
}
