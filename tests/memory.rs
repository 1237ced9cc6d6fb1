//! Memory belongs to the scene and the film, not to the number of samples: the peak of a render, as the system counts it
//! for a process of its own.

#![allow(missing_docs)]
#![cfg(target_os = "linux")]

use std::{path::Path, process::Command};

/// How much more memory the longer render may take, as a share: what allocators and page sizes make of the same needs.
const SPREAD: f64 = 0.05;

/// The most memory that a render had, in MiB.
fn peak(scene: &str, samples: u32) -> f64 {
    let picture = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("memory-{samples}.exr"));
    let output = Command::new(env!("CARGO_BIN_EXE_packlight"))
        .args(["render", scene, "--width", "32", "--height", "32", "--threads", "2", "--json"])
        .args(["--spp", &samples.to_string(), "--output"])
        .arg(picture)
        .output()
        .expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a report in JSON");
    assert_eq!(report["samples_per_pixel"], samples);
    report["peak_memory_bytes"].as_f64().expect("the peak is known") / f64::from(1 << 20)
}

#[test]
fn memory_does_not_grow_with_samples() {
    let scene = "scenes/cornell.xml";
    // What threads add by when they run, they don't add every time.
    let least = |samples| (0..3).map(|_| peak(scene, samples)).fold(f64::INFINITY, f64::min);
    let (few, many) = (least(16), least(4096));
    println!("{scene}: {few:.2} MiB by 16 samples, {many:.2} by 4096");
    assert!((many / few - 1.0).abs() <= SPREAD, "{few:.2} MiB by 16 samples, {many:.2} by 4096");
}
