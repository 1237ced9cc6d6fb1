//! `--denoise`: the raw picture stays, and the other one is nearer to the truth.
//!
//! Open Image Denoise is where `OIDN_LIB` says (PyPI's `pyoidn` has it in `pyoidn/oidn/lib`) or where the system has
//! libraries; without it, what needs it is skipped, aloud.

#![allow(missing_docs)]

mod program;

use std::{env, fs, path::Path};

use packlight::{
    compare::difference,
    denoise::Denoiser,
    picture::{Channel, Encoding, Picture, decode, exr_attributes},
};
use program::{command, fails, folder, packlight, path, stderr, stdout};

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell.xml");

/// Exit code 1 where `OIDN_LIB` is this place, and all of these in the message.
fn fails_without_library(arguments: &[&str], place: &str, parts: &[&str]) {
    let output = command(arguments).env("OIDN_LIB", place).output().expect("the program starts");
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    for part in parts {
        assert!(stderr(&output).contains(part), "{part} is not in\n{}", stderr(&output));
    }
}

fn has_library() -> bool {
    let found = Denoiser::load(env::var_os("OIDN_LIB").as_deref(), 1);
    if let Err(error) = &found {
        println!("skipped: {error}");
    }
    found.is_ok()
}

fn render(out: &str, more: &[&str]) -> String {
    let words = ["render", SCENE, "-o", out, "--width", "96", "--json", "--threads", "2"];
    let output = packlight(&[&words[..], more].concat());
    assert_eq!(output.status.code(), Some(0), "{more:?}: {}", stderr(&output));
    stdout(&output)
}

fn read(file: &str) -> Picture {
    decode(file.as_ref(), Encoding::Raw).expect("it was written")
}

fn names(file: &str) -> Vec<String> {
    let image = exr::prelude::read_all_flat_layers_from_file(file).expect("it was written");
    image.layer_data[0].channel_data.list.iter().map(|channel| channel.name.to_string()).collect()
}

#[test]
fn without_the_library_it_is_said_what_was_looked_for_before_anything_is_rendered() {
    let folder = folder("denoise/nowhere");
    let out = path(&folder, "out.exr");
    let words = ["render", SCENE, "-o", &out, "--denoise", "--spp", "1", "--width", "8"];
    let parts = ["--denoise: Open Image Denoise 2 was not found; looked for", "OIDN_LIB=PATH"];
    fails_without_library(&words, "/no/such/library.so", &[&parts[..], &["/no/such/library.so"]].concat());
    let nothing = folder.display().to_string();
    fails_without_library(&words, &nothing, &[&parts[..], &[&nothing, "OpenImageDenoise"]].concat());
    // A file that is no library, and one that is another.
    fails_without_library(&words, SCENE, &parts);
    assert!(!Path::new(&out).exists());
}

#[test]
fn what_has_no_noise_of_light_is_refused() {
    let folder = folder("denoise/refused");
    let out = path(&folder, "out.exr");
    let refused = |more: &[&str], part: &str| {
        fails(&[&["render", SCENE, "-o", &out, "--denoise"], more].concat(), 2, part);
    };
    refused(&["--integrator", "aov"], "the aov integrator does not write");
    refused(&["--shard", "1/2"], "a shard has none");
}

#[test]
fn the_raw_picture_stays_and_the_other_is_nearer_to_the_truth() {
    if !has_library() {
        return;
    }
    let folder = folder("denoise/nearer");
    let file = |name: &str| path(&folder, name);
    render(&file("truth.exr"), &["--spp", "512"]);
    render(&file("raw.exr"), &["--spp", "16"]);
    let told = render(&file("out.exr"), &["--spp", "16", "--denoise"]);
    // Not a byte differs: it does not even know that there is another.
    assert!(fs::read(file("raw.exr")).expect("written") == fs::read(file("out.exr")).expect("written"));
    let told: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    assert_eq!(told["denoised"]["output"], file("out.denoised.exr").as_str());
    let by = told["denoised"]["by"].as_str().expect("a name");
    assert!(by.starts_with("Open Image Denoise 2."), "{by}");
    let said = exr_attributes(&fs::read(file("out.denoised.exr")).expect("written"));
    assert!(said.contains(&("packlight.denoiser".into(), by.into())), "{said:?}");
    let truth = read(&file("truth.exr"));
    let error = |name: &str| difference(&truth, &read(&file(name))).expect("of one size").rel_mse;
    let (noisy, clean) = (error("out.exr"), error("out.denoised.exr"));
    assert!(clean < 0.2 * noisy, "relMSE {clean}, and {noisy} before");
    assert_eq!(names(&file("out.denoised.exr")), ["B", "G", "R"]);
}

