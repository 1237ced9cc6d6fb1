//! `--crop` and `--cropwindow`: a part of the picture is to the bit what it is in the whole one.

#![allow(missing_docs)]

mod program;

use std::{fs, path::Path};

use exr::prelude::read_all_flat_layers_from_file;
use packlight::picture::{Channel, Picture};
use program::{fails, folder, packlight, path, stderr};

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/cornell.xml");

/// Colours and two layers, several tiles, by two threads.
fn render(out: &str, more: &[&str]) {
    let words = ["render", SCENE, "-o", out, "--quiet", "--width", "90", "--height", "70", "--spp", "5"];
    let output = packlight(&[&words[..], &["--aov", "normal,depth", "--threads", "2"], more].concat());
    assert_eq!(output.status.code(), Some(0), "{more:?}: {}", stderr(&output));
}

/// All channels of an `.exr`.
fn read(file: &str) -> Picture {
    let image = read_all_flat_layers_from_file(file).expect("it was written");
    let layer = &image.layer_data[0];
    let channel = |channel: &exr::prelude::AnyChannel<exr::prelude::FlatSamples>| Channel {
        name: channel.name.to_string(),
        samples: channel.sample_data.values_as_f32().collect(),
    };
    Picture {
        width: layer.size.width() as u32,
        height: layer.size.height() as u32,
        channels: layer.channel_data.list.iter().map(channel).collect(),
        place: None,
    }
}

/// A part of a picture by its corners, as bits.
fn part(picture: &Picture, [x0, x1, y0, y1]: [usize; 4]) -> Vec<(String, Vec<u32>)> {
    let width = picture.width as usize;
    let rows = |samples: &[f32]| {
        (y0..y1).flat_map(|y| samples[y * width..][x0..x1].iter().map(|x| x.to_bits())).collect()
    };
    picture.channels.iter().map(|channel| (channel.name.clone(), rows(&channel.samples))).collect()
}

#[test]
fn a_crop_has_the_bits_of_the_whole_picture() {
    let folder = folder("crop/bits");
    let whole = path(&folder, "whole.exr");
    render(&whole, &[]);
    let whole = read(&whole);
    assert_eq!((whole.width, whole.height, whole.channels.len()), (90, 70, 7));
    for (crop, at) in
        [("11,60,3,70", [11, 60, 3, 70]), ("89,90,0,1", [89, 90, 0, 1]), ("0,90,0,70", [0, 90, 0, 70])]
    {
        for backend in ["packet", "scalar"] {
            let out = path(&folder, "crop.exr");
            render(&out, &["--crop", crop, "--backend", backend]);
            let crop = read(&out);
            assert_eq!((crop.width as usize, crop.height as usize), (at[1] - at[0], at[3] - at[2]));
            assert!(
                part(&crop, [0, at[1] - at[0], 0, at[3] - at[2]]) == part(&whole, at),
                "{at:?}, {backend}"
            );
        }
    }
}

#[test]
fn a_crop_is_in_pixels_of_the_size_asked_for_and_replaces_that_of_the_scene() {
    let folder = folder("crop/replaced");
    let scene = path(&folder, "scene.xml");
    let text = fs::read_to_string(SCENE).expect("readable");
    let crop = "<integer name=\"crop_width\" value=\"20\"/><integer name=\"crop_offset_x\" value=\"5\"/>";
    let cropped = text.replacen("<film type=\"hdrfilm\">", &format!("<film type=\"hdrfilm\">{crop}"), 1);
    assert_ne!(text, cropped);
    fs::write(&scene, cropped).expect("writable");
    let out = path(&folder, "out.exr");
    let words = ["render", &scene, "-o", &out, "-q", "--spp", "1", "--width", "64", "--height", "48"];
    let output = packlight(&[&words[..], &["--crop", "60,64,40,48"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!((read(&out).width, read(&out).height), (4, 8));
}

#[test]
fn crops_are_sharded_and_told_apart() {
    let folder = folder("crop/parts");
    let file = |name: &str| path(&folder, name);
    let crop = ["--crop", "10,80,5,60"];
    let whole = file("whole.exr");
    render(&whole, &crop);
    for which in ["1", "2"] {
        render(&file(&format!("{which}.exr")), &[&crop[..], &["--shard", &format!("{which}/2")]].concat());
    }
    let merged = file("merged.exr");
    let output = packlight(&["merge", &file("1.exr"), &file("2.exr"), "-o", &merged, "-q"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(fs::read(&merged).expect("it was written") == fs::read(&whole).expect("it was written"));
    let kept = file("kept.exr");
    render(&whole, &[&crop[..], &["--checkpoint", &kept]].concat());
    let words = ["render", SCENE, "-o", &whole, "--resume", &kept, "--width", "90", "--height", "70"];
    fails(&[&words[..], &["--crop", "11,81,5,60", "--aov", "normal,depth"]].concat(), 1, "the film is");
}

#[test]
fn a_window_is_the_crop_that_it_covers() {
    let folder = folder("crop/window");
    let file = |name: &str| path(&folder, name);
    render(&file("crop.exr"), &["--crop", "45,90,0,18"]);
    // A quarter of 70 rows is 17½.
    render(&file("window.exr"), &["--cropwindow", "0.5,1,0,0.25"]);
    let bytes = |name: &str| fs::read(file(name)).expect("it was written");
    assert!(bytes("crop.exr") == bytes("window.exr"));
}

#[test]
fn what_is_no_crop_is_2_before_anything_is_written() {
    let folder = folder("crop/refused");
    let out = path(&folder, "out.exr");
    let refused = |crop: &str, part: &str| {
        fails(&["render", SCENE, "-o", &out, "--width", "90", "--height", "70", "--crop", crop], 2, part);
        assert!(!Path::new(&out).exists());
    };
    refused("1,2,3", "--crop 100,200,0,50");
    refused("0.1,0.5,0,1", "shares of the size go to --cropwindow");
    refused("5,5,0,9", "x0 is 5 and x1 is 5");
    refused("0,9,7,6", "y0 is 7 and y1 is 6");
    refused("0,91,0,70", "90 x 70 pixels");
    fails(&["render", SCENE, "--pixel", "1,1", "--crop", "0,1,0,1"], 2, "--crop");
    let window = ["render", SCENE, "-o", &out, "--width", "90", "--cropwindow"];
    fails(&[&window[..], &["0,64,0,64"]].concat(), 2, "pixels go to --crop");
    fails(&[&window[..], &["0.101,0.102,0,1"]].concat(), 2, "no pixel of a picture of 90 x 90");
    fails(&[&window[..], &["0,1,0,1", "--crop", "0,1,0,1"]].concat(), 2, "cannot be used with");
    assert!(!Path::new(&out).exists());
}
