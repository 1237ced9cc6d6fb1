//! The contract of bits: by whatever way through the tree, on one thread or several, sorted or not, on every
//! instruction set, a scene is one picture.
//!
//! Every scene in `scenes/` is rendered small, at a size that leaves tiles and packets partly empty.
//! Within one build its pictures are compared channel by channel, bit by bit; across builds they are
//! compared by [`FROZEN`] hashes, which SSE2, AVX2 and AVX-512 must all give.

#![allow(missing_docs)]

use std::{
    fs,
    path::{Path, PathBuf},
};

use packlight::{
    bvh::Way,
    compile::{Scene, compile},
    load::{LoadOptions, load},
    picture::Picture,
    render::{Backend, Route, Settings, render, replay},
    scene::{Aov, AovChannel, Film, Integrator, Projection, ReconstructionFilter, SceneDescription},
};

/// FNV-1a of each scene's picture by its own integrator, at [`FILM`] and [`SAMPLES`].
///
/// A hash changes when the picture is *meant* to change: by an edit of the scene, another estimator,
/// another order of random numbers. Then run this test, look at the new picture, take the hash from the
/// complaint, and say why in CHANGELOG.md. A hash that changes without such a reason, or on one
/// instruction set only, is a broken contract, and no hash is to be taken from it.
const FROZEN: &[(&str, u64)] = &[
    ("cornell", 0x2c74_84e5_70ba_b335),
    ("harmonics", 0xe155_45d8_dad9_f219),
    ("instances", 0x2fe4_67e6_df58_c026),
    ("materials", 0x9831_d80a_51b1_123b),
    ("mesh", 0xf6bf_ed24_66a5_735e),
    ("painted", 0xa3f0_51e9_e05e_0b3a),
    ("sky", 0xc2d0_ecd2_0935_bc66),
    ("spheres", 0xd054_a925_b09b_325c),
    ("whitted", 0xde1e_e07d_d10c_2ffd),
];

/// Four tiles of 32 × 32 at most, 32 × 3 and 11 × 3 pixels among them.
const FILM: Film = Film::new(43, 35);
/// Not a power of two.
const SAMPLES: u32 = 3;
/// Taken one, two, four and eight at a time.
const MANY_SAMPLES: u32 = 23;

const PACKET: Settings = Settings { backend: Backend::Packet, sort: true, route: Route::Stream(Way::Chosen) };

/// Everything that must not be seen in a picture: which pipeline, how rays go through the tree, in which
/// order hits are shaded, by how many threads.
fn ways() -> impl Iterator<Item = (String, Settings, usize)> {
    let stream = |way| Settings { route: Route::Stream(way), ..PACKET };
    let kinds = [
        ("scalar", Settings { backend: Backend::Scalar, ..PACKET }),
        ("chosen", PACKET),
        ("packet", stream(Way::Packet)),
        ("tile", stream(Way::Tile)),
        ("wave", stream(Way::Wave)),
        ("single", Settings { route: Route::Single, ..PACKET }),
    ];
    let sorted = |(name, settings)| {
        [("sorted", true), ("unsorted", false)]
            .map(|(order, sort)| (name, order, Settings { sort, ..settings }))
    };
    kinds.into_iter().flat_map(sorted).flat_map(|(name, order, settings)| {
        [1, 2, 3].map(|threads| (format!("{name}, {order}, {threads} threads"), settings, threads))
    })
}

/// All files `scenes/*.xml`, by name.
fn scenes() -> Vec<(String, PathBuf)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let entries = fs::read_dir(folder).expect("scenes/ can be read");
    let paths = entries.map(|entry| entry.expect("scenes/ can be read").path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|extension| extension == "xml"));
    let mut scenes: Vec<_> =
        scenes.map(|path| (path.file_stem().expect("a name").to_string_lossy().into_owned(), path)).collect();
    scenes.sort();
    assert!(!scenes.is_empty(), "scenes/ holds no .xml");
    scenes
}

fn description(path: &Path) -> SceneDescription {
    let loaded = load(path, &LoadOptions::default()).expect("a scene of ours loads");
    assert!(loaded.warnings.is_empty(), "{}: {}", path.display(), loaded.warnings[0]);
    let mut description = loaded.description;
    description.sensor.film = FILM;
    description.sensor.sampler.sample_count = SAMPLES;
    description
}

