use super::*;
use crate::geometry::seeds::{Random, packet};
use crate::simd::f32x8;

fn check(aabb: Aabb, ray: Ray) -> (f32, f32) {
    let scalar = aabb.interval(&ray);
    let lanes = interval::<f32x8>(
        (Vector3::splat(aabb.min), Vector3::splat(aabb.max)),
        (Vector3::splat(ray.org), Vector3::splat(ray.rdir)),
        (f32x8::splat(ray.t_near), f32x8::splat(ray.t_far)),
    );
    for i in 0..8 {
        assert_eq!(scalar.0.to_bits(), lanes.0.lane(i).to_bits());
        assert_eq!(scalar.1.to_bits(), lanes.1.lane(i).to_bits());
    }
    scalar
}

#[test]
fn rays_in_the_planes_of_a_box_are_not_missed() {
    let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    for (org, dir) in [
        (Vec3::new(-1.0, 0.0, 0.5), Vec3::X),
        (Vec3::new(-1.0, 1.0, 1.0), Vec3::X),
        (Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, -0.0, 0.0)),
        (Vec3::new(0.0, 0.0, 0.0), Vec3::X),
        (Vec3::new(2.0, 1.0, 0.25), Vec3::new(-1.0, -0.0, -0.0)),
    ] {
        let (low, high) = check(unit, Ray::new(org, dir, 0.0, f32::INFINITY));
        assert!(low <= high, "{org} {dir}: {low} {high}");
    }
    let (low, high) = check(unit, Ray::new(Vec3::new(-1.0, 1.1, 0.5), Vec3::X, 0.0, f32::INFINITY));
    assert!(low > high);
    let (low, high) = check(Aabb::EMPTY, Ray::new(Vec3::ZERO, Vec3::X, 0.0, f32::INFINITY));
    assert!(low > high);
}

#[test]
fn intervals_grow_with_their_boxes() {
    let mut state = 1u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        // A small grid: coincidences are the point.
        (state >> 28) as f32 - 8.0
    };
    for _ in 0..200_000 {
        let [a, b, c, d] = std::array::from_fn(|_| Vec3::new(next(), next(), next()));
        let inner = Aabb::of_points([a, b]);
        let outer = inner.union(Aabb::of_points([c]));
        let ray = Ray::new(Vec3::new(next(), next(), next()), d, 0.0, f32::INFINITY);
        if d == Vec3::ZERO {
            continue;
        }
        let ((low, high), (wide_low, wide_high)) = (check(inner, ray), check(outer, ray));
        if low <= high {
            assert!(wide_low <= low && high <= wide_high, "{inner:?} {outer:?} {ray:?}");
        }
    }
}

fn seeds() -> Vec<(Aabb, Ray)> {
    let coordinates = [-1.0, -0.0, 0.0, 0.5, 1.0, 2.0];
    let directions = [-1.0, -0.0, 0.0, 1.0, 1e-30, -1e30];
    let boxes = [
        Aabb { min: Vec3::ZERO, max: Vec3::ONE },
        Aabb { min: Vec3::new(0.0, -0.0, 0.0), max: Vec3::new(1.0, 0.0, 1.0) },
        Aabb { min: Vec3::ONE, max: Vec3::ONE },
        Aabb { min: Vec3::splat(-1e15), max: Vec3::splat(1e15) },
        Aabb { min: Vec3::splat(-1e-30), max: Vec3::splat(1e-30) },
        Aabb::EMPTY,
    ];
    let mut random = Random::new(1);
    let mut pick =
        |from: &[f32]| Vec3::from_array([(); 3].map(|()| from[random.below(from.len() as u32) as usize]));
    let mut all = Vec::new();
    for i in 0..20_000 {
        let (org, dir) = (pick(&coordinates), pick(&directions));
        let t_far = [f32::INFINITY, 1.0, 0.0][i % 3];
        all.push((
            boxes[i % boxes.len()],
            Ray::new(org, dir, [0.0, 1.0, f32::NEG_INFINITY][i / 3 % 3], t_far),
        ));
    }
    all
}

