use glam::{DAffine3, DMat3, DVec3, Vec3};

use super::*;
use crate::geometry::{
    Rayx8,
    seeds::{Kernel, Random, at_random, in_every_lane, nan_misses, with_ends},
};
use crate::simd::{Mask8, f32x8};

impl Kernel for Canonical {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn scalar(&self, ray: &Ray) -> Option<[f32; 3]> {
        self.intersect_ray(ray).map(|t| [t, 0.0, 0.0])
    }

    fn lanes(surfaces: &[Self; 8], rays: &Rayx8, active: Mask8) -> Option<(Mask8, [f32x8; 3])> {
        // Eight rays against one surface is the only use.
        surfaces.iter().all(|other| *other == surfaces[0]).then(|| {
            let (hit, t) = surfaces[0].intersect(rays, active);
            (hit, [t, f32x8::zero(), f32x8::zero()])
        })
    }
}

/// A surface under a map canonical → world, with a box a little larger than it.
fn placed(kind: CanonicalKind, to_world: DAffine3) -> Canonical {
    let (m, origin) = (to_world.matrix3, to_world.translation);
    let reach = |i: usize| m.x_axis[i].hypot(m.y_axis[i]);
    let reach = DVec3::new(reach(0), reach(1), reach(2));
    let ends = match kind {
        CanonicalKind::Disk => vec![origin],
        CanonicalKind::Cylinder => vec![origin, origin + m.z_axis],
    };
    let bounds = Aabb::of_points(ends.iter().flat_map(|&e| [e - reach, e + reach]).map(DVec3::as_vec3));
    let slack = bounds.min.abs().max(bounds.max.abs()) * f32::EPSILON;
    let bounds = Aabb { min: bounds.min - slack, max: bounds.max + slack };
    Canonical { kind, to_canonical: Affine::from(&to_world.inverse()), bounds }
}

const KINDS: [CanonicalKind; 2] = [CanonicalKind::Disk, CanonicalKind::Cylinder];

fn ray(org: [f32; 3], dir: [f32; 3]) -> Ray {
    Ray::new(org.into(), dir.into(), 0.0, f32::INFINITY)
}

fn seeds() -> Vec<(Ray, Canonical)> {
    let rays = [
        // Along the axis: middle, rim, past it, behind, from the plane.
        ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]),
        ray([0.6, 0.8, 3.0], [0.0, -0.0, -1.0]),
        ray([1.0, 0.0, 3.0], [0.0, 0.0, -1.0]),
        ray([1.0_f32.next_up(), 0.0, 3.0], [0.0, 0.0, -1.0]),
        ray([0.2, 0.3, 3.0], [0.0, 0.0, 1.0]),
        ray([0.2, 0.3, 0.0], [0.0, 0.0, 1.0]),
        ray([0.2, 0.3, -0.0], [1.0, 0.0, -0.0]),
        // Across: through the middle, tangent, along the lower and the upper rim, above, from inside.
        ray([3.0, 0.0, 0.5], [-1.0, 0.0, 0.0]),
        ray([3.0, 1.0, 0.5], [-1.0, 0.0, 0.0]),
        ray([3.0, 0.1, 0.0], [-1.0, 0.0, -0.0]),
        ray([3.0, 0.1, 1.0], [-1.0, 0.0, 0.0]),
        ray([3.0, 0.1, 1.5], [-1.0, 0.0, 0.0]),
        ray([0.0, 0.0, 0.5], [1.0, 0.0, 0.0]),
        ray([0.1, 0.2, 0.5], [0.3, -0.5, 0.1]),
        ray([1.0, 0.0, 0.5], [1.0, 0.0, 0.0]),
        ray([1.0, 0.0, 0.5], [-1.0, 0.0, 0.0]),
        // The first root is above the rim, the second is not.
        ray([-1.5, 0.0, 1.5], [1.0, 0.0, -0.5]),
        ray([0.1, 0.1, 1e15], [0.0, 0.0, -1.0]),
        ray([0.1, 0.1, 1e6], [0.0, 1e-6, -1.0]),
        ray([1e15, 0.0, 0.5], [-1.0, 0.0, 0.0]),
        ray([3.0, 0.0, 0.5], [-1e-30, 0.0, 0.0]),
        ray([3.0, 0.0, 0.5], [0.0, 0.0, 0.0]),
        Ray::new(Vec3::new(3.0, 0.0, 0.5), -Vec3::X, 2.5, 9.0),
        Ray::new(Vec3::new(3.0, 0.0, 0.5), -Vec3::X, 0.0, 1.0),
        Ray::new(Vec3::new(0.0, 0.0, 3.0), -Vec3::Z, 0.0, 2.0),
    ];
    let maps = [
        DAffine3::IDENTITY,
        DAffine3::from_scale(DVec3::splat(1e-12)),
        DAffine3::from_scale(DVec3::splat(1e12)),
        DAffine3::from_rotation_x(0.4) * DAffine3::from_scale(DVec3::new(1.2, 0.7, 2.0)),
        DAffine3::from_translation(DVec3::new(0.0, 0.0, 1e6)),
    ];
    let surfaces = maps.iter().flat_map(|&map| KINDS.map(|kind| placed(kind, map)));
    surfaces.flat_map(|surface| rays.iter().map(move |&ray| (ray, surface))).collect()
}

