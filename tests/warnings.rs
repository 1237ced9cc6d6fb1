//! What is legal and probably not meant: told on stderr, with its place, the text underlined, and what to do.

#![allow(missing_docs)]

mod program;

use std::{fs, path::Path};

use program::{command, folder, packlight, path, stderr, stdout};

/// A scene, and what `info` warns of in it.
fn warned(folder: &Path, body: &str) -> String {
    let scene = path(folder, "scene.xml");
    let film = "<film type='hdrfilm'><rfilter type='box'/></film>";
    let text = format!(
        "<scene version='3.0.0'>\n<integrator type='path'/>\n<sensor type='perspective'>{film}</sensor>\n{body}\n</scene>\n"
    );
    fs::write(&scene, text).expect("a scene can be written");
    let output = packlight(&["info", &scene]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("surface area heuristic"), "{}", stdout(&output));
    stderr(&output)
}

/// All parts, in their order.
fn tells(told: &str, parts: &[&str]) {
    let mut rest = told;
    for part in parts {
        let at = rest.find(part).unwrap_or_else(|| panic!("{part} is not in order in\n{told}"));
        rest = &rest[at + part.len()..];
    }
}

const SKY: &str = "<emitter type='constant'/>";

#[test]
fn a_material_that_nothing_uses_is_underlined() {
    let folder = folder("warnings/unused");
    let told = warned(&folder, &format!("{SKY}\n<bsdf type='diffuse' id='spare'/>"));
    tells(
        &told,
        &[
            "warning: ",
            "scene.xml:5:2: the bsdf `spare` is never used",
            "5 | <bsdf type='diffuse' id='spare'/>",
            "^^|^",
            "never used",
            "help: refer to it by <ref id=\"spare\"/>, or remove it",
        ],
    );
    assert_eq!(told.matches("warning: ").count(), 1, "{told}");
}

#[test]
fn lights_without_power_are_underlined() {
    let folder = folder("warnings/dark");
    let lamp =
        "<shape type='rectangle' id='lamp'><emitter type='area'>\n<rgb name='radiance' value='0'/></emitter>";
    let point = "<emitter type='point'>\n<rgb name='intensity' value='0, 0, 0'/></emitter>";
    let told = warned(&folder, &format!("{lamp}</shape>\n{point}"));
    tells(
        &told,
        &[
            "scene.xml:5:29: the light of shape `lamp` has no power",
            "5 | <rgb name='radiance' value='0'/>",
            "no light comes from here",
            "help: give `radiance` a value above 0, or remove the light",
            "scene.xml:7:30: the `point` emitter has no power",
            "help: give `intensity` a value above 0, or remove the light",
        ],
    );
}

#[test]
fn a_camera_inside_of_a_wall_is_told_with_the_wall() {
    let folder = folder("warnings/wall");
    let told = warned(&folder, &format!("{SKY}\n<shape type='cube' id='block'/>"));
    tells(
        &told,
        &[
            "scene.xml:5:2: the camera is inside of shape `block`, which no light passes",
            "all that the camera sees is dark",
            "help: move the `origin`",
            "flip_normals",
        ],
    );
    // What can be seen through, and what the camera stands beside, is as it should be.
    let glass = format!("{SKY}<shape type='cube'><bsdf type='dielectric'/></shape>");
    assert_eq!(warned(&folder, &glass), "");
    let beside = "<transform name='to_world'><translate z='3'/></transform>";
    assert_eq!(warned(&folder, &format!("{SKY}<shape type='cube'>{beside}</shape>")), "");
}

#[test]
fn triangles_without_area_are_counted_by_shape() {
    let folder = folder("warnings/flat");
    let flat = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\n";
    fs::write(folder.join("flat.obj"), flat).expect("a mesh can be written");
    let mesh = "<shape type='obj'><string name='filename' value='flat.obj'/></shape>";
    let group = format!(
        "<shape type='shapegroup' id='g'>{mesh}</shape>\n<shape type='instance'><ref id='g'/></shape>"
    );
    let told = warned(&folder, &format!("{SKY}{mesh}\n{group}"));
    let sentence = "2 triangles without area can't be hit and are left out";
    tells(&told, &["scene.xml:4:28: ", sentence, "of this shape", "scene.xml:5:34: ", sentence]);
    assert_eq!(told.matches("warning: ").count(), 2, "{told}");

    let bare = packlight(&["info", &path(&folder, "flat.obj")]);
    tells(&stderr(&bare), &["warning: ", "flat.obj: 2 triangles without area"]);
    assert!(stdout(&bare).contains("degenerate  2"), "{}", stdout(&bare));
}

#[test]
fn a_flood_of_warnings_ends() {
    let folder = folder("warnings/flood");
    let spares: String = (0..45).map(|i| format!("<bsdf type='diffuse' id='spare{i}'/>\n")).collect();
    let told = warned(&folder, &format!("{SKY}{spares}"));
    assert_eq!(told.matches("is never used").count(), 20, "{told}");
    assert!(told.ends_with("warning: and 25 other warnings\n"), "{told}");
}

#[test]
fn away_from_a_terminal_warnings_are_plain() {
    let folder = folder("warnings/plain");
    let told = warned(&folder, "<bsdf type='diffuse'/>");
    assert!(told.is_ascii() && !told.contains('\x1b'), "{told}");
    tells(&told, &["the bsdf without an id is never used", "nothing in the scene shines"]);
    let scene = path(&folder, "scene.xml");
    let quiet = command(&["info", &scene]).env("NO_COLOR", "1").output().expect("the program starts");
    assert_eq!(stderr(&quiet), told);
}
