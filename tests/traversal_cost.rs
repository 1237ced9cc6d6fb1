//! What tracing costs, counted: a traversal that starts to do more work fails here, without a clock.
//!
//! `tests/traversal_cost/counts.txt` holds for each mesh, class of rays and way through the tree how many
//! nodes rays were tested against, how many primitives, and how many tests were run for that, eight rays
//! or boxes wide. The table is the same for every instruction set (SSE2 and AVX-512 were compared): the
//! wave's box test is fused only where there is FMA, but on these rays no box hangs on its rounding. A change that is meant to change the work replaces the file; the failing test says how.

#![allow(missing_docs)]

use std::{fmt::Write as _, fs, path::Path};

use packlight::{
    bvh::Way,
    compile::{Scene, compile},
    load::{LoadOptions, load},
    render::{
        RayClass,
        measure::{Counts, count_packets, count_singles},
        ray_classes,
    },
    scene::Film,
};

const MESHES: [&str; 4] = ["gen:soup:20k", "gen:terrain:20k", "gen:spheres:20k", "gen:hair:20k"];
/// Twelve thousand rays of the camera: 128 × 96.
const FILM: Film = Film::new(128, 96);
const PINNED: &str = include_str!("traversal_cost/counts.txt");

fn scene(mesh: &str) -> Scene {
    let mut description = load(mesh.as_ref(), &LoadOptions::default()).expect("a mesh").description;
    description.sensor.film = FILM;
    compile(&description).expect("a scene")
}

fn ways(scene: &Scene, class: &RayClass) -> [(&'static str, Counts); 5] {
    [
        ("chosen", count_packets(scene, class, Way::Chosen)),
        ("tile", count_packets(scene, class, Way::Tile)),
        ("packet", count_packets(scene, class, Way::Packet)),
        ("wave", count_packets(scene, class, Way::Wave)),
        ("single", count_singles(scene, class)),
    ]
}

/// The table: exact sums, and for people what they are per ray.
fn counted() -> String {
    let mut table = String::from(
        "mesh            class    way      rays    nodes primitives    tests | a ray: nodes primitives lanes %\n",
    );
    for mesh in MESHES {
        let scene = scene(mesh);
        for class in ray_classes(&scene) {
            let rays = class.rays.len();
            for (way, counts) in ways(&scene, &class) {
                let Counts { nodes, primitives, tests } = counts;
                let a_ray = |count: u64| count as f64 / rays as f64;
                writeln!(
                    table,
                    "{mesh:<15} {:<8} {way:<6} {rays:>6} {nodes:>8} {primitives:>10} {tests:>8} | {:>12.2} {:>10.2} {:>7.1}",
                    class.name,
                    a_ray(nodes),
                    a_ray(primitives),
                    100.0 * counts.lane_use(),
                )
                .expect("a string takes all");
            }
        }
    }
    table
}

// Meshes are only the same on one platform: their angles go through the standard library's `sin_cos`.
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
#[test]
fn the_work_is_what_it_was() {
    let counted = counted();
    if counted == PINNED {
        return;
    }
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("counts.txt");
    fs::write(&path, &counted).expect("writable");
    let mut changed = String::new();
    for line in counted.lines().filter(|line| !PINNED.lines().any(|pinned| pinned == *line)) {
        let name = |line: &str| line.split_whitespace().take(3).map(str::to_owned).collect::<Vec<_>>();
        let before = PINNED.lines().find(|pinned| name(pinned) == name(line)).unwrap_or("nothing");
        let _ = writeln!(changed, "was  {before}\nis   {line}");
    }
    panic!(
        "the work has changed:\n{changed}\nIf that is what was meant, this is the new tests/traversal_cost/counts.txt \
         (cp {} tests/traversal_cost/counts.txt):\n{counted}",
        path.display()
    );
}
