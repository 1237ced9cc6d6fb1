//! Rays through trees: packets and single rays. An element is a ray.
//!
//! `primary` are coherent rays of a camera, `random` start and point anywhere, `shadow` only ask whether
//! they are blocked. Generated meshes are always there; known ones are measured if their folder is
//! beside this repository.

use std::hint::black_box;

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use packlight::{
    bvh::Traversal,
    compile::Scene,
    geometry::{Hit, Ray32},
    render::ray_classes,
};

mod meshes;
mod random;
use random::Random;

const MESHES: [(&str, &str); 5] = [
    ("soup 100k", "gen:soup:100k"),
    ("terrain 100k", "gen:terrain:100k"),
    ("hair 100k", "gen:hair:100k"),
    ("bunny", "../shared/scenes/meshes/stanford-bunny.obj"),
    ("dragon", "../shared/scenes/meshes/dragon.ply"),
];

/// From anywhere about a hit of the camera's rays, to anywhere.
fn random_rays(scene: &Scene, primary: &[Ray32]) -> Vec<Ray32> {
    let mut random = Random::new(7);
    let mut hits = vec![Hit::MISS; primary.len()];
    scene.closest_hits(primary, &mut hits);
    let near = primary.iter().zip(&hits).filter(|(_, hit)| hit.t.is_finite());
    near.map(|(ray, hit)| {
        let (org, dir) = (Vec3::from(ray.org), Vec3::from(ray.dir));
        let start = org + dir * hit.t * (0.8 + 0.2 * random.number());
        Ray32::new(start, random.direction(), 0.0, f32::INFINITY)
    })
    .collect()
}

fn closest(c: &mut Criterion, name: String, scene: &Scene, rays: &[Ray32]) {
    let mut hits = vec![Hit::MISS; rays.len()];
    let mut group = c.benchmark_group(name);
    group
        .throughput(Throughput::Elements(rays.len() as u64))
        .sampling_mode(SamplingMode::Flat)
        .sample_size(10);
    group.bench_function("packet", |b| b.iter(|| scene.closest_hits(black_box(rays), &mut hits)));
    group.bench_function("single", |b| {
        let mut traversal = Traversal::new(());
        b.iter(|| {
            for (ray, hit) in black_box(rays).iter().zip(&mut hits) {
                *hit = scene.closest_hit(&ray.ray(), &mut traversal);
            }
        });
    });
}

fn occluded(c: &mut Criterion, name: String, scene: &Scene, rays: &[Ray32]) {
    let mut blocked = vec![0; rays.len()];
    let mut group = c.benchmark_group(name);
    group
        .throughput(Throughput::Elements(rays.len() as u64))
        .sampling_mode(SamplingMode::Flat)
        .sample_size(10);
    group.bench_function("packet", |b| b.iter(|| scene.occluded_stream(black_box(rays), &mut blocked)));
    group.bench_function("single", |b| {
        let mut traversal = Traversal::new(());
        b.iter(|| {
            for (ray, blocked) in black_box(rays).iter().zip(&mut blocked) {
                *blocked = u8::from(scene.occluded(&ray.ray(), &mut traversal));
            }
        });
    });
}

fn traversal(c: &mut Criterion) {
    for (name, path) in MESHES {
        let Some(scene) = meshes::scene(path) else {
            continue;
        };
        let classes = ray_classes(&scene);
        for class in &classes {
            match class.name {
                "primary" => {
                    closest(c, format!("{name}/primary"), &scene, &class.rays);
                    closest(c, format!("{name}/random"), &scene, &random_rays(&scene, &class.rays));
                }
                "shadow" => occluded(c, format!("{name}/shadow"), &scene, &class.rays),
                _ => {}
            }
        }
    }
}

criterion_group!(all, traversal);
criterion_main!(all);