/// Compiled and rendered on a pool of this many threads.
fn on_threads(threads: usize, scene: &Scene, settings: &Settings) -> Picture {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
    let rendered = pool.install(|| render(scene, settings, &|_| {}));
    assert_eq!(rendered.statistics.invalid_samples, 0, "a sample is not finite");
    rendered.picture
}

/// The first difference, if any, as a place in the picture.
fn difference(one: &Picture, other: &Picture) -> Option<String> {
    assert_eq!((one.width, one.height), (other.width, other.height));
    assert_eq!(one.channels.len(), other.channels.len());
    for (a, b) in one.channels.iter().zip(&other.channels) {
        assert_eq!(a.name, b.name);
        assert_eq!(a.samples.len(), b.samples.len());
        let mut pairs = a.samples.iter().zip(&b.samples).enumerate();
        if let Some((i, (x, y))) = pairs.find(|(_, (x, y))| x.to_bits() != y.to_bits()) {
            let (column, row) = (i % one.width as usize, i / one.width as usize);
            return Some(format!("channel {} of pixel ({column}, {row}) is {x:?}, not {y:?}", a.name));
        }
    }
    None
}

/// One of each kind.
fn channels() -> Vec<AovChannel> {
    [
        ("depth", Aov::Depth),
        ("position", Aov::Position),
        ("uv", Aov::Uv),
        ("geo_normal", Aov::GeoNormal),
        ("sh_normal", Aov::ShNormal),
        ("directional_albedo", Aov::DirectionalAlbedo),
        ("material_id", Aov::MaterialId),
        ("primitive_id", Aov::PrimitiveId),
        ("nodes", Aov::Nodes),
        ("primitives", Aov::Primitives),
    ]
    .map(|(name, kind)| AovChannel { name: name.into(), kind })
    .into()
}

/// Each integrator with its usual parameters; the first is the scene's own.
fn integrators(own: &Integrator) -> Vec<(&'static str, Integrator)> {
    let others = [
        ("whitted", Integrator::Whitted { max_depth: 7 }),
        ("direct", Integrator::Direct { hide_emitters: false }),
        // Roulette begins early, so that it is seen in paths of this length.
        ("path", Integrator::Path { max_depth: Some(9), rr_depth: 2, hide_emitters: true }),
        ("ao", Integrator::AmbientOcclusion { distance: 1.5 }),
        ("irradiance", Integrator::Irradiance { max_depth: Some(5), rr_depth: 2 }),
        ("aov", Integrator::Aov { channels: channels() }),
    ];
    [("own integrator", own.clone())].into_iter().chain(others).collect()
}

