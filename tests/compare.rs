//! Differences between pictures: FLIP against its authors' program, and the command as a shell sees it.

#![allow(missing_docs)]

mod program;

use std::fs;

use packlight::{
    compare::{flip_hdr, flip_ldr},
    picture::{Channel, Picture, Preview, save},
};
use program::{folder, packlight, path};

const WIDTH: u32 = 64;
const HEIGHT: u32 = 48;

/// A pattern, and the same with tiles that are darker or have brighter specks.
fn pattern(test: bool, curve: impl Fn(f32) -> f32) -> Picture {
    let value = |x: u32, y: u32, c: u32| {
        let r = ((x * x + 3 * y + 17 * c) % 97) as f32 / 97.0;
        let speck = if (x + y).is_multiple_of(3) { 0.1 } else { 0.0 };
        match test {
            false => r,
            true if (x / 8 + y / 8).is_multiple_of(2) => r * 0.8,
            true => (r + speck).min(1.0),
        }
    };
    let plane = |c: u32| (0..WIDTH * HEIGHT).map(|i| curve(value(i % WIDTH, i / WIDTH, c))).collect();
    let channels = ["R", "G", "B"].into_iter().zip(0..);
    let channels = channels.map(|(name, c)| Channel { name: name.into(), samples: plane(c) });
    Picture { width: WIDTH, height: HEIGHT, channels: channels.collect(), place: None }
}

fn light(x: f32) -> f32 {
    8.0 * x * x
}

/// What `flip-evaluator` 1.7 says of the same numbers: the mean, and five pixels.
const LDR: (f64, [f32; 5]) =
    (0.212_888_35, [0.281_300_3, 0.152_009_7, 0.199_247_75, 0.282_894_37, 0.212_126_23]);
const HDR: (f64, [f32; 5]) = (0.229_072_57, [0.458_198, 0.140_961_48, 0.177_361_64, 0.333_819_57, 0.151_333]);
const PLACES: [(u32, u32); 5] = [(0, 0), (10, 20), (33, 7), (63, 47), (40, 40)];

fn agrees(errors: &[f32], (mean, pixels): (f64, [f32; 5])) {
    let ours = errors.iter().map(|&error| f64::from(error)).sum::<f64>() / errors.len() as f64;
    assert!((ours - mean).abs() < 1e-5, "{ours} {mean}");
    for ((x, y), expected) in PLACES.into_iter().zip(pixels) {
        let error = errors[(y * WIDTH + x) as usize];
        assert!((error - expected).abs() < 1e-5, "({x}, {y}): {error} {expected}");
    }
}

#[test]
fn flip_is_that_of_its_authors() {
    let same = |x: f32| x;
    agrees(&flip_ldr(&pattern(false, same), &pattern(true, same)).expect("equal sizes"), LDR);
    agrees(&flip_hdr(&pattern(false, light), &pattern(true, light)).expect("equal sizes"), HDR);
}

#[test]
fn the_command_tells_draws_and_judges() {
    let folder = folder("compare");
    let [reference, test, drawn] = ["reference.exr", "test.exr", "drawn.png"].map(|name| path(&folder, name));
    save(&pattern(false, light), reference.as_ref(), Preview::default()).expect("writable");
    save(&pattern(true, light), test.as_ref(), Preview::default()).expect("writable");

    let output = packlight(&["compare", &reference, &test, "-o", &drawn, "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(json["flip"].as_f64().is_some_and(|flip| (flip - HDR.0).abs() < 1e-5), "{json}");
    assert_eq!(json["flip_kind"], "hdr");
    assert_eq!(json["output"], drawn.as_str());
    assert!(json["mean_ratio"][0].as_f64().is_some_and(|ratio| ratio > 0.7 && ratio < 1.0), "{json}");
    assert!(fs::read(&drawn).expect("it was written").starts_with(b"\x89PNG"));

    let told = packlight(&["compare", &reference, &test, "-o", &drawn]);
    assert!(String::from_utf8_lossy(&told.stdout).contains(&format!(" -> {drawn}\n")), "{told:?}");

    let judged = packlight(&["compare", &reference, &test, "--max-flip", "0.1"]);
    assert_eq!(judged.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&judged.stderr).contains("FLIP is 0.229"), "{judged:?}");
    let same = packlight(&["compare", &test, &test, "--max-flip", "0"]);
    assert_eq!(same.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&same.stdout).contains("the same to the bit"));

    let missing = packlight(&["compare", &reference, "no-such.exr"]);
    assert_eq!(missing.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("no-such.exr"));
}
