//! `render --stats`, as a shell sees it: a table for people, JSON for machines, the same numbers in both.

#![allow(missing_docs)]

mod program;

use std::fs;

use program::{folder, packlight, path, stderr, stdout};

const SCENE: &str = "scenes/spheres.xml";
const SMALL: [&str; 7] = ["--width", "48", "--spp", "3", "--threads", "2", "--stats"];

fn told(out: &str, more: &[&str]) -> String {
    let output = packlight(&[&["render", SCENE, "-o", out], &SMALL[..], more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    stdout(&output)
}

#[test]
fn machines_are_told_what_people_are() {
    let folder = folder("statistics/told");
    let out = path(&folder, "a.exr");
    let json: serde_json::Value = serde_json::from_str(&told(&out, &["--json"])).expect("JSON");
    let stats = &json["stats"];
    let number = |value: &serde_json::Value| value.as_f64().unwrap_or_else(|| panic!("{stats:#}"));
    let kinds: Vec<&str> = (0..3).filter_map(|i| stats["rays"][i]["kind"].as_str()).collect();
    assert_eq!(kinds, ["camera", "bounce", "shadow"]);
    let pixels = number(&json["width"]) * number(&json["height"]);
    assert_eq!(number(&stats["rays"][0]["count"]), pixels, "one sample of each pixel");
    for i in 0..3 {
        let rays = &stats["rays"][i];
        // Five spheres and a floor: whoever looks meets the root.
        for key in ["nodes_per_ray", "nodes_per_ray_together"] {
            assert!(number(&rays[key]) >= 0.9, "{key}: {rays}");
        }
        let most = number(&rays["nodes_per_ray_together"]) + number(&rays["primitives_per_ray_together"]);
        assert!(number(&rays["tests_per_ray_together"]) <= most, "{rays}");
        assert!(number(&rays["lane_use"]) > 0.9 && number(&rays["lane_use"]) <= 1.0, "{rays}");
    }
    let sorting = &stats["sorting"];
    assert!(number(&sorting["groups_sorted"]) < number(&sorting["groups_unsorted"]), "{sorting}");
    assert!(number(&sorting["lane_use_sorted"]) > number(&sorting["lane_use_unsorted"]), "{sorting}");
    let ends: f64 = ["escaped", "surface", "depth", "russian_roulette"]
        .map(|end| number(&stats["ends"][end]))
        .iter()
        .sum();
    assert_eq!(ends, pixels, "{stats:#}");
    assert!(number(&stats["thread_seconds"]["trace"]) > 0.0);

    let table = told(&out, &[]);
    let count = stats["rays"][1]["count"].as_u64().expect("a count");
    let grouped = format!("{},{:03}", count / 1000, count % 1000);
    let of_bounce = table.lines().find(|line| line.trim_start().starts_with("bounce")).expect("a line");
    assert!(of_bounce.contains(&grouped), "{grouped} is not in\n{table}");
    for part in [
        "of the shadow rays are blocked",
        "groups of eight in place of",
        "by Russian roulette",
        "stages   trace ",
    ] {
        assert!(table.contains(part), "{part} is not in\n{table}");
    }
    // But for the name of the file, a terminal's 80 columns are enough.
    assert!(table.lines().skip(1).all(|line| line.chars().count() <= 80), "{table}");
}

#[test]
fn who_looks_on_changes_no_picture() {
    let folder = folder("statistics/same");
    let (plain, counted) = (path(&folder, "plain.exr"), path(&folder, "counted.exr"));
    told(&counted, &[]);
    let small = &SMALL[..SMALL.len() - 1];
    let output = packlight(&[&["render", SCENE, "-o", &plain, "--quiet"], small].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let bytes = |path: &str| fs::read(path).expect("it was written");
    assert!(bytes(&plain) == bytes(&counted));
}
