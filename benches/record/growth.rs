//! Meshes of one kind from a thousand triangles to ten million: what a tree costs as it grows.

use std::{
    process::{Command, Stdio},
    time::Duration,
};

use packlight::{
    compile::{Scene, compile},
    load::{LoadOptions, load},
    render::ray_classes,
    scene::SceneDescription,
};

use crate::{
    options::Extent,
    row::{BUILD, Row, Table, rounded},
    run::{Run, pool},
    traced::trace,
};

/// Kinds of generated meshes.
pub(crate) const KINDS: [&str; 3] = ["soup", "terrain", "spheres"];
/// Rays of the camera, and what bounces once off what they hit.
pub(crate) const CLASSES: [&str; 2] = ["primary", "diffuse"];

/// Builds are timed until they have taken this long together, but no more often than [`MOST_BUILDS`].
const BUILDING: Duration = Duration::from_secs(3);
const MOST_BUILDS: u32 = 10;
/// Smaller trees are lost in what any process needs.
const TELLING_BYTES: u64 = 32 << 20;

/// Measures every mesh that is wanted.
pub(crate) fn measure(run: &mut Run) -> Result<(), String> {
    for kind in KINDS {
        for size in run.extent.sizes() {
            let name = format!("gen:{kind}:{size}");
            if run.options.wants(Table::Growth, &name) {
                println!("growth  {name}");
                mesh(run, &name)?;
            }
        }
    }
    Ok(())
}

fn mesh(run: &mut Run, name: &str) -> Result<(), String> {
    let mut description =
        load(name.as_ref(), &LoadOptions::default()).map_err(|error| error.to_string())?.description;
    description.sensor.film = run.extent.film();
    let all = pool(0)?;
    let (scene, time) = all.install(|| build(&description, run.extent))?;
    let mut row = run.row(all.current_num_threads(), Table::Growth, name, BUILD);
    tell_build(&scene, time, &mut row);
    let bytes = scene.summary().bvh_bytes;
    if bytes >= TELLING_BYTES {
        row.peak_per_bvh = peak(name)?.and_then(|peak| rounded(peak / bytes as f64));
    }
    run.book.take(row)?;

    let classes = all.install(|| ray_classes(&scene));
    for class in classes.iter().filter(|class| CLASSES.contains(&class.name)) {
        let mut row = run.row(1, Table::Growth, name, class.name);
        trace(&scene, class, run.extent.repeat(), &mut row)?;
        run.book.take(row)?;
    }
    Ok(())
}

/// The scene, and the best time of its tree.
fn build(description: &SceneDescription, extent: Extent) -> Result<(Scene, Duration), String> {
    let mut best = Duration::MAX;
    let mut spent = Duration::ZERO;
    for count in 1.. {
        let scene = compile(description).map_err(|error| error.to_string())?;
        let time = scene.summary().bvh_time;
        (best, spent) = (best.min(time), spent + time);
        if count == MOST_BUILDS || spent > BUILDING || extent != Extent::Full {
            return Ok((scene, best));
        }
    }
    unreachable!("the loop ends by itself")
}

fn tell_build(scene: &Scene, time: Duration, row: &mut Row) {
    let summary = scene.summary();
    let primitives = (summary.triangles + summary.quadrics) as f64;
    row.primitives = Some(summary.triangles + summary.quadrics);
    row.mega_per_s = rounded(primitives / time.as_secs_f64() / 1e6);
    row.bytes_per_primitive = rounded(summary.bvh_bytes as f64 / primitives);
}

/// The most memory that a process of its own needs to make the mesh and build its tree, in bytes; `None`
/// where the system does not say.
fn peak(name: &str) -> Result<Option<f64>, String> {
    let output = Command::new(env!("CARGO_BIN_EXE_packlight"))
        .args(["info", name, "--json"])
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("packlight info: {error}"))?;
    if !output.status.success() {
        return Err(format!("packlight info {name}: {}", String::from_utf8_lossy(&output.stderr)));
    }
    let json: serde_json::Value =
        serde_json::from_slice(&output.stdout).map_err(|error| format!("packlight info {name}: {error}"))?;
    Ok(json["peak_memory_bytes"].as_f64())
}
