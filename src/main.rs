//! The program: CPU guard, then the command line.

use std::{
    io::{Write, stderr},
    process::ExitCode,
};

use packlight::{cli, simd::cpu};

fn main() -> ExitCode {
    if cpu::missing().next().is_none() { cli::run() } else { refuse() }
}

/// Plain writes of constants: formatting could already meet an instruction that is missing.
#[cold]
#[inline(never)]
fn refuse() -> ExitCode {
    let mut message = stderr().lock();
    let mut say = |text: &str| {
        // There is nobody left to tell.
        let _ = message.write_all(text.as_bytes());
    };
    say("packlight: this program was compiled for a newer processor. Missing here, or switched off by\n");
    say("the operating system:");
    for name in cpu::missing() {
        say(" ");
        say(name);
    }
    say("\n\nBuild it on this machine, or for every x86-64 processor:\n");
    say("    RUSTFLAGS=\"-C target-cpu=x86-64\" cargo build --release\n");
    ExitCode::from(cli::exit::CPU)
}
