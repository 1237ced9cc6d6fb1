//! Each material's `eval` and `sample`, eight lanes and their scalar twin. An element is one point.

use std::hint::black_box;

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use packlight::{
    compile::compile,
    load::{LoadOptions, load},
    material::{
        Bsdf, Conductor, Dielectric, Distribution, Lambert, Microfacet, Phong, Principled, RoughConductor,
        RoughDielectric,
    },
    render::{Backend, Settings, render},
    scene::Film,
    simd::{LANES, Real, Vector3, f32x8},
};

mod random;
use random::Random;

/// Packets of points.
const PACKETS: usize = 64;

/// Lanes of these kinds of number.
struct Points<R> {
    wo: Vector3<R>,
    wi: Vector3<R>,
    lobe: R,
    u: (R, R),
}

fn points<R: Real>(count: usize) -> Vec<Points<R>> {
    let mut random = Random::new(5);
    (0..count)
        .map(|_| {
            let mut upward = || {
                let lanes: [Vec3; LANES] = std::array::from_fn(|_| {
                    let d = random.direction();
                    Vec3::new(d.x, d.y, d.z.abs().max(0.05)).normalize()
                });
                Vector3::from_fn(|i| lanes[i])
            };
            let (wo, wi) = (upward(), upward());
            let mut number = || R::from_fn(|_| random.number());
            Points { wo, wi, lobe: number(), u: (number(), number()) }
        })
        .collect()
}

fn models<R: Real>() -> [(&'static str, Bsdf<'static, R>); 7] {
    let color = Vector3::splat(Vec3::new(0.7, 0.5, 0.3));
    [
        ("lambert", Bsdf::Lambert(Lambert { reflectance: color })),
        (
            "phong",
            Bsdf::Phong(Phong {
                diffuse: color,
                specular: color.scale(R::splat(0.3)),
                exponent: R::splat(30.0),
            }),
        ),
        (
            "ggx",
            Bsdf::RoughConductor(RoughConductor {
                surface: Microfacet::new(Distribution::Ggx, R::splat(0.2), R::splat(0.3)),
                eta: Vector3::splat(Vec3::new(0.2, 0.92, 1.1)),
                k: Vector3::splat(Vec3::new(3.9, 2.45, 2.14)),
                reflectance: color,
            }),
        ),
        (
            "beckmann glass",
            Bsdf::RoughDielectric(RoughDielectric {
                surface: Microfacet::new(Distribution::Beckmann, R::splat(0.2), R::splat(0.2)),
                eta: R::splat(1.5),
                reflectance: color,
                transmittance: color,
            }),
        ),
        (
            "principled",
            Bsdf::Principled(Principled {
                base_color: color,
                roughness: R::splat(0.4),
                anisotropic: R::splat(0.3),
                metallic: R::splat(0.2),
                spec_trans: R::splat(0.1),
                eta: R::splat(1.5),
                spec_tint: R::splat(0.2),
                sheen: R::splat(0.3),
                sheen_tint: R::splat(0.5),
                flatness: R::splat(0.2),
                clearcoat: R::splat(0.5),
                clearcoat_gloss: R::splat(0.7),
            }),
        ),
        (
            "conductor",
            Bsdf::Conductor(Conductor {
                eta: Vector3::splat(Vec3::new(0.2, 0.92, 1.1)),
                k: Vector3::splat(Vec3::new(3.9, 2.45, 2.14)),
                reflectance: color,
            }),
        ),
        (
            "dielectric",
            Bsdf::Dielectric(Dielectric { eta: R::splat(1.5), reflectance: color, transmittance: color }),
        ),
    ]
}

/// A number that everything went into.
fn eval_and_sample<R: Real>(bsdf: &Bsdf<'_, R>, points: &[Points<R>]) -> R {
    points.iter().fold(R::zero(), |sum, p| {
        let sample = bsdf.sample(p.wo, p.lobe, p.u);
        let value = bsdf.eval(p.wo, p.wi) + sample.weight + sample.wi;
        sum + value.max_element() + bsdf.pdf(p.wo, p.wi)
    })
}

fn shading(c: &mut Criterion) {
    let (lanes, scalars) = (points::<f32x8>(PACKETS), points::<f32>(PACKETS * LANES));
    for ((name, wide), (_, narrow)) in models::<f32x8>().into_iter().zip(models::<f32>()) {
        let mut group = c.benchmark_group(name);
        group.throughput(Throughput::Elements((PACKETS * LANES) as u64));
        group.bench_function("x8", |b| b.iter(|| eval_and_sample(&black_box(wide), &lanes)));
        group.bench_function("scalar", |b| b.iter(|| eval_and_sample(&black_box(narrow), &scalars)));
    }
}

/// `scenes/materials.xml`: two dozen materials, sorted, as they come, and one at a time. An element is a
/// sample of a pixel, tracing included.
fn mixed(c: &mut Criterion) {
    let Ok(loaded) = load("scenes/materials.xml".as_ref(), &LoadOptions::default()) else { return };
    let mut description = loaded.description;
    description.sensor.film = Film::new(192, 128);
    description.sensor.sampler.sample_count = 4;
    let Ok(scene) = compile(&description) else { return };
    let mut group = c.benchmark_group("mixed");
    group.throughput(Throughput::Elements(192 * 128 * 4));
    group.sampling_mode(SamplingMode::Flat).sample_size(10);
    for (name, backend, sort) in [
        ("sorted", Backend::Packet, true),
        ("unsorted", Backend::Packet, false),
        ("scalar", Backend::Scalar, true),
    ] {
        let settings = Settings { backend, sort, ..Settings::default() };
        let lanes = render(&scene, &settings, &|_| {}).statistics.shade_lanes;
        if backend == Backend::Packet {
            println!("mixed, {name}: {:.1} % of the lanes of shading at work", 100.0 * lanes.ratio());
        }
        group.bench_function(name, |b| b.iter(|| render(&scene, &settings, &|_| {})));
    }
}

criterion_group!(all, shading, mixed);
criterion_main!(all);