/// 64-bit FNV-1a over the bits of every channel, least significant byte first.
fn hash(picture: &Picture) -> u64 {
    let bytes =
        picture.channels.iter().flat_map(|channel| &channel.samples).flat_map(|x| x.to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A scene of ours, seen through a lens.
fn through_a_lens(mut description: SceneDescription) -> SceneDescription {
    let Projection::Perspective { x_fov } = description.sensor.projection else { panic!("not a pinhole") };
    description.sensor.projection = Projection::ThinLens { x_fov, aperture_radius: 0.1, focus_distance: 2.5 };
    description
}

/// A scene of ours, by another filter.
fn filtered(mut description: SceneDescription, filter: ReconstructionFilter) -> SceneDescription {
    description.sensor.film.filter = filter;
    description
}

#[test]
fn a_lens_and_every_filter_give_the_same_bits_every_way() {
    let (_, path) = scenes().into_iter().find(|(name, _)| name == "cornell").expect("there is a Cornell box");
    let plain = description(&path);
    let unchanged = on_threads(1, &compile(&plain).expect("a scene of ours compiles"), &PACKET);
    let filters = [
        ReconstructionFilter::Tent { radius: 1.0 },
        ReconstructionFilter::Gaussian { stddev: 0.5 },
        ReconstructionFilter::Mitchell { b: 0.5, c: 0.25 },
        ReconstructionFilter::CatmullRom,
        ReconstructionFilter::Lanczos { lobes: 2 },
    ];
    let filtered = filters.map(|filter| (format!("{filter:?}"), filtered(plain.clone(), filter)));
    for (what, changed) in [("a lens".into(), through_a_lens(plain.clone()))].into_iter().chain(filtered) {
        let scene = compile(&changed).expect("a scene of ours compiles");
        let packet = on_threads(1, &scene, &PACKET);
        assert!(difference(&packet, &unchanged).is_some(), "{what}: nothing is to be seen of it");
        for (way, settings, threads) in ways() {
            let difference = difference(&on_threads(threads, &scene, &settings), &packet);
            assert!(difference.is_none(), "{what}, {way}: {}", difference.unwrap_or_default());
        }
    }
}

#[test]
fn every_way_to_render_gives_the_same_bits() {
    for (name, path) in scenes() {
        let mut scene = compile(&description(&path)).expect("a scene of ours compiles");
        for (integrator, chosen) in integrators(&scene.integrator) {
            scene.integrator = chosen;
            let packet = on_threads(1, &scene, &PACKET);
            let values = packet.channels.iter().flat_map(|channel| &channel.samples);
            assert!(values.copied().any(|x| x != 0.0), "{name}, {integrator}: nothing is to be seen");
            for (way, settings, threads) in ways() {
                if let Some(difference) = difference(&on_threads(threads, &scene, &settings), &packet) {
                    panic!("scenes/{name}.xml, {integrator}, {way}: {difference}");
                }
            }
        }
    }
}

/// Samples that are taken together are those that the reference takes one by one.
#[test]
fn many_samples_have_the_same_bits_together() {
    for (name, path) in scenes() {
        let mut plain = description(&path);
        plain.sensor.sampler.sample_count = MANY_SAMPLES;
        let mut scene = compile(&plain).expect("a scene of ours compiles");
        for (integrator, chosen) in integrators(&plain.integrator) {
            scene.integrator = chosen;
            scene.aovs = if integrator == "own integrator" { channels() } else { Vec::new() };
            let one_by_one = on_threads(2, &scene, &Settings { backend: Backend::Scalar, ..PACKET });
            for (sort, threads) in [(true, 1), (false, 2)] {
                let together = on_threads(threads, &scene, &Settings { sort, ..PACKET });
                if let Some(difference) = difference(&together, &one_by_one) {
                    panic!("scenes/{name}.xml, {integrator}, sort {sort}: {difference}");
                }
            }
        }
    }
}

#[test]
fn layers_beside_the_picture_have_the_same_bits_every_way() {
    for (name, path) in scenes() {
        let plain = description(&path);
        let mut scene = compile(&plain).expect("a scene of ours compiles");
        let light = on_threads(1, &scene, &PACKET);
        scene.integrator = Integrator::Aov { channels: channels() };
        let seen = on_threads(1, &scene, &PACKET);
        (scene.integrator, scene.aovs) = (plain.integrator.clone(), channels());
        let packet = on_threads(1, &scene, &PACKET);
        for (way, settings, threads) in ways() {
            let difference = difference(&on_threads(threads, &scene, &settings), &packet);
            assert!(difference.is_none(), "{name}, {way}: {}", difference.unwrap_or_default());
        }
        // They are what the `aov` integrator sees, and light does not notice them.
        let apart = light.channels.iter().chain(&seen.channels);
        assert_eq!(light.channels.len() + seen.channels.len(), packet.channels.len());
        for (one, other) in apart.zip(&packet.channels) {
            let bits = |x: &[f32]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert!(bits(&one.samples) == bits(&other.samples), "{name}: {}", other.name);
        }
    }
}

/// A sample by itself is what it is in the picture.
#[test]
fn samples_are_replayed_to_the_bit() {
    for (name, path) in scenes() {
        let scene = compile(&description(&path)).expect("a scene of ours compiles");
        let picture = on_threads(2, &scene, &PACKET);
        for (x, y) in [(0, 0), (21, 17), (33, 34), (42, 20)] {
            for (_, settings, _) in ways().filter(|(_, _, threads)| *threads == 1) {
                let samples: Vec<_> =
                    (0..SAMPLES).map(|sample| replay(&scene, &settings, (x, y), sample)).collect();
                for (c, channel) in picture.channels.iter().enumerate() {
                    let sum = samples.iter().fold(0.0, |sum, sample| sum + sample[c].1);
                    let seen = channel.samples[(y * FILM.width + x) as usize];
                    assert_eq!(samples[0][c].0, channel.name);
                    assert_eq!((sum / SAMPLES as f32).to_bits(), seen.to_bits(), "{name}, ({x}, {y})");
                }
            }
        }
    }
}

#[test]
fn the_tree_does_not_depend_on_the_threads_that_build_it() {
    for (name, path) in scenes() {
        let description = description(&path);
        let pictures = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let scene = pool.expect("threads can be started").install(|| compile(&description));
            on_threads(1, &scene.expect("a scene of ours compiles"), &PACKET)
        });
        assert_eq!(difference(&pictures[0], &pictures[1]), None, "scenes/{name}.xml");
    }
}

