//! `packlight verify`, as it is called.

#![allow(missing_docs)]

mod program;

use std::{fs, path::Path};

use packlight::geometry::{Ray32, ray_file::encode};
use program::{command, fails, packlight, stderr};

fn json(arguments: &[&str]) -> serde_json::Value {
    let output = packlight(arguments);
    assert!(output.status.success(), "{output:?}");
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn a_scene_is_verified() {
    for scene in ["scenes/cornell.xml", "scenes/whitted.xml"] {
        let found = json(&["verify", scene, "--most", "4000", "--json"]);
        let classes = found["classes"].as_array().unwrap();
        assert!(classes.iter().any(|class| class["class"] == "adversarial"), "{found}");
        for class in classes {
            assert_eq!(class["mismatches"], 0, "{found}");
            assert!(class["rays"].as_u64().unwrap() > 0 && class["brute_force"].as_u64().unwrap() > 0);
        }
        assert_eq!((&found["leaks"]["leaks"], &found["self_hits"]["self_hits"]), (&0.into(), &0.into()));
        assert!(found["leaks"]["rays"].as_u64().unwrap() > 100, "{found}");
        assert!(found["failure"].is_null());
    }
}

#[test]
fn rays_of_a_file_are_held_to_what_they_should_find() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("verify");
    fs::create_dir_all(&folder).unwrap();
    let (mesh, rays) = (folder.join("one.obj"), folder.join("one.rays"));
    fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let ray = Ray32::new([0.2, 0.2, 1.0].into(), [0.0, 0.0, -1.0].into(), 0.0, f32::INFINITY);
    fs::write(&rays, encode(&[ray])).unwrap();
    let (mesh, rays) = (mesh.to_str().unwrap(), rays.to_str().unwrap());
    assert_eq!(json(&["verify", mesh, "--rays", rays, "--expect", "hit", "--json"])["unexpected"], 0);
    let output = packlight(&["verify", mesh, "--rays", rays, "--expect", "miss"]);
    assert_eq!(output.status.code(), Some(1));
    let told = stderr(&output);
    assert!(told.contains("1 ray that does not find what it should"), "{told}");
}

/// Where Embree's library may be.
fn embree() -> Option<std::ffi::OsString> {
    std::env::var_os("EMBREE_LIB").filter(|path| Path::new(path).is_file())
}

#[test]
fn hits_are_those_of_embree() {
    let Some(library) = embree() else {
        println!("skipped: EMBREE_LIB does not name Embree's library");
        return;
    };
    for scene in ["scenes/cornell.xml", "scenes/meshes/trefoil.ply", "gen:soup:20k", "gen:hair:20k"] {
        let arguments = ["verify", scene, "--most", "20000", "--against", "embree", "--json"];
        let output = command(&arguments).env("EMBREE_LIB", &library).output().expect("the program starts");
        assert!(output.status.success(), "{}", stderr(&output));
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let [rays, same, ties, edges] =
            ["rays", "same", "ties", "at_edges"].map(|key| found["against"][key].as_u64().expect("a count"));
        println!("{scene}: {}", found["against"]);
        assert_eq!((found["against"]["different"].as_u64(), rays), (Some(0), same + ties + edges), "{found}");
        // A sixth of them are aimed at edges on purpose.
        assert!(rays > 100_000 && same > rays * 5 / 6, "{found}");
    }
}

#[test]
fn without_embree_it_is_said_how_to_name_it() {
    let arguments = ["verify", "scenes/cornell.xml", "--against", "embree"];
    let output = command(&arguments).env_remove("EMBREE_LIB").output().expect("the program starts");
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("set it, as in EMBREE_LIB="), "{}", stderr(&output));
    let output = command(&arguments).env("EMBREE_LIB", "Cargo.toml").output().expect("the program starts");
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("--against embree: Cargo.toml: "), "{}", stderr(&output));
    fails(&["verify", "scenes/cornell.xml", "--against", "nobody"], 2, "embree");
}
