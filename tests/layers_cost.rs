//! Layers cost next to nothing: what the camera sees is known before light is asked for.

#![allow(missing_docs)]

use std::{
    hint::black_box,
    path::Path,
    sync::{Mutex, PoisonError},
    time::Instant,
};

use packlight::{
    compile::{Scene, compile},
    load::{LoadOptions, load},
    render::{Settings, render},
    scene::{Aov, AovChannel, Film},
};

/// The most that a render may take with six layers, as a multiple of what it takes without.
const MOST: f64 = 1.1;

/// Renders of each kind, in turn, before it is believed that it takes longer. Whatever else the machine does makes
/// some of them slower, and none of them faster.
const TURNS: usize = 200;
/// Turns before it is believed that it does not: the first ones are as slow as chance has it.
const AT_LEAST: usize = 20;

static ALONE: Mutex<()> = Mutex::new(());

/// A picture of 96 × 96 pixels.
fn scene(name: &str, samples: u32, layers: &[(&str, Aov)]) -> Scene {
    let path = Path::new("scenes").join(name).with_extension("xml");
    let mut scene = load(&path, &LoadOptions::default()).expect("it loads").description;
    scene.sensor.film = Film::new(96, 96);
    scene.sensor.sampler.sample_count = samples;
    scene.aovs = layers.iter().map(|&(name, kind)| AovChannel { name: name.into(), kind }).collect();
    compile(&scene).expect("it compiles")
}

fn six_layers_take_no_more_than_a_tenth(name: &str, samples: u32) {
    if cfg!(debug_assertions) {
        return println!("skipped: times are those of release builds");
    }
    let six = [
        ("albedo", Aov::DirectionalAlbedo),
        ("normal", Aov::ShNormal),
        ("depth", Aov::Depth),
        ("position", Aov::Position),
        ("uv", Aov::Uv),
        ("material_id", Aov::MaterialId),
    ];
    let scenes = [scene(name, samples, &[]), scene(name, samples, &six)];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be had");
    let seconds = |scene: &Scene| {
        let start = Instant::now();
        black_box(pool.install(|| render(scene, &Settings::default(), &|_| {})));
        start.elapsed().as_secs_f64()
    };
    // The other test would run at the same time.
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut least = [f64::INFINITY; 2];
    let mut ratio = f64::INFINITY;
    for turn in 0..TURNS {
        least = std::array::from_fn(|kind| least[kind].min(seconds(&scenes[kind])));
        ratio = least[1] / least[0];
        if turn >= AT_LEAST && ratio <= MOST {
            return println!("{name}: {ratio:.3} times as long after {} turns", turn + 1);
        }
    }
    panic!("{name}: six layers take {ratio:.3} times as long, which may be {MOST}");
}

#[test]
fn where_light_goes_from_wall_to_wall() {
    six_layers_take_no_more_than_a_tenth("cornell", 16);
}

/// Here a sample costs least, and layers the most beside it.
#[test]
fn where_light_goes_no_farther_than_mirrors_and_glass() {
    six_layers_take_no_more_than_a_tenth("whitted", 32);
}