#[test]
fn every_instruction_set_gives_the_frozen_picture() {
    let mut complaints = Vec::new();
    let scenes = scenes();
    for (name, path) in &scenes {
        let scene = compile(&description(path)).expect("a scene of ours compiles");
        let hash = hash(&on_threads(2, &scene, &PACKET));
        match FROZEN.iter().find(|(frozen, _)| frozen == name) {
            Some((_, frozen)) if *frozen == hash => {}
            Some((_, frozen)) => {
                complaints.push(format!("{name}: {hash:#018x}, but {frozen:#018x} is frozen"));
            }
            None => complaints.push(format!("{name}: {hash:#018x} is not frozen yet")),
        }
    }
    for (frozen, _) in FROZEN {
        if !scenes.iter().any(|(name, _)| name == frozen) {
            complaints.push(format!("{frozen} is frozen, but scenes/{frozen}.xml is gone"));
        }
    }
    let lanes = packlight::simd::cpu::compiled();
    assert!(complaints.is_empty(), "lanes: {lanes}\n{}\n", complaints.join("\n"));
}

/// What no scene has, no test here compares.
#[test]
fn the_scenes_between_them_have_everything() {
    let read = |(_, path): &(String, PathBuf)| fs::read_to_string(path).expect("a scene can be read");
    let text: String = scenes().iter().map(read).collect();
    let shapes = ["sphere", "rectangle", "cube", "disk", "cylinder", "obj", "ply", "shapegroup", "instance"];
    let materials = [
        "diffuse",
        "conductor",
        "roughconductor",
        "dielectric",
        "roughdielectric",
        "plastic",
        "roughplastic",
        "principled",
        "phong",
        "ward",
        "toon",
        "twosided",
        "mask",
        "blendbsdf",
        "bumpmap",
        "normalmap",
    ];
    let others =
        ["bitmap", "checkerboard", "area", "point", "spot", "directional", "constant", "envmap", "shlight"];
    for kind in shapes.iter().chain(&materials).chain(&others) {
        assert!(text.contains(&format!(" type=\"{kind}\"")), "no scene has a `{kind}`");
    }
}

/// {scalar, packet, tile, wave, single} and what is chosen, {sorted, unsorted}, {1, 2, 3} threads.
#[test]
fn the_matrix_is_whole() {
    let settings: Vec<_> = ways().map(|(_, settings, threads)| (settings, threads)).collect();
    assert_eq!(settings.len(), 6 * 2 * 3);
    for (i, one) in settings.iter().enumerate() {
        assert!(!settings[..i].contains(one), "{one:?} twice");
    }
}

#[test]
fn one_bit_is_a_difference() {
    let channel = |x: f32| packlight::picture::Channel { name: "R".into(), samples: vec![1.0, x] };
    let picture = |x: f32| Picture { width: 2, height: 1, channels: vec![channel(x)], place: None };
    assert_eq!(difference(&picture(0.5), &picture(0.5)), None);
    assert!(difference(&picture(0.0), &picture(-0.0)).is_some_and(|text| text.contains("(1, 0)")));
    assert_ne!(hash(&picture(0.0)), hash(&picture(-0.0)));
    assert_eq!(hash(&Picture::default()), 0xcbf2_9ce4_8422_2325);
}
