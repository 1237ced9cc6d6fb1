//! Whole pictures, small: every scene of `scenes/` and a generated mesh, eight rays at a time and one.
//! An element is a pixel sample.

use std::{fs, path::PathBuf};

use criterion::{Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use packlight::{
    compile::compile,
    load::{LoadOptions, load},
    render::{Backend, Settings, render},
    scene::{Film, SceneDescription},
};

mod meshes;

const WIDTH: u32 = 96;
const SAMPLES: u32 = 4;

/// Scenes of this repository, by name.
fn scenes() -> Vec<(String, SceneDescription)> {
    let entries = fs::read_dir("scenes").into_iter().flatten().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "xml"));
    paths.sort();
    let name = |path: &PathBuf| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let scene = |path: &PathBuf| load(path, &LoadOptions::default()).ok().map(|loaded| loaded.description);
    let mut scenes: Vec<_> = paths.iter().filter_map(|path| Some((name(path), scene(path)?))).collect();
    scenes.extend(meshes::describe("gen:terrain:100k").map(|scene| ("terrain 100k".to_owned(), scene)));
    scenes
}

fn pictures(c: &mut Criterion) {
    for (name, mut description) in scenes() {
        let Film { width, height, .. } = description.sensor.film;
        let height = (u64::from(WIDTH) * u64::from(height) / u64::from(width)).max(1) as u32;
        description.sensor.film = Film::new(WIDTH, height);
        description.sensor.sampler.sample_count = SAMPLES;
        let Ok(scene) = compile(&description) else {
            continue;
        };
        let mut group = c.benchmark_group(name);
        group.throughput(Throughput::Elements(u64::from(WIDTH * height * SAMPLES)));
        group.sampling_mode(SamplingMode::Flat).sample_size(10);
        for (backend, settings) in [("packet", Backend::Packet), ("scalar", Backend::Scalar)] {
            let settings = Settings { backend: settings, ..Settings::default() };
            group.bench_function(backend, |b| b.iter(|| render(&scene, &settings, &|_| {})));
        }
    }
}

criterion_group!(all, pictures);
criterion_main!(all);
