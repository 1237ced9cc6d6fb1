//! Memory: the peak of a render, as the system counts it for a process of its own. It belongs to the scene and the film,
//! not to the number of samples; what is expected of it is close to what is taken; and a limit is kept to.

#![allow(missing_docs)]
#![cfg(target_os = "linux")]

mod program;

use std::{
    fmt::Write,
    fs,
    path::Path,
    sync::atomic::{AtomicU32, Ordering},
};

use program::{fails, folder, packlight, path, stderr};

/// How much more memory the longer render may take, as a share: what allocators and page sizes make of the same needs.
const SPREAD: f64 = 0.05;
/// Between what share of the peak, and what multiple of it, an expectation lies …
const LEAST: f64 = 0.9;
const MOST: f64 = 1.5;
/// … give or take what the program has before it does anything, MiB.
const PROGRAM: f64 = 8.0;

/// Tests run beside each other.
static PICTURES: AtomicU32 = AtomicU32::new(0);

/// The most memory that was expected of a render, and that it had, in MiB.
fn memory(scene: &str, options: &[&str]) -> (f64, f64) {
    let number = PICTURES.fetch_add(1, Ordering::Relaxed);
    let picture = path(&folder(&format!("memory/{number}")), "a.exr");
    let output = packlight(&[&["render", scene, "--json", "-o", &picture], options].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a report in JSON");
    let mebibytes = |key| report[key].as_f64().expect("bytes") / f64::from(1 << 20);
    (mebibytes("memory_budget_bytes"), mebibytes("peak_memory_bytes"))
}

#[test]
fn memory_does_not_grow_with_samples() {
    let scene = "scenes/cornell.xml";
    // So many tiles that every thread is in time for one.
    for (side, threads, most) in [("32", "1", "4096"), ("128", "2", "1024")] {
        let peak = |samples: &str| {
            let options = ["--width", side, "--height", side, "--threads", threads, "--spp", samples];
            memory(scene, &options).1
        };
        // What threads add by when they run, they don't add every time.
        let least = |samples| (0..5).map(|_| peak(samples)).fold(f64::INFINITY, f64::min);
        let (few, many) = (least("16"), least(most));
        let told = format!("{side} x {side}: {few:.2} MiB by 16 samples, {many:.2} by {most}");
        println!("{told}");
        assert!((many / few - 1.0).abs() <= SPREAD, "{told}");
    }
}

/// Thousands of figures in a square; a large picture on them, and another all around.
fn crowd(folder: &Path) -> String {
    let picture = path(folder, "texture.exr");
    let size = ["--width", "1200", "--height", "1200", "--spp", "1", "-q"];
    // Nothing of it is brighter than a reflectance may be.
    let made = packlight(
        &[&["render", "scenes/cornell.xml", "-o", &picture, "--integrator", "ao"], &size[..]].concat(),
    );
    assert!(made.status.success(), "{}", stderr(&made));
    let mut text = String::from(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\"/>\
         <emitter type=\"envmap\"><string name=\"filename\" value=\"texture.exr\"/></emitter>\
         <shape type=\"shapegroup\" id=\"figure\"><shape type=\"cube\"><bsdf type=\"diffuse\">\
         <texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" value=\"texture.exr\"/></texture>\
         </bsdf></shape><shape type=\"sphere\"/></shape>",
    );
    for i in 0..20_000 {
        let at = format!("<translate x=\"{}\" z=\"{}\"/>", i % 200 * 3, i / 200 * 3);
        let place = format!("<transform name=\"to_world\">{at}</transform>");
        write!(text, "<shape type=\"instance\"><ref id=\"figure\"/>{place}</shape>").expect("a string grows");
    }
    let scene = path(folder, "crowd.xml");
    fs::write(&scene, text + "</scene>").expect("writable");
    scene
}

#[test]
fn what_is_expected_is_close_to_what_is_taken() {
    let crowd = crowd(&folder("memory/crowd"));
    let small = ["--width", "64", "--height", "64", "--spp", "1"];
    let (mesh, high) = ([small.as_slice()].concat(), [&small[..], &["--quality", "high"]].concat());
    let film = vec!["--width", "1000", "--height", "1000", "--spp", "1"];
    let sums = vec!["--width", "500", "--height", "500", "--spp", "16"];
    let layers = [&film[..], &["--integrator", "ao", "--aov", "albedo,normal,depth,uv"]].concat();
    let checkpoint = path(&folder("memory/kept"), "kept.exr");
    let kept = [&film[..], &["--checkpoint", &checkpoint]].concat();
    let threads = vec!["--width", "400", "--height", "400", "--spp", "1", "--threads", "16"];
    let together = [&threads[..2], &["--height", "400", "--spp", "16", "--threads", "48"]].concat();
    let fast = [&small[..], &["--quality", "fast"]].concat();
    let mut complaints = Vec::new();
    for (scene, options) in [
        ("scenes/cornell.xml", mesh.clone()),
        ("scenes/cornell.xml", film),
        ("scenes/cornell.xml", sums),
        ("scenes/cornell.xml", layers),
        ("scenes/cornell.xml", kept),
        ("scenes/whitted.xml", threads),
        ("scenes/whitted.xml", together),
        ("scenes/materials.xml", mesh.clone()),
        ("scenes/sky.xml", mesh.clone()),
        ("gen:terrain:200k", mesh.clone()),
        ("gen:terrain:200k", high.clone()),
        ("gen:soup:200k", mesh.clone()),
        ("gen:soup:200k", high),
        ("gen:soup:200k", fast),
        ("gen:hair:200k", mesh.clone()),
        (&crowd, mesh),
    ] {
        let (expected, taken) = memory(scene, &options);
        let told = format!("{scene} {}: {expected:.1} MiB expected, {taken:.1} taken", options.join(" "));
        println!("{told}");
        if !(LEAST * taken..=MOST * taken + PROGRAM).contains(&expected) {
            complaints.push(told);
        }
    }
    assert!(complaints.is_empty(), "{complaints:#?}");
}

/// Three vertices a triangle, which nobody shares: the most that a mesh without texture coordinates can bring.
#[test]
fn a_tree_and_all_that_it_is_made_of_take_less_than_three_times_the_tree() {
    let output = packlight(&["info", "gen:soup:1M", "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let info: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let bytes = |key| info[key].as_f64().expect("bytes");
    let share = bytes("peak_memory_bytes") / bytes("bvh_bytes");
    println!("{share:.2} times the tree");
    assert!(share < 3.0, "{share:.2} times the tree");
}

#[test]
fn a_scene_beyond_the_limit_is_refused_before_its_tree_is_built() {
    let picture = path(&folder("memory/refused"), "a.exr");
    let render =
        |scene, limit| -> Vec<&str> { vec!["render", scene, "-o", &picture, "--memory-limit", limit] };
    // Without the limit it would be rendered for a second, not for an hour.
    let large = vec!["--width", "10000", "--height", "10000", "--spp", "1", "--time-limit", "1s"];
    let film = [render("scenes/cornell.xml", "256MiB"), large].concat();
    fails(&film, 1, "most of it: film");
    fails(&render("gen:soup:300k", "40MB"), 1, "more than the 38.1 MiB of --memory-limit");
    fails(&render("gen:soup:300k", "furlongs"), 2, "expected an amount of memory, as in 2GiB");
    let meter = ["meter", "gen:soup:300k", "--at", "0,0,0", "--normal", "0,1,0", "--memory-limit", "40MB"];
    fails(&meter, 1, "--memory-limit");
    assert!(!Path::new(&picture).exists());
    let enough = [render("scenes/cornell.xml", "1GiB"), vec!["--width", "32", "--spp", "1", "-q"]].concat();
    assert!(packlight(&enough).status.success());
}