#[test]
fn lanes_equal_scalar_on_seeds() {
    in_every_lane(&with_ends(&seeds()));
}

fn affine(random: &mut Random) -> DAffine3 {
    loop {
        let mut axis = || random.vector().as_dvec3();
        let map = DAffine3 { matrix3: DMat3::from_cols(axis(), axis(), axis()), translation: axis() };
        if map.matrix3.determinant().abs() > 0.05 {
            return map;
        }
    }
}

#[test]
fn lanes_equal_scalar_at_random() {
    at_random(200_000, |random| {
        let map = affine(random);
        let surface = placed(KINDS[random.below(2) as usize], map);
        let org = random.vector() * 4.0;
        let target = map.transform_point3(random.vector().as_dvec3()).as_vec3();
        (Ray::new(org, target - org, 0.0, f32::INFINITY), surface)
    });
}

#[test]
fn lanes_equal_scalar_on_a_grid() {
    at_random(200_000, |random| {
        let scale = DVec3::new(1.0, 1.0, 1.0 + f64::from(random.below(2)));
        let map = DAffine3::from_translation(random.grid().as_dvec3()) * DAffine3::from_scale(scale);
        let surface = placed(KINDS[random.below(2) as usize], map);
        let t_far = [f32::INFINITY, 1.0, 2.0, 0.5][random.below(4) as usize];
        let t_near = [0.0, -0.0, 1.0, -2.0][random.below(4) as usize];
        (Ray::new(random.grid(), random.grid_direction(), t_near, t_far), surface)
    });
}

#[test]
fn a_disk_has_a_rim_and_a_cylinder_has_ends() {
    let [disk, cylinder] = KINDS.map(|kind| placed(kind, DAffine3::IDENTITY));
    let hit = |surface: &Canonical, org: [f32; 3], dir: [f32; 3]| surface.intersect_ray(&ray(org, dir));
    assert_eq!(hit(&disk, [0.2, 0.3, 3.0], [0.0, 0.0, -1.0]), Some(3.0));
    assert_eq!(hit(&disk, [0.2, 0.3, -3.0], [0.0, 0.0, 1.0]), Some(3.0));
    assert_eq!(hit(&disk, [1.0, 0.0, 3.0], [0.0, 0.0, -1.0]), Some(3.0));
    assert_eq!(hit(&disk, [1.0_f32.next_up(), 0.0, 3.0], [0.0, 0.0, -1.0]), None);
    assert_eq!(hit(&disk, [0.8, 0.8, 3.0], [0.0, 0.0, -1.0]), None);
    assert_eq!(hit(&disk, [3.0, 0.0, 0.0], [-1.0, 0.0, 0.0]), None);
    assert_eq!(hit(&cylinder, [3.0, 0.0, 0.5], [-1.0, 0.0, 0.0]), Some(2.0));
    assert_eq!(hit(&cylinder, [0.0, 0.0, 0.5], [-1.0, 0.0, 0.0]), Some(1.0));
    for z in [0.0, 1.0] {
        assert_eq!(hit(&cylinder, [3.0, 0.0, z], [-1.0, 0.0, 0.0]), Some(2.0));
    }
    for z in [-1e-30, 1.0_f32.next_up()] {
        assert_eq!(hit(&cylinder, [3.0, 0.0, z], [-1.0, 0.0, 0.0]), None);
    }
    // Behind, where a range reaches back: the least t is the nearest.
    let back = Ray::new(Vec3::new(-3.0, 0.0, 0.5), -Vec3::X, -9.0, 9.0);
    assert_eq!(cylinder.intersect_ray(&back), Some(-4.0));
    // Without caps: along the axis it is open, and a slanting ray meets its far inside.
    assert_eq!(hit(&cylinder, [0.0, 0.0, 3.0], [0.0, 0.0, -1.0]), None);
    assert_eq!(hit(&cylinder, [-1.5, 0.0, 1.5], [1.0, 0.0, -0.5]), Some(2.5));
}

