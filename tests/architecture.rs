//! The floors of the house, proven: a room imports only from floors below its own, and each outside
//! crate enters by its own door.
//!
//! A plain scan of the text, without comments and strings. It follows `crate::…` and `super::…`, in
//! `use` and elsewhere; it does not follow re-exports, because a room may only re-export what it may
//! import.

#![allow(missing_docs)]

#[path = "architecture/code.rs"]
mod code;

use std::{fs, path::Path};

use code::{crates, imports, names_word, without_comments};

/// Every room and its floor; `lib` and `main` stand outside.
const FLOORS: &[(&str, u32)] = &[
    ("simd", 0),
    ("math", 1),
    ("geometry", 2),
    ("picture", 2),
    ("texture", 2),
    ("bvh", 3),
    ("camera", 3),
    ("compare", 3),
    ("denoise", 3),
    ("film", 3),
    ("light", 3),
    ("material", 3),
    ("scene", 4),
    ("compile", 5),
    ("load", 5),
    ("render", 6),
    ("lobe", 7),
    ("verify", 7),
    ("cli", 8),
];

/// Where each crate of Cargo.toml may be named: folders end in `/`; `""` is the whole house.
const DOORS: &[(&str, &[&str])] = &[
    ("base64", &["lobe/"]),
    ("bumpalo", &["render/"]),
    ("bytemuck", &["geometry/ray.rs"]),
    ("clap", &["cli/"]),
    ("clap_complete", &["cli/"]),
    ("clap_mangen", &["cli/"]),
    ("console", &["cli/"]),
    ("ctrlc", &["cli/"]),
    ("exr", &["picture/"]),
    ("flate2", &["load/serialized.rs", "load/serialized/", "picture/exr_zip.rs"]),
    ("glam", &[""]),
    ("image", &["picture/"]),
    ("indicatif", &["cli/"]),
    ("terminal_size", &["cli/"]),
    ("kuva", &["lobe/"]),
    ("libloading", &["denoise/library.rs", "verify/embree.rs"]),
    ("libm", &["compare/", "math/", "light/", "compile/", "load/", "picture/"]),
    ("miette", &["cli/", "load/error.rs"]),
    ("ply_rs_bw", &["load/ply.rs"]),
    ("rayon", &["picture/", "bvh/", "compile/", "render/", "lobe/", "verify/", "cli/"]),
    ("roxmltree", &["load/"]),
    ("serde", &["cli/", "load/sh.rs"]),
    ("serde_json", &["cli/", "load/sh.rs"]),
    ("strsim", &["load/"]),
    // In `load/` and `cli/` only in tests.
    ("tempfile", &["load/", "picture/", "cli/"]),
    ("tev_client", &["cli/"]),
    ("textwrap", &["cli/"]),
    ("thiserror", &[""]),
    ("tobj", &["load/obj.rs"]),
    ("wide", &["simd/"]),
];

/// Files that may say `unsafe`. Each says why in `// SAFETY:`.
const UNSAFE: &[&str] = &[
    "denoise/library.rs",
    "simd/compress.rs",
    "simd/cpu.rs",
    "simd/mask/avx512.rs",
    "simd/opaque.rs",
    "simd/prefetch.rs",
    "verify/embree.rs",
];

/// Names under which everything would fit, and so nothing would be found again.
const DRAWERS: &[&str] =
    &["common", "core", "helper", "helpers", "manager", "misc", "shared", "util", "utils"];

const MAX_LINES: usize = 400;

/// What is wrong with the file at `path`, relative to `src/`, one sentence each.
fn complaints(path: &str, text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let lines = text.lines().count();
    if lines > MAX_LINES {
        found.push(format!(
            "src/{path} has {lines} lines, more than {MAX_LINES}: it holds more than one idea"
        ));
    }
    for part in path.trim_end_matches(".rs").split('/').filter(|part| DRAWERS.contains(part)) {
        found.push(format!("src/{path}: `{part}` is the name of a drawer, not of a thing"));
    }
    let code = without_comments(text);
    if names_word(&code, "unsafe") && !UNSAFE.contains(&path) {
        found.push(format!("src/{path} may not be unsafe: its place is {}", UNSAFE.join(" or ")));
    }
    found.extend(wrong_doors(path, &code));
    // The front door names every room; `main` is another crate and sees only what is public.
    if path != "lib.rs" && path != "main.rs" {
        found.extend(wrong_floors(path, &code));
    }
    found.sort();
    found.dedup();
    found
}

fn wrong_doors(path: &str, code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (name, doors) in DOORS {
        if !doors.iter().any(|door| path.starts_with(door)) && crates(code, name) {
            let doors: Vec<_> = doors.iter().map(|door| format!("src/{door}")).collect();
            found.push(format!(
                "src/{path} may not name the crate {name}: its door is {}",
                doors.join(" or ")
            ));
        }
    }
    found
}

fn wrong_floors(path: &str, code: &str) -> Vec<String> {
    let room = path.split('/').next().unwrap_or(path).trim_end_matches(".rs");
    let Some(floor) = floor(room) else {
        return vec![format!(
            "src/{path}: the room {room} has no floor; give it one in tests/architecture.rs"
        )];
    };
    let mut found = Vec::new();
    for import in imports(path, code) {
        if import == room {
            continue;
        }
        found.push(match self::floor(&import) {
            Some(below) if below < floor => continue,
            Some(same) if same == floor => format!(
                "src/{path} (floor {floor}) may not import {import} (floor {floor}): rooms on one floor do not know \
                 each other"
            ),
            Some(above) => format!("src/{path} (floor {floor}) may not import {import} (floor {above})"),
            None => format!("src/{path} may not import crate::{import}: it is not a room"),
        });
    }
    found
}