/// Eight rays against eight boxes, against one, and one ray against eight boxes.
fn check_lanes(boxes: &[Aabb; 8], rays: &[Ray; 8]) {
    let lanes = packet(rays);
    let (low, high) = interval::<f32x8>(
        (Vector3::from_fn(|i| boxes[i].min), Vector3::from_fn(|i| boxes[i].max)),
        (lanes.org, lanes.rdir),
        (lanes.t_near, lanes.t_far),
    );
    for i in 0..8 {
        let want = boxes[i].interval(&rays[i]);
        let got = (low.lane(i), high.lane(i));
        assert_eq!(
            (got.0.to_bits(), got.1.to_bits()),
            (want.0.to_bits(), want.1.to_bits()),
            "{:?}",
            (boxes[i], rays[i])
        );
    }
}

#[test]
fn lanes_equal_scalar_on_seeds() {
    for group in seeds().windows(8).chain(seeds().chunks_exact(8)) {
        let (boxes, rays): (Vec<_>, Vec<_>) = group.iter().copied().unzip();
        let (boxes, rays) = (boxes.try_into().unwrap(), rays.try_into().unwrap());
        check_lanes(&boxes, &rays);
        check_lanes(&[boxes[0]; 8], &rays);
        check_lanes(&boxes, &[rays[0]; 8]);
    }
}

#[test]
fn a_box_that_is_met_exactly_is_met_in_floats() {
    let mut random = Random::new(2);
    let (mut met, mut missed) = (0u32, 0u32);
    for i in 0..400_000 {
        let scale = [1.0, 1e-4, 1e6, 1.0][i % 4];
        let grid = i % 4 == 3;
        let mut point = || if grid { random.grid() } else { random.vector() * scale };
        let (a, b, org, target) = (point(), point(), point(), point());
        // A third of the boxes are flat, a third of the rays end on a corner.
        let b = if i % 3 == 0 { Vec3::new(a.x, b.y, b.z) } else { b };
        let aabb = Aabb::of_points([a, b]);
        let dir = if i % 3 == 1 { aabb.max - org } else { target - org };
        if dir == Vec3::ZERO {
            continue;
        }
        let ray = Ray::new(org, dir, 0.0, f32::INFINITY);
        let (mut low, mut high) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let [org, dir, min, max] = [org, dir, aabb.min, aabb.max].map(|v| f64::from(v[axis]));
            if dir == 0.0 {
                if org < min || org > max {
                    high = f64::NEG_INFINITY;
                }
                continue;
            }
            let (near, far) = if dir < 0.0 { (max, min) } else { (min, max) };
            low = low.max((near - org) / dir);
            high = high.min((far - org) / dir);
        }
        let (got_low, got_high) = aabb.interval(&ray);
        if low <= high {
            met += 1;
            assert!(got_low <= got_high, "{low} {high}, {got_low} {got_high}: {aabb:?} {ray:?}");
            assert!(f64::from(got_high) >= high * (1.0 - 1e-12), "{high} {got_high}: {aabb:?} {ray:?}");
            assert!(f64::from(got_low) <= low * (1.0 + 1e-6), "{low} {got_low}: {aabb:?} {ray:?}");
        } else if low > high * (1.0 + 1e-5) {
            missed += 1;
            assert!(got_low > got_high, "{low} {high}, {got_low} {got_high}: {aabb:?} {ray:?}");
        }
    }
    assert!(met > 20_000 && missed > 20_000, "{met} {missed}");
}

#[test]
fn the_middle_is_between_the_corners_however_far_they_are() {
    let aabb = Aabb { min: Vec3::new(-1.0, 2.0, -f32::MAX), max: Vec3::new(3.0, 10.0, f32::MAX) };
    assert_eq!(aabb.centre(), Vec3::new(1.0, 6.0, 0.0));
}

#[test]
fn half_of_the_surface_is_three_faces() {
    let of = |size: [f32; 3]| Aabb { min: Vec3::ONE, max: Vec3::ONE + Vec3::from(size) }.half_area();
    assert_eq!(of([2.0, 3.0, 5.0]), 6.0 + 15.0 + 10.0);
    assert_eq!((of([0.0, 3.0, 5.0]), of([2.0, 0.0, 0.0]), Aabb::EMPTY.half_area()), (15.0, 0.0, 0.0));
}