#[test]
fn nan_is_a_miss() {
    nan_misses(ray([0.1, 0.2, 3.0], [0.1, 0.1, -1.0]), placed(CanonicalKind::Disk, DAffine3::IDENTITY));
    nan_misses(ray([3.0, 0.2, 0.4], [-1.0, 0.1, 0.1]), placed(CanonicalKind::Cylinder, DAffine3::IDENTITY));
}

/// All parameters at which a line meets the surface, and how clearly it does: positive inside.
fn roots(kind: CanonicalKind, o: DVec3, d: DVec3) -> Vec<(f64, f64)> {
    match kind {
        CanonicalKind::Disk => {
            let t = -o.z / d.z;
            vec![(t, 1.0 - (o + d * t).truncate().length())]
        }
        CanonicalKind::Cylinder => {
            let (f, g) = (o.truncate(), d.truncate());
            let (a, b, c) = (g.dot(g), f.dot(g), f.dot(f) - 1.0);
            let discriminant = b * b - a * c;
            if discriminant < 0.0 {
                return vec![];
            }
            let clear = |t: f64| (o.z + d.z * t).min(1.0 - o.z - d.z * t).min((discriminant / a).sqrt());
            [(-b - discriminant.sqrt()) / a, (-b + discriminant.sqrt()) / a].map(|t| (t, clear(t))).to_vec()
        }
    }
}

#[test]
fn hits_are_those_of_double_precision() {
    let mut random = Random::new(9);
    let (mut hits, mut misses) = (0, 0);
    for i in 0..200_000 {
        let (kind, map) = (KINDS[i % 2], affine(&mut random));
        let surface = placed(kind, map);
        let org = random.vector() * 4.0;
        let target = map.transform_point3(random.vector().as_dvec3()).as_vec3();
        let ray = Ray::new(org, target - org, 0.0, f32::INFINITY);
        let inverse = map.inverse();
        let o = inverse.transform_point3(org.as_dvec3());
        let d = inverse.transform_vector3(ray.dir.as_dvec3());
        let roots = roots(kind, o, d);
        let doubtful = |&(t, clear): &(f64, f64)| clear.abs() < 0.02 || t.abs() < 0.02;
        if roots.iter().any(doubtful)
            || d.z.abs() < 0.05 * d.length()
            || d.truncate().length() < 0.1 * d.length()
        {
            continue;
        }
        let want = roots.iter().find(|&&(t, clear)| clear > 0.0 && t > 0.0);
        let got = surface.intersect_ray(&ray);
        match (want, got) {
            (None, None) => misses += 1,
            (Some(&(want, _)), Some(got)) => {
                assert!((f64::from(got) - want).abs() < 2e-3, "{kind:?}: {got} {want} {ray:?} {map:?}");
                hits += 1;
            }
            _ => panic!("{kind:?}: {want:?} {got:?} {ray:?} {map:?}"),
        }
    }
    assert!(hits > 20_000 && misses > 20_000, "{hits} {misses}");
}
