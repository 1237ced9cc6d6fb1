//! Ray against triangle, sphere and box: eight lanes and their scalar twin. An element is one test.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use packlight::{
    geometry::{Aabb, Ray, Ray32, Rayx8, Sphere, SphereLanes, Triangle, TriangleLanes, aabb},
    simd::{LANES, Mask, Mask8, Real, Vector3, f32x8},
};

mod random;
use random::Random;

/// Small enough for the first-level cache.
const SHAPES: usize = 64;

/// Eight rays that meet about half of the shapes.
fn rays(random: &mut Random) -> (Vec<Ray>, Rayx8) {
    let rays: Vec<Ray32> = (0..LANES)
        .map(|_| {
            let org = random.point() * 4.0 - Vec3::splat(2.0);
            Ray32::new(org, random.point() - org, 0.0, f32::INFINITY)
        })
        .collect();
    (rays.iter().map(Ray32::ray).collect(), Ray32::packet(&rays))
}

fn triangle(c: &mut Criterion) {
    let mut random = Random::new(1);
    let (rays, packet) = rays(&mut random);
    let triangles: Vec<Triangle> =
        (0..SHAPES).map(|_| Triangle::new(random.point(), random.point(), random.point())).collect();
    let mut group = c.benchmark_group("triangle");
    group.throughput(Throughput::Elements((SHAPES * LANES) as u64));
    group.bench_function("x8", |b| {
        b.iter(|| {
            let packet = black_box(packet);
            let all = Mask8::splat(true);
            let hits = triangles.iter().map(|t| {
                let splat = Vector3::splat;
                let (v0, v1, v2) = (splat(t.v0), splat(t.v1), splat(t.v2));
                let lanes = TriangleLanes { v0, v1, v2, edges: f32x8::splat(t.edges()) };
                lanes.intersect(&packet, all).0.count()
            });
            hits.sum::<u32>()
        });
    });
    group.bench_function("scalar", |b| {
        b.iter(|| {
            let rays = black_box(rays.as_slice());
            let hits = triangles.iter().map(|t| rays.iter().filter(|ray| t.intersect(ray).is_some()).count());
            hits.sum::<usize>()
        });
    });
}

fn sphere(c: &mut Criterion) {
    let mut random = Random::new(2);
    let (rays, packet) = rays(&mut random);
    let spheres: Vec<Sphere> =
        (0..SHAPES).map(|_| Sphere { center: random.point(), radius: 0.1 + 0.4 * random.number() }).collect();
    let mut group = c.benchmark_group("sphere");
    group.throughput(Throughput::Elements((SHAPES * LANES) as u64));
    group.bench_function("x8", |b| {
        b.iter(|| {
            let packet = black_box(packet);
            let all = Mask8::splat(true);
            let hits = spheres.iter().map(|s| {
                let lanes = SphereLanes { center: Vector3::splat(s.center), radius: f32x8::splat(s.radius) };
                lanes.intersect(&packet, all).0.count()
            });
            hits.sum::<u32>()
        });
    });
    group.bench_function("scalar", |b| {
        b.iter(|| {
            let rays = black_box(rays.as_slice());
            let hits = spheres.iter().map(|s| rays.iter().filter(|ray| s.intersect(ray).is_some()).count());
            hits.sum::<usize>()
        });
    });
}

fn slab(c: &mut Criterion) {
    let mut random = Random::new(3);
    let (rays, packet) = rays(&mut random);
    let boxes: Vec<Aabb> = (0..SHAPES).map(|_| Aabb::of_points([random.point(), random.point()])).collect();
    let mut group = c.benchmark_group("slab");
    group.throughput(Throughput::Elements((SHAPES * LANES) as u64));
    group.bench_function("x8", |b| {
        b.iter(|| {
            let packet = black_box(packet);
            let hits = boxes.iter().map(|bounds| {
                let planes = (Vector3::splat(bounds.min), Vector3::splat(bounds.max));
                let (low, high) =
                    aabb::interval(planes, (packet.org, packet.rdir), (packet.t_near, packet.t_far));
                low.le(high).count()
            });
            hits.sum::<u32>()
        });
    });
    group.bench_function("scalar", |b| {
        b.iter(|| {
            let rays = black_box(rays.as_slice());
            let entered = |bounds: &Aabb, ray: &Ray| {
                let (low, high) = bounds.interval(ray);
                low <= high
            };
            boxes.iter().map(|bounds| rays.iter().filter(|ray| entered(bounds, ray)).count()).sum::<usize>()
        });
    });
}

fn kernels(c: &mut Criterion) {
    triangle(c);
    sphere(c);
    slab(c);
}

criterion_group!(all, kernels);
criterion_main!(all);