fn floor(room: &str) -> Option<u32> {
    FLOORS.iter().find(|(name, _)| *name == room).map(|(_, floor)| *floor)
}

fn scan(root: &Path, folder: &Path, found: &mut Vec<String>) {
    for entry in fs::read_dir(folder).expect("src can be read") {
        let file = entry.expect("src can be read").path();
        if file.is_dir() {
            scan(root, &file, found);
        } else if file.extension().is_some_and(|extension| extension == "rs") {
            let path = file.strip_prefix(root).expect("below src").to_string_lossy().replace('\\', "/");
            found.extend(complaints(&path, &fs::read_to_string(&file).expect("a source can be read")));
        }
    }
}

#[test]
fn the_house_stands() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    scan(&src, &src, &mut found);
    found.sort();
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn every_dependency_has_a_door() {
    let manifest = include_str!("../Cargo.toml");
    let section = manifest.split("\n[dependencies]\n").nth(1).expect("there are dependencies");
    let section = section.split("\n[").next().unwrap_or(section);
    for line in section.lines().filter(|line| !line.starts_with('#')) {
        let Some((name, _)) = line.split_once([' ', '=', '.']) else { continue };
        let name = name.replace('-', "_");
        assert!(
            DOORS.iter().any(|(door, _)| *door == name),
            "the crate {name} has no door in tests/architecture.rs"
        );
    }
}

/// Exactly one complaint, and that.
fn complains(path: &str, text: &str, complaint: &str) {
    assert_eq!(complaints(path, text), [complaint], "{text}");
}

fn is_content(path: &str, text: &str) {
    assert_eq!(complaints(path, text), [""; 0], "{text}");
}

#[test]
fn an_arrow_upwards_is_found_in_every_spelling() {
    let complaint = "src/geometry/mod.rs (floor 2) may not import bvh (floor 3)";
    for text in [
        "use crate::bvh::Tree;",
        "use crate::{math::Frame, bvh::{Tree, Node}};",
        "use crate::{\n    math::{self, Frame},\n    bvh,\n};",
        "fn f(tree: &crate::bvh::Tree) {}",
        "use super::bvh::Tree;",
        "mod tests { use super::super::bvh::Tree; }",
        "mod tests { use super::super::{bvh::Tree}; }",
        "pub(crate) use crate :: bvh;",
    ] {
        complains("geometry/mod.rs", text, complaint);
    }
    complains(
        "geometry/ray.rs",
        "use super::super::bvh::Tree;",
        "src/geometry/ray.rs (floor 2) may not import bvh (floor 3)",
    );
}

#[test]
fn rooms_on_one_floor_do_not_know_each_other() {
    let complaint = "src/load/mod.rs (floor 5) may not import compile (floor 5): rooms on one floor do not know each other";
    complains("load/mod.rs", "use crate::compile::Scene;", complaint);
}

#[test]
fn what_is_below_or_at_home_is_allowed() {
    is_content("scene/texture.rs", "use crate::picture::Picture; use super::Rgb; use crate::scene::Film;");
    is_content("geometry/ray.rs", "mod tests { use super::*; use super::super::hit::Hit; }");
    is_content("camera.rs", "use crate::geometry::Ray;");
    is_content(
        "geometry/mod.rs",
        "// use crate::bvh::Tree;\n/* crate::bvh /* crate::bvh */ */ const A: &str = \"crate::bvh\";",
    );
}

#[test]
fn the_whole_house_and_unknown_rooms_are_refused() {
    complains("bvh/mod.rs", "use crate::*;", "src/bvh/mod.rs may not import crate::*: it is not a room");
    complains(
        "attic/mod.rs",
        "",
        "src/attic/mod.rs: the room attic has no floor; give it one in tests/architecture.rs",
    );
}

#[test]
fn a_crate_at_the_wrong_door_is_found() {
    let complaint = "src/bvh/node.rs may not name the crate wide: its door is src/simd/";
    for text in [
        "use wide::f32x8;",
        "fn f(x: wide::f32x8) {}",
        "use {glam::Vec3, wide::f32x8};",
        "use wide as w;",
        "use ::wide::f32x8;",
    ] {
        complains("bvh/node.rs", text, complaint);
    }
    complains(
        "load/ply.rs",
        "use tobj::Mesh;",
        "src/load/ply.rs may not name the crate tobj: its door is src/load/obj.rs",
    );
    is_content("simd/f32x8.rs", "use wide::f32x8;");
    // Words that are not crates: a module of one's own, a variable, a part of a path or of a name.
    is_content("bvh/node.rs", "mod wide; use wide::Node;");
    is_content("bvh/node.rs", "fn f(wide: bool, very_wide: u8) -> bool { self::wide::g(wide) }");
}

#[test]
fn drawers_long_files_and_unsafe_are_found() {
    complains("bvh/util.rs", "", "src/bvh/util.rs: `util` is the name of a drawer, not of a thing");
    let long = "\n".repeat(MAX_LINES + 1);
    complains(
        "bvh/mod.rs",
        &long,
        "src/bvh/mod.rs has 401 lines, more than 400: it holds more than one idea",
    );
    let text = "fn f() { unsafe { g() } }";
    complains(
        "bvh/mod.rs",
        text,
        "src/bvh/mod.rs may not be unsafe: its place is denoise/library.rs or simd/compress.rs or simd/cpu.rs or \
         simd/mask/avx512.rs or simd/opaque.rs or simd/prefetch.rs or verify/embree.rs",
    );
    is_content("bvh/mod.rs", "#![deny(unsafe_code)] // unsafe");
    is_content(UNSAFE[0], text);
}
