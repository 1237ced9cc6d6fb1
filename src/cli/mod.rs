//! The command line: one file a command.
//!
//! The only room that prints. stdout holds what was asked for, stderr everything else.

mod bench;
mod brdf;
mod console;
mod envmap;
pub mod exit;
mod failure;
mod info;
mod memory;
mod meter;
mod output;
mod overrides;
mod progress;
mod quality;
mod quantity;
mod ray_file;
mod render;
mod replay;
mod report;
mod source;
mod threads;
mod verify;
mod way;

use std::{process::ExitCode, sync::LazyLock};

use clap::{Parser, Subcommand};

use crate::simd::cpu;

static VERSION: LazyLock<String> =
    LazyLock::new(|| format!("{}, {}", env!("CARGO_PKG_VERSION"), cpu::compiled()));

const AFTER_HELP: &str = "\
Examples:
  packlight render scenes/cornell.xml -o cornell.exr
  packlight render scenes/cornell.xml -o preview.png --spp 16 --width 400 --exposure 1
  packlight render bunny.obj -o normals.exr --integrator aov
  packlight info scenes/cornell.xml --json
  packlight bench gen:terrain:1M --threads 1
  packlight verify scenes/cornell.xml
  packlight brdf roughconductor:alpha=0.3,material=Au -o lobe.svg
  packlight meter scenes/cornell.xml --at 0,0,0 --normal 0,1,0
  packlight envmap sky.exr --sh -o sky.json

Exit codes:
  0  done
  1  a file could not be read, understood or written, or a model or scene failed its check
  2  the command line was not understood
  3  this processor lacks instructions that the program was compiled to use";

/// Traces light in packets of eight rays
#[derive(Debug, Parser)]
#[command(name = "packlight", version = VERSION.as_str(), after_help = AFTER_HELP, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a scene to a picture
    Render(Box<render::Arguments>),
    /// Show what is in a scene, and the lanes that trace it
    Info(info::Arguments),
    /// Measure how fast rays are traced
    Bench(bench::Arguments),
    /// Prove that all ways of tracing a scene agree, and that nothing leaks
    Verify(verify::Arguments),
    /// Plot a reflection model, or prove that it is one
    Brdf(Box<brdf::Arguments>),
    /// Measure the irradiance at a point
    Meter(meter::Arguments),
    /// Reduce an environment to nine coefficients
    Envmap(envmap::Arguments),
}

/// Reads the command line, does what it says, and returns one of the codes in [`exit`].
// Kept out of `main`, whose first instructions run on processors that lack ours.
#[inline(never)]
pub fn run() -> ExitCode {
    let done = Cli::try_parse().map_err(failure::Failure::from).and_then(|cli| match cli.command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Brdf(arguments) => brdf::run(&arguments),
        Command::Meter(arguments) => meter::run(&arguments),
        Command::Envmap(arguments) => envmap::run(&arguments),
    });
    match done {
        Ok(()) => ExitCode::from(exit::SUCCESS),
        Err(failure) => {
            failure.tell();
            ExitCode::from(failure.code())
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_arguments_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }

    #[test]
    fn help_documents_every_exit_code() {
        let help = Cli::command().render_help().to_string();
        for code in [exit::SUCCESS, exit::FAILURE, exit::USAGE, exit::CPU] {
            assert!(help.contains(&format!("\n  {code}  ")), "{code} is not in\n{help}");
        }
    }
}
