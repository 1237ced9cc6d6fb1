//! `packlight bench` as other programs call it, and what it does with bad input.

#![allow(missing_docs)]

mod program;

use std::{fs, path::Path, process::Output};

use program::{fails, folder, packlight, stderr};

fn bench(arguments: &[&str]) -> Output {
    packlight(&[&["bench"], arguments].concat())
}

fn refused(arguments: &[&str], code: i32, part: &str) {
    fails(&[&["bench"], arguments].concat(), code, part);
}

/// The JSON lines of a run that succeeds.
fn lines(arguments: &[&str]) -> Vec<serde_json::Value> {
    let output = bench(arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", stderr(&output));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    text.lines().map(|line| serde_json::from_str(line).expect("a JSON object a line")).collect()
}

fn write(folder: &Path, name: &str, contents: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    fs::write(&path, contents).expect("writable");
    path.display().to_string()
}

fn rays(rays: &[[f32; 8]]) -> Vec<u8> {
    rays.iter().flatten().flat_map(|x| x.to_le_bytes()).collect()
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const HIT: [f32; 8] = [0.25, 0.25, 2.0, 0.0, 0.0, 0.0, -1.0, f32::INFINITY];
const MISS: [f32; 8] = [0.9, 0.9, 2.0, 0.0, 0.0, 0.0, -1.0, f32::INFINITY];
const SHORT: [f32; 8] = [0.25, 0.25, 2.0, 0.0, 0.0, 0.0, -1.0, 1.5];

#[test]
fn the_protocol_is_one_line_with_the_agreed_keys() {
    let folder = folder("bench-protocol");
    let mesh = write(&folder, "a.obj", TRIANGLE);
    let file = write(&folder, "a.rays", rays(&[HIT, MISS, SHORT, HIT, HIT]));
    for (query, t_sum) in [("closest", 6.0), ("any", 0.0)] {
        let arguments =
            ["--mesh", &mesh, "--rays", &file, "--query", query, "--threads", "1", "--repeat", "1", "--json"];
        let lines = lines(&arguments);
        assert_eq!(lines.len(), 1);
        let line = &lines[0];
        assert_eq!((line["hits"].as_u64(), line["t_sum"].as_f64()), (Some(3), Some(t_sum)), "{line}");
        assert_eq!((line["rays"].as_u64(), line["invalid"].as_u64()), (Some(5), Some(0)), "{line}");
        assert_eq!(line["query"], query);
        for key in ["mrays_per_s", "build_s", "bvh_bytes"] {
            assert!(line[key].as_f64().is_some_and(|x| x > 0.0), "{key}: {line}");
        }
    }
}

#[test]
fn threads_and_chunks_do_not_change_the_answer() {
    let folder = folder("bench-threads");
    let shoot = |i: usize| {
        let (x, y) = ((i % 100) as f32 / 100.0, (i / 100) as f32 / 100.0);
        [x, y, -1.0, 0.0, 0.05 - x * 0.1, 0.0, 1.0, f32::INFINITY]
    };
    let file = write(&folder, "a.rays", rays(&(0..10_001).map(shoot).collect::<Vec<_>>()));
    let run = |threads| {
        let line = lines(&[
            "--mesh",
            "gen:soup:2k",
            "--rays",
            &file,
            "--threads",
            threads,
            "--repeat",
            "1",
            "--json",
        ]);
        (line[0]["hits"].clone(), line[0]["t_sum"].clone())
    };
    let one = run("1");
    assert!(one.0.as_u64().is_some_and(|hits| hits > 1000), "{one:?}");
    assert_eq!(one, run("3"));
}

#[test]
fn quality_changes_the_tree_and_no_hit() {
    let folder = folder("bench-quality");
    let shoot = |i: usize| {
        let (x, y) = ((i % 50) as f32 / 50.0, (i / 50) as f32 / 50.0);
        [x, y, -1.0, 0.0, 0.1 - x * 0.2, 0.0, 1.0, f32::INFINITY]
    };
    let file = write(&folder, "a.rays", rays(&(0..2500).map(shoot).collect::<Vec<_>>()));
    let run = |quality: &[&str]| {
        let arguments =
            [&["--mesh", "gen:soup:2k", "--rays", &file, "--repeat", "1", "--json"], quality].concat();
        lines(&arguments)[0].clone()
    };
    let [plain, fast, medium, high] =
        [&[][..], &["--quality", "fast"], &["--quality", "medium"], &["--quality", "high"]].map(run);
    for (line, name) in [(&plain, "medium"), (&fast, "fast"), (&medium, "medium"), (&high, "high")] {
        assert_eq!(line["quality"], name);
        assert_eq!((&line["hits"], &line["t_sum"]), (&plain["hits"], &plain["t_sum"]), "{line}");
    }
    assert_eq!(plain["bvh_bytes"], medium["bvh_bytes"]);
    assert_ne!(plain["bvh_bytes"], fast["bvh_bytes"]);
    refused(&["gen:soup:2k", "--quality", "best"], 2, "fast, medium, high");
}

#[test]
fn rays_that_cannot_be_traced_are_counted_misses() {
    let folder = folder("bench-invalid");
    let mesh = write(&folder, "a.obj", TRIANGLE);
    let nan = f32::NAN;
    let bad = [
        [nan, 0.25, 2.0, 0.0, 0.0, 0.0, -1.0, 9.0],
        [0.25, 0.25, 2.0, 0.0, 0.0, nan, -1.0, 9.0],
        [0.25, 0.25, 2.0, 0.0, 0.0, 0.0, 0.0, 9.0],
        [0.25, 0.25, 2.0, 5.0, 0.0, 0.0, -1.0, 1.0],
        [0.25, 0.25, 2.0, 0.0, 0.0, 0.0, -1.0, nan],
        HIT,
    ];
    let file = write(&folder, "a.rays", rays(&bad));
    let line = &lines(&["--mesh", &mesh, "--rays", &file, "--repeat", "1", "--json"])[0];
    assert_eq!((line["hits"].as_u64(), line["invalid"].as_u64()), (Some(1), Some(5)), "{line}");
    let table = bench(&["--mesh", &mesh, "--rays", &file, "--repeat", "1", "--query", "any"]);
    let table = String::from_utf8_lossy(&table.stdout);
    assert!(table.contains("5 rays of the file can't be traced"), "{table}");
}

#[test]
fn no_ray_makes_it_stumble() {
    let folder = folder("bench-extreme");
    let mesh = write(&folder, "a.obj", TRIANGLE);
    // Every kind of number in every place, in turn: whole tiles of them, and a rest.
    let numbers = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        f32::MIN_POSITIVE,
        1e-45,
        0.0,
        -0.0,
        1.0,
    ];
    let mut strange = vec![HIT];
    for place in 0..8 {
        for number in numbers {
            strange.push(std::array::from_fn(|i| if i == place { number } else { HIT[i] }));
            strange.push(std::array::from_fn(|i| if i == place { HIT[i] } else { number }));
        }
    }
    let file = write(&folder, "a.rays", rays(&strange));
    let hopeless = write(&folder, "b.rays", rays(&[[f32::NAN; 8]; 65]));
    for mesh in [mesh.as_str(), "gen:soup:1k"] {
        for query in ["closest", "any"] {
            let run = |file: &str| {
                lines(&["--mesh", mesh, "--rays", file, "--query", query, "--repeat", "1", "--json"])
                    .remove(0)
            };
            let line = run(&file);
            let number = |key: &str| line[key].as_u64().unwrap_or_else(|| panic!("{key}: {line}"));
            assert_eq!(number("rays"), strange.len() as u64);
            assert!(number("invalid") > 50 && number("hits") <= number("rays") - number("invalid"), "{line}");
            assert!(line["t_sum"].as_f64().is_some_and(f64::is_finite), "{line}");
            let line = run(&hopeless);
            assert_eq!((&line["hits"], &line["invalid"]), (&0.into(), &65.into()), "{line}");
        }
    }
}

#[test]
fn bad_input_is_told_and_never_a_panic() {
    let folder = folder("bench-bad");
    let mesh = write(&folder, "a.obj", TRIANGLE);
    let good = write(&folder, "good.rays", rays(&[HIT]));
    let cut = write(&folder, "cut.rays", &rays(&[HIT])[..31]);
    let cut_later = write(&folder, "cut-later.rays", [rays(&[HIT]), vec![0]].concat());
    let empty = write(&folder, "empty.rays", "");
    let nothing = write(&folder, "nothing.ply", "");
    refused(&["--mesh", &mesh, "--rays", "no-such.rays"], 1, "no-such.rays");
    refused(&["--mesh", &mesh, "--rays", &cut], 1, "31 bytes are not a whole number of rays");
    refused(&["--mesh", &mesh, "--rays", &cut_later], 1, "33 bytes are not a whole number of rays");
    refused(&["--mesh", &mesh, "--rays", &empty], 1, "no rays");
    refused(&["--mesh", &mesh, "--rays", &folder.display().to_string()], 1, "bad");
    refused(&["--mesh", "no-such.obj", "--rays", &good], 1, "no-such.obj");
    refused(&["--mesh", "gen:foo:10", "--rays", &good], 1, "no mesh of the kind `foo`");
    refused(&["--mesh", &nothing, "--rays", &good], 1, "nothing.ply");
    refused(&["--mesh", "gen:", "--rays", &good], 1, "no mesh of the kind ``");
    refused(&["--mesh", "gen:soup", "--rays", &good], 1, "how many triangles?");
    for count in ["0", "0k", "-5", "1.5M", "1e6", "many", ""] {
        let mesh = format!("gen:soup:{count}");
        refused(&["--mesh", &mesh, "--rays", &good], 1, "expected a number of triangles");
    }
    for count in ["101M", "99999999999", "99999999999999999999999999M"] {
        refused(&["--mesh", &format!("gen:hair:{count}"), "--rays", &good], 1, "triangles are more than");
    }
    refused(&["--mesh", "gen:soup:10:x", "--rays", &good], 1, "the seed is not a whole number");
    refused(&["gen:foo:10"], 1, "no mesh of the kind `foo`");
    refused(&["gen:terrain:1000M"], 1, "are more than 100000000");
    refused(&["--mesh", "a.xml", "--rays", &good], 1, "a scene is not a mesh");
    refused(&["--mesh", "a.stl", "--rays", &good], 1, ".stl");
    refused(&["gen:hair:x"], 1, "expected a number of triangles");
    refused(&["--mesh", &mesh], 2, "--rays");
    refused(&["--mesh", &mesh, "--rays", &good, "--query", "some"], 2, "closest");
    refused(&["--mesh", &mesh, "--rays", &good, "--repeat", "0"], 2, "--repeat");
    refused(&["--mesh", &mesh, "--rays", &good, "--threads", "0"], 2, "--threads");
    refused(&[&mesh, "--mesh", &mesh, "--rays", &good], 2, "cannot be used with");
    refused(&[], 2, "SCENE");
    refused(&[&mesh, "--save-rays", &good], 1, "can't write rays into");
}

#[test]
fn a_scene_brings_its_own_rays_and_saves_them() {
    let folder = folder("bench-scene");
    let mesh = write(&folder, "a.obj", TRIANGLE);
    let rays = folder.join("rays").display().to_string();
    let own = lines(&[&mesh, "--save-rays", &rays, "--repeat", "1", "--json"]);
    let classes: Vec<_> = own.iter().filter_map(|line| line["class"].as_str()).collect();
    // A lone triangle: nothing is hit a second time.
    assert_eq!(classes, ["primary", "shadow", "ao", "diffuse"]);
    assert_eq!(own[0]["rays"], 800 * 600);
    for line in &own {
        let file = folder.join("rays").join(format!("{}.rays", line["class"].as_str().unwrap_or_default()));
        let bytes = fs::metadata(&file).expect("the file is there").len();
        assert_eq!(Some(bytes), line["rays"].as_u64().map(|rays| rays * 32));
        let query = line["query"].as_str().unwrap_or_default();
        let file = file.display().to_string();
        let again =
            &lines(&["--mesh", &mesh, "--rays", &file, "--query", query, "--repeat", "1", "--json"])[0];
        assert_eq!((&again["hits"], &again["t_sum"]), (&line["hits"], &line["t_sum"]), "{line}");
        assert_eq!(again["invalid"], 0);
    }
}

#[test]
fn the_picture_of_1979_tells_its_factors() {
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/whitted.xml");
    let [frame] = &lines(&[scene, "--whitted", "--repeat", "1", "--json"])[..] else { panic!("one line") };
    let number = |key: &str| frame[key].as_f64().unwrap_or_else(|| panic!("{key}"));
    assert_eq!((number("width"), number("height")), (512.0, 512.0));
    assert!(number("rays") > 2.0 * 512.0 * 512.0, "every camera ray that hits asks for a shadow ray");
    let seconds = number("milliseconds") / 1e3;
    assert!((number("times_vax_1980") * seconds / 4440.0 - 1.0).abs() < 1e-9);
    assert!((number("times_pc_2006") * seconds / 6.0 - 1.0).abs() < 1e-9);
    refused(&[scene, "--whitted", "--way", "tile"], 2, "--whitted");
}
