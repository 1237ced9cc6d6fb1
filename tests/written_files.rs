//! What is in the files that the program writes: layers, words in the header, tone curves.

#![allow(missing_docs)]

mod program;

use std::{fs, path::Path};

use packlight::picture::{Encoding, Format, Preview, Style, Tone, decode, encode_with};
use program::{fails, folder, packlight, path, stderr, triangle};

#[test]
fn layers_stand_beside_the_picture_under_names_that_others_know() {
    let folder = folder("layers/names");
    let scene = triangle(&folder);
    let (plain, layered) = (path(&folder, "plain.exr"), path(&folder, "layered.exr"));
    let size = ["--width", "16", "--spp", "2", "--quiet"];
    let render = |out: &str, more: &[&str]| {
        let output = packlight(&[&["render", &scene, "-o", out], &size[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    };
    render(&plain, &[]);
    render(&layered, &["--aov", "albedo,normal,depth", "--exr-type", "half", "--exr-compression", "piz"]);
    let bytes = fs::read(&layered).expect("it was written");
    for channel in ["B", "G", "R", "albedo.R", "depth.Z", "normal.X"] {
        let name = [channel.as_bytes(), b"\0"].concat();
        assert!(bytes.windows(name.len()).any(|window| window == name), "{channel}");
    }
    // The light is what it is without them: halves of the same numbers.
    let read = |path: &str| {
        packlight::picture::decode(path.as_ref(), packlight::picture::Encoding::Raw).expect("readable")
    };
    let (plain, layered) = (read(&plain), read(&layered));
    for (a, b) in plain.channels.iter().zip(&layered.channels) {
        assert!(a.samples.iter().zip(&b.samples).all(|(a, b)| (a - b).abs() <= 1e-3 * a.abs()));
    }
    let png = path(&folder, "a.png");
    fails(&["render", &scene, "-o", &png, "--aov", "depth"], 2, "only an .exr");
    fails(&["render", &scene, "-o", &png, "--aov", "dept"], 2, "depth");
}

#[test]
fn what_can_not_be_written_is_refused_before_it_is_rendered() {
    let folder = folder("written/refused");
    let (scene, out) = (triangle(&folder), path(&folder, "a.exr"));
    let before = fs::read(&scene).expect("readable");
    let whole = ["render", &scene, "-o", &out, "-q", "--spp", "1"];
    for (options, code, part) in [
        (vec!["--aov", "albedo,albedo"], 1, "two channels are called albedo.R"),
        (
            vec!["--width", "65536", "--height", "65536"],
            1,
            "65536 × 65536 pixels with 3 channels are too many",
        ),
        (vec!["--checkpoint", &scene], 2, "a checkpoint is an .exr"),
    ] {
        fails(&[&whole[..], &options].concat(), code, part);
        assert!(!Path::new(&out).exists());
    }
    assert!(fs::read(&scene).expect("readable") == before, "the scene was written over");
    // The longest side that a film may have.
    let output = packlight(&[&whole[..], &["--width", "65536", "--height", "1"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(decode(out.as_ref(), Encoding::Raw).expect("readable").width, 65_536);
}

#[test]
fn layers_hold_what_their_names_say() {
    let folder = folder("layers/values");
    let (scene, out) = (path(&folder, "wall.xml"), path(&folder, "wall.exr"));
    let text = "<scene version='3.0.0'><integrator type='path'/>
        <sensor type='perspective'><film type='hdrfilm'><rfilter type='box'/></film></sensor>
        <shape type='rectangle'><transform name='to_world'><scale value='9'/><rotate y='1' angle='180'/>
        <translate z='5'/></transform>
        <bsdf type='diffuse'><rgb name='reflectance' value='0.25, 0.5, 0.75'/></bsdf></shape>
        <emitter type='constant'/></scene>";
    fs::write(&scene, text).expect("a scene can be written");
    let layers = "albedo,normal,depth,position,geo_normal,material_id";
    let size = ["--width", "9", "--height", "9", "--spp", "4", "--quiet"];
    let output = packlight(&[&["render", &scene, "-o", &out, "--aov", layers], &size[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let image = exr::prelude::read_first_flat_layer_from_file(&out).expect("an EXR file");
    let middle = |name: &str| {
        let channel = image.layer_data.channel_data.list.iter().find(|channel| channel.name.eq(name));
        channel.unwrap_or_else(|| panic!("{name}")).sample_data.value_by_flat_index(40).to_f32()
    };
    // What is seen in the middle: from the near plane, a centimetre away, and a pixel wide.
    for (name, expected, off) in [
        ("albedo.R", 0.25, 1e-6),
        ("albedo.G", 0.5, 1e-6),
        ("albedo.B", 0.75, 1e-6),
        ("normal.X", 0.0, 1e-6),
        ("normal.Y", 0.0, 1e-6),
        ("normal.Z", -1.0, 1e-6),
        ("geo_normal.Z", -1.0, 1e-6),
        ("depth.Z", 4.99, 0.02),
        ("position.X", 0.0, 0.3),
        ("position.Z", 5.0, 1e-5),
        ("material_id.I", 1.0, 0.0),
    ] {
        let value = middle(name);
        assert!((value - expected).abs() <= off, "{name} is {value}, not {expected}");
    }
}

#[test]
fn files_say_what_they_show_and_no_more_than_asked() {
    let folder = folder("metadata");
    let scene = triangle(&folder);
    let header = |more: &[&str]| {
        let out = path(&folder, "a.exr");
        let arguments =
            ["render", &scene, "-o", &out, "--width", "8", "--spp", "3", "--seed", "5", "--quiet"];
        let output = packlight(&[&arguments[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        packlight::picture::exr_attributes(&fs::read(&out).expect("it was written"))
    };
    let picture = header(&[]);
    for (name, value) in
        [("packlight.scene", "triangle.obj"), ("packlight.samples", "3"), ("packlight.seed", "5")]
    {
        assert!(picture.contains(&(name.into(), value.into())), "{name} in {picture:?}");
    }
    assert!(!picture.iter().any(|(name, _)| name == "packlight.seconds"));
    let said = |name: &str| {
        let found = picture.iter().find(|(other, _)| other == name);
        found.map_or_else(|| panic!("{name} in {picture:?}"), |(_, value)| value.clone())
    };
    // Three samples of each pixel, and the digest that `info` tells.
    let info = packlight(&["info", &scene, "--json"]);
    let info: serde_json::Value = serde_json::from_slice(&info.stdout).expect("JSON");
    assert_eq!(info["digest"], said("packlight.hash").as_str());
    let pixels =
        info["height"].as_u64().expect("a height") * 8 * 8 / info["width"].as_u64().expect("a width");
    assert!(
        said("packlight.rays").starts_with(&format!("camera {}, ", 3 * pixels)),
        "{}",
        said("packlight.rays")
    );
    assert_eq!(said("packlight.integrator"), "direct");
    assert!(said("software").starts_with("packlight "), "{}", said("software"));
    let all = header(&["--metadata", "all"]);
    assert!(all.iter().any(|(name, _)| name == "packlight.seconds"));
    let version = packlight(&["--version"]);
    let lanes = all.iter().find(|(name, _)| name == "packlight.lanes").expect("lanes are told");
    assert!(!lanes.1.is_empty() && program::stdout(&version).contains(&lanes.1), "{lanes:?}");
    let threads = header(&["--metadata", "all", "--threads", "3"]);
    assert!(threads.contains(&("packlight.threads".into(), "3".into())), "{threads:?}");
    assert!(header(&["--metadata", "none"]).iter().all(|(name, _)| !name.starts_with("packlight.")));
}

#[test]
fn tone_curves_change_a_png_and_nothing_else() {
    let folder = folder("tonemap");
    let scene = triangle(&folder);
    let shown = |tone: &str, stops: &str| {
        let out = path(&folder, "a.png");
        let arguments = ["render", &scene, "-o", &out, "--width", "16", "--spp", "2", "--quiet"];
        let output = packlight(&[&arguments[..], &["--tonemap", tone, "--exposure", stops]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        fs::read(&out).expect("it was written")
    };
    let light = path(&folder, "a.exr");
    let arguments = ["render", &scene, "-o", &light, "--width", "16", "--spp", "2", "--quiet"];
    assert_eq!(packlight(&arguments).status.code(), Some(0));
    let light = decode(light.as_ref(), Encoding::Raw).expect("readable");
    let curves =
        [("none", Tone::Clip), ("aces", Tone::Aces), ("agx", Tone::Agx), ("reinhard", Tone::Reinhard)];
    let expected = |preview: Preview| {
        encode_with(&light, Format::Png, &Style { preview, ..Style::default() }).expect("a picture")
    };
    let pictures = curves.map(|(name, tone)| {
        let shown = shown(name, "0");
        assert!(shown == expected(Preview { tone, ..Preview::default() }), "{name}");
        shown
    });
    let darker = shown("aces", "-1.5");
    assert!(darker == expected(Preview { tone: Tone::Aces, exposure: -1.5 }) && darker != pictures[1]);
    for (i, one) in pictures.iter().enumerate() {
        assert!(pictures[..i].iter().all(|other| other != one), "{i}");
    }
}
