//! Our EXR files as others read them: `exrheader` of OpenEXR, `oiiotool` of OpenImageIO and Blender, where they are
//! installed.

#![allow(missing_docs)]

mod program;

use std::{path::Path, process::Command};

use packlight::picture::{Encoding, decode};
use program::{folder, packlight, path, stderr};

/// What a tool prints, or `None` if it is not there.
fn run(tool: &str, arguments: &[&str]) -> Option<String> {
    let Ok(output) = Command::new(tool).args(arguments).output() else {
        println!("skipped: there is no `{tool}`");
        return None;
    };
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &stderr(&output);
    assert!(output.status.success(), "{tool} {arguments:?}: {text}");
    Some(text)
}

/// Layers of all kinds, 45 × 19 pixels.
fn render(out: &str, more: &[&str]) {
    let layers = ["--aov", "albedo,normal,depth,position,uv,primitive_id"];
    let all = ["render", "scenes/spheres.xml", "-o", out, "--width", "45", "--spp", "2", "--quiet"];
    let output = packlight(&[&all[..], &layers, more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

/// Channels as Nuke, Blender and tev group them: a layer's name, a point, and what it is a component of. The last
/// is whether 16 bits are asked for in vain.
const CHANNELS: [(&str, bool); 16] = [
    ("B", false),
    ("G", false),
    ("R", false),
    ("albedo.B", false),
    ("albedo.G", false),
    ("albedo.R", false),
    ("depth.Z", true),
    ("normal.X", true),
    ("normal.Y", true),
    ("normal.Z", true),
    ("position.X", true),
    ("position.Y", true),
    ("position.Z", true),
    ("primitive_id.I", true),
    ("uv.U", true),
    ("uv.V", true),
];

const COMPRESSIONS: [(&str, &str); 5] = [
    ("none", "none"),
    ("rle", "run-length encoding"),
    ("zips", "zip, individual scanlines"),
    ("zip", "zip, multi-scanline blocks"),
    ("piz", "piz"),
];

#[test]
fn exrheader_finds_every_channel_in_every_compression() {
    let folder = folder("exr_readers/header");
    for half in [false, true] {
        for (compression, meaning) in COMPRESSIONS {
            let out = path(&folder, "a.exr");
            let numbers = if half { "half" } else { "float" };
            render(&out, &["--exr-type", numbers, "--exr-compression", compression]);
            let Some(header) = run("exrheader", &[&out]) else { return };
            for (name, whole) in CHANNELS {
                let bits = if half && !whole { 16 } else { 32 };
                let line = format!("\n    {name}, {bits}-bit floating-point, sampling 1 1");
                assert!(header.contains(&line), "{line} is not in\n{header}");
            }
            for line in [
                &format!("compression (type compression): {meaning}"),
                "dataWindow (type box2i): (0 0) - (44 18)",
                "packlight.scene (type string): \"spheres.xml\"",
                "packlight.samples (type string): \"2\"",
            ] {
                assert!(header.contains(line), "{line} is not in\n{header}");
            }
        }
    }
}

#[test]
fn oiiotool_reads_the_numbers_that_were_written() {
    let folder = folder("exr_readers/numbers");
    let reference = path(&folder, "reference.exr");
    render(&reference, &[]);
    let picture = decode(Path::new(&reference), Encoding::Raw).expect("readable");
    let Some(told) = run("oiiotool", &["--stats", &reference]) else { return };
    let line = told.lines().find_map(|line| line.trim().strip_prefix("Stats Avg:")).expect("means");
    let means: Vec<f64> = line.split_whitespace().map_while(|word| word.parse().ok()).collect();
    assert_eq!(means.len(), CHANNELS.len(), "{told}");
    for (channel, mean) in picture.channels.iter().zip(means) {
        let ours = channel.samples.iter().map(|&x| f64::from(x)).sum::<f64>() / channel.samples.len() as f64;
        assert!((ours - mean).abs() < 1e-5, "{}: {ours} {mean}", channel.name);
    }
    for (compression, _) in COMPRESSIONS {
        let out = path(&folder, "a.exr");
        render(&out, &["--exr-compression", compression]);
        let told = run("oiiotool", &[&reference, &out, "--diff"]).expect("it was there");
        assert!(told.contains("PASS"), "{told}");
    }
}

/// A part of a picture lies where it belongs: its data window in the display window that is the whole. So do
/// checkpoints and shards of it, and what is put together from shards.
#[test]
fn a_crop_has_its_place_in_the_whole() {
    let folder = folder("exr_readers/crop");
    let file = |name: &str| path(&folder, name);
    let small = ["--width", "90", "--height", "70", "--spp", "2", "--quiet", "--crop", "11,60,3,70"];
    let render = |out: &str, more: &[&str]| {
        let output = packlight(&[&["render", "scenes/cornell.xml", "-o", out], &small[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    };
    let files = ["crop", "kept", "1", "2", "merged"].map(|name| file(&format!("{name}.exr")));
    let [crop, kept, first, second, merged] = &files;
    render(crop, &["--checkpoint", kept]);
    render(first, &["--shard", "1/2"]);
    render(second, &["--shard", "2/2"]);
    let output = packlight(&["merge", first, second, "-o", merged, "-q"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for file in &files {
        let Some(header) = run("exrheader", &[file]) else { return };
        for line in
            ["dataWindow (type box2i): (11 3) - (59 69)", "displayWindow (type box2i): (0 0) - (89 69)"]
        {
            assert!(header.contains(line), "{line} is not in\n{header}");
        }
    }
    let whole = file("whole.exr");
    let output =
        packlight(&[&["render", "scenes/cornell.xml", "-o", &whole], &small[..small.len() - 2]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    // Cut out of the whole by somebody else, it is the same picture.
    if let Some(told) = run("oiiotool", &[&whole, "--crop", "49x67+11+3", crop, "--diff"]) {
        assert!(told.contains("PASS"), "{told}");
    }
}

/// Passes as Blender names them: what is before the point, and the colours outside of layers are `Combined`.
#[test]
fn blender_finds_every_layer() {
    let out = path(&folder("exr_readers/blender"), "a.exr");
    render(&out, &[]);
    let script = format!(
        "import bpy\nimage = bpy.data.images.load({out:?})\nscene = bpy.context.scene\nscene.use_nodes = True\n\
         node = scene.node_tree.nodes.new('CompositorNodeImage')\nnode.image = image\n\
         print(image.type, ' '.join(f'{{out.name}}:{{out.type}}' for out in node.outputs if out.enabled))"
    );
    let Some(told) = run("blender", &["-b", "-noaudio", "--python-exit-code", "1", "--python-expr", &script])
    else {
        return;
    };
    let layers = "MULTILAYER Combined:RGBA Alpha:VALUE albedo:RGBA depth:VALUE normal:RGBA position:RGBA \
                  primitive_id:VALUE uv:RGBA";
    assert!(told.contains(layers), "{layers} is not in\n{told}");
}

#[test]
fn shards_checkpoints_and_alpha_are_pictures_too() {
    let folder = folder("exr_readers/parts");
    let (out, kept) = (path(&folder, "a.exr"), path(&folder, "kept.exr"));
    render(&out, &["--checkpoint", &kept]);
    let shard = path(&folder, "shard.exr");
    let small = ["--width", "70", "--spp", "2", "--quiet", "--shard", "2/3", "--shard-by", "tiles"];
    let output = packlight(&[&["render", "scenes/cornell.xml", "-o", &shard], &small[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for (file, window) in [(&kept, "(0 0) - (44 18)"), (&shard, "(0 0) - (69 69)")] {
        let Some(header) = run("exrheader", &[file]) else { return };
        let line = format!("displayWindow (type box2i): {window}");
        assert!(header.contains(&line), "{line} is not in\n{header}");
        if let Some(told) = run("oiiotool", &["--stats", file]) {
            assert!(told.contains("Stats NanCount: 0 "), "{told}");
        }
    }
}
