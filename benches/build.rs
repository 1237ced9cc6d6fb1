//! Trees of each quality over generated meshes, on one thread and on all. An element is a primitive.

use criterion::{BatchSize, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use packlight::{
    bvh::{Bvh, Quality, Reference},
    geometry::Triangle,
    load::generate,
};

fn references(spec: &str) -> Vec<Reference> {
    let mesh = generate::mesh(spec).expect("a mesh that can be made");
    let triangle = |corners: &[u32; 3]| {
        let [v0, v1, v2] = corners.map(|i| mesh.positions[i as usize]);
        Triangle::new(v0, v1, v2)
    };
    let boxes = mesh.triangles.iter().map(|corners| triangle(corners).bounds());
    boxes.enumerate().map(|(i, bounds)| Reference::new(bounds, i as u32, 0)).collect()
}

fn build(c: &mut Criterion) {
    for spec in ["soup:100k", "terrain:100k"] {
        let references = references(spec);
        let mut group = c.benchmark_group(format!("build/{spec}"));
        group.throughput(Throughput::Elements(references.len() as u64));
        group.sampling_mode(SamplingMode::Flat).sample_size(10);
        for (name, threads) in [("1 thread", 1), ("all threads", 0)] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
            for quality in [Quality::Fast, Quality::Medium, Quality::High] {
                group.bench_function(format!("{quality:?}, {name}"), |b| {
                    let run = |references| pool.install(|| Bvh::build_with(references, quality));
                    b.iter_batched(|| references.clone(), run, BatchSize::LargeInput);
                });
            }
        }
    }
}

criterion_group!(all, build);
criterion_main!(all);