/// What the camera sees besides is a hint: with other layers other pictures come out.
#[test]
fn albedo_and_normals_are_looked_at() {
    if !has_library() {
        return;
    }
    let (width, height) = (64, 64);
    let plane = |name: &str, value: &dyn Fn(u32, u32) -> f32| Channel {
        name: name.into(),
        samples: (0..width * height).map(|i| value(i % width, i / width)).collect(),
    };
    let grain =
        |x: u32, y: u32| (x * 7919 + y * 104_729).wrapping_mul(2_654_435_761) as f32 / u32::MAX as f32;
    let stripes = |x: u32, _: u32| if (x / 8).is_multiple_of(2) { 0.2 } else { 0.8 };
    let mut channels: Vec<Channel> = ["R", "G", "B"].map(|name| plane(name, &grain)).into();
    channels.extend(["flat.R", "flat.G", "flat.B"].map(|name| plane(name, &|_, _| 0.5)));
    channels.extend(["stripes.R", "stripes.G", "stripes.B"].map(|name| plane(name, &stripes)));
    let picture = Picture { width, height, channels, place: None };
    let denoiser = Denoiser::load(env::var_os("OIDN_LIB").as_deref(), 1).expect("it was there");
    let (flat, stripes) = (["flat.R", "flat.G", "flat.B"], ["stripes.R", "stripes.G", "stripes.B"]);
    let red = |albedo, normal| {
        denoiser.denoise(&picture, albedo, normal).expect("denoised").plane("R").expect("red").to_vec()
    };
    let usual = red(flat, flat);
    assert!(usual != red(stripes, flat) && usual != red(flat, stripes));
}

/// The program hands over the layers that the camera sees, each in its place.
#[test]
fn the_program_shows_albedo_and_normals() {
    if !has_library() {
        return;
    }
    let folder = folder("denoise/layers");
    let out = path(&folder, "out.exr");
    render(&out, &["--spp", "8", "--denoise", "--aov", "albedo,normal"]);
    let channels = exr::prelude::read_all_flat_layers_from_file(&out).expect("it was written");
    let layer = &channels.layer_data[0];
    let channel = |channel: &exr::prelude::AnyChannel<exr::prelude::FlatSamples>| Channel {
        name: channel.name.to_string(),
        samples: channel.sample_data.values_as_f32().collect(),
    };
    let picture = Picture {
        width: layer.size.width() as u32,
        height: layer.size.height() as u32,
        channels: layer.channel_data.list.iter().map(channel).collect(),
        place: None,
    };
    let denoiser = Denoiser::load(env::var_os("OIDN_LIB").as_deref(), 2).expect("it was there");
    let (albedo, normal) = (["albedo.R", "albedo.G", "albedo.B"], ["normal.X", "normal.Y", "normal.Z"]);
    let told = read(&path(&folder, "out.denoised.exr"));
    let error = |albedo, normal| {
        let here = denoiser.denoise(&picture, albedo, normal).expect("denoised");
        difference(&here, &told).expect("of one size").rel_mse
    };
    let same = error(albedo, normal);
    for (other, which) in [(error(albedo, albedo), "normal"), (error(normal, normal), "albedo")] {
        assert!(same < 1e-9 && other > 1e-6, "relMSE {same}, with another {which} {other}");
    }
}

#[test]
fn layers_and_formats_are_those_that_were_asked_for() {
    if !has_library() {
        return;
    }
    let folder = folder("denoise/formats");
    let file = |name: &str| path(&folder, name);
    let both_have = |name: &str, channels: &[&str]| {
        for end in ["exr", "denoised.exr"] {
            assert_eq!(names(&file(&format!("{name}.{end}"))), channels, "{name}.{end}");
        }
    };
    let few = ["--spp", "4", "--denoise"];
    render(&file("a.exr"), &[&few[..], &["--aov", "depth,normal"]].concat());
    let asked = ["B", "G", "R", "depth.Z", "normal.X", "normal.Y", "normal.Z"];
    both_have("a", &asked);
    for extension in ["png", "hdr"] {
        render(&file(&format!("b.{extension}")), &few);
        assert!(Path::new(&file(&format!("b.denoised.{extension}"))).exists());
    }
    let grey = file("grey.xml");
    let text = fs::read_to_string(SCENE).expect("readable");
    let format = "<film type=\"hdrfilm\"><string name=\"pixel_format\" value=\"luminance_alpha\"/>";
    fs::write(&grey, text.replacen("<film type=\"hdrfilm\">", format, 1)).expect("writable");
    let words = ["render", &grey, "-o", &file("c.exr"), "-q", "--width", "40"];
    let output = packlight(&[&words[..], &few].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    both_have("c", &["A", "Y"]);
}

#[test]
fn what_was_stopped_is_denoised_and_can_go_on() {
    if !has_library() {
        return;
    }
    let folder = folder("denoise/stopped");
    let file = |name: &str| path(&folder, name);
    let endless = ["--spp", "100000", "--time-limit", "300ms", "--denoise"];
    render(&file("part.exr"), &endless);
    assert_eq!(names(&file("part.denoised.exr")), ["B", "G", "R"]);
    render(&file("more.exr"), &[&endless[..], &["--resume", &file("part.exr")]].concat());
    let whole = ["--spp", "24", "--denoise"];
    let kept = file("kept.exr");
    render(&file("fewer.exr"), &["--spp", "9", "--denoise", "--checkpoint", &kept]);
    render(&file("resumed.exr"), &[&whole[..], &["--resume", &kept]].concat());
    render(&file("whole.exr"), &whole);
    assert!(fs::read(file("resumed.exr")).expect("written") == fs::read(file("whole.exr")).expect("written"));
}
