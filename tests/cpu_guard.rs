//! A program compiled for a newer processor says so on an older one, instead of dying of an illegal
//! instruction.

#![allow(missing_docs)]

use std::process::{Command, Output};

const PROGRAM: &str = env!("CARGO_BIN_EXE_packlight");

/// The program on a processor of that name, or `None` where there is no emulator.
fn on(processor: &str) -> Option<Output> {
    let output = Command::new("qemu-x86_64").args(["-cpu", processor, PROGRAM, "--version"]).output();
    match output {
        Ok(output) => Some(output),
        Err(_) => {
            println!("skipped: there is no qemu-x86_64 (Debian: qemu-user) on the PATH");
            None
        }
    }
}

fn refused(processor: &str, missing: &str) {
    let Some(output) = on(processor) else { return };
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{processor}: {message}");
    assert!(output.stdout.is_empty(), "{processor} wrote to stdout");
    for part in [missing, "RUSTFLAGS=\"-C target-cpu=x86-64\" cargo build --release"] {
        assert!(message.contains(part), "{processor}: {part} is not in\n{message}");
    }
}

#[test]
fn a_processor_without_avx_is_told() {
    if cfg!(target_feature = "avx") {
        refused("Nehalem", " avx");
    } else {
        println!("skipped: this build does not use AVX");
    }
}

#[test]
fn a_processor_without_avx2_is_told() {
    if cfg!(target_feature = "avx2") {
        refused("SandyBridge", " avx2");
    } else {
        println!("skipped: this build does not use AVX2");
    }
}

#[test]
fn a_processor_with_everything_is_not_bothered() {
    // What the emulator can do, without AVX-512.
    if cfg!(target_feature = "avx512f") || !cfg!(target_arch = "x86_64") {
        println!("skipped: the emulator lacks what this build uses");
        return;
    }
    let Some(output) = on("max") else { return };
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("f32x8 in "));
}
