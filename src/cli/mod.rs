//! The command line: one file a command.
//!
//! The only room that prints. stdout holds what was asked for, stderr everything else.

mod bench;
mod brdf;
mod compare;
mod console;
mod duration;
mod envmap;
mod excerpt;
pub mod exit;
mod failure;
mod info;
mod memory;
mod merge;
mod metadata;
mod meter;
mod output;
mod overrides;
mod part_file;
mod progress;
mod quality;
mod quantity;
mod ray_file;
mod render;
mod replay;
mod report;
mod shell;
mod signals;
mod source;
mod style;
mod submit;
mod threads;
mod verify;
mod way;

use std::{process::ExitCode, sync::LazyLock};

use clap::{Parser, Subcommand};

use crate::simd::cpu;

static VERSION: LazyLock<String> =
    LazyLock::new(|| format!("{}, {}", env!("CARGO_PKG_VERSION"), cpu::compiled()));

/// The heading of options that are the same for many commands.
const MACHINE: &str = "Machine (never changes a bit of what comes out)";

const AFTER_HELP: &str = "\
Examples:
  packlight render scenes/cornell.xml -o cornell.exr
  packlight render scenes/cornell.xml -o quick.png --spp 16
  packlight render bunny.obj -o normals.exr --integrator aov
  packlight render room.xml -o part-3.exr --shard 3/16
  packlight merge part-*.exr -o whole.exr
  packlight submit slurm room.xml -o room.exr --shards 16
  packlight compare reference.exr test.exr -o difference.png
  packlight info scenes/cornell.xml --json
  packlight bench gen:terrain:1M --threads 1
  packlight verify scenes/cornell.xml
  packlight brdf roughconductor:material=Au -o gold.svg
  packlight meter room.xml --at 0,0,0 --normal 0,1,0
  packlight envmap sky.exr --sh -o sky.json
  packlight completions zsh > ~/.zfunc/_packlight

Exit codes:
  0  done
  1  a file could not be read, understood or written, a
     scene does not fit --memory-limit, or a model, a scene
     or a picture failed its check
  2  the command line was not understood
  3  this processor lacks instructions that the program was
     compiled for
  4  stopped by a signal; what was there was written";

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
    /// Put the parts of a render together
    Merge(merge::Arguments),
    /// Render a scene in shards on the machines of a cluster
    Submit(submit::Arguments),
    /// Say how two pictures differ
    Compare(compare::Arguments),
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
    /// Print a script by which a shell completes packlight's words
    Completions(shell::Completions),
    /// Write pages for `man`
    Man(shell::Manual),
}

/// Reads the command line, does what it says, and returns one of the codes in [`exit`].
// Kept out of `main`, whose first instructions run on processors that lack ours.
#[inline(never)]
pub fn run() -> ExitCode {
    let done = Cli::try_parse().map_err(failure::Failure::from).and_then(|cli| match cli.command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Merge(arguments) => merge::run(&arguments),
        Command::Submit(arguments) => submit::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Brdf(arguments) => brdf::run(&arguments),
        Command::Meter(arguments) => meter::run(&arguments),
        Command::Envmap(arguments) => envmap::run(&arguments),
        Command::Completions(arguments) => shell::complete(&arguments),
        Command::Man(arguments) => shell::manual(&arguments),
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

    /// A command and all that are below it.
    fn below(command: &clap::Command) -> Vec<&clap::Command> {
        let commands = command.get_subcommands().filter(|below| below.get_name() != "help");
        std::iter::once(command).chain(commands.flat_map(below)).collect()
    }

    #[test]
    fn every_command_has_examples_and_none_is_wider_than_a_narrow_terminal() {
        let mut cli = Cli::command();
        cli.build();
        for command in below(&cli).into_iter().filter(|command| command.get_name() != "submit") {
            let name = command.get_bin_name().unwrap_or("packlight");
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            let examples = help.split("Examples:\n").nth(1).unwrap_or_else(|| panic!("{name} has none"));
            assert!(examples.contains(&format!("  {name} ")), "{name}: {help}");
            for columns in [60, 80] {
                let mut whole = command.clone().term_width(columns);
                let whole = whole.render_long_help().to_string();
                for line in whole.lines() {
                    // A usage is a line, whatever is in it.
                    assert!(line.chars().count() <= columns || line.starts_with("Usage:"), "{name}: {line}");
                }
                // No line of it had to be broken: what is copied from a terminal is a command.
                assert!(whole.contains(&help), "{name}: {whole}");
            }
        }
    }

    /// What other programs call it is understood too.
    #[test]
    fn names_of_pbrt_and_mitsuba_are_understood() {
        for words in [
            "render a.xml --outfile b.exr --nthreads 2 --pixelbounds 0,1,0,1 --seed 3 --spp 4 --quiet",
            "render a.xml -o b.exr -t 2 -D spp=4 -s 1",
            "render a.xml -o b.exr --cropwindow 0,0.5,0,1",
            "bench a.xml -t 1",
        ] {
            let parsed = Cli::try_parse_from(format!("packlight {words}").split(' '));
            assert!(
                parsed.is_ok(),
                "{words}: {}",
                parsed.map_or_else(|error| error.to_string(), |_| String::new())
            );
        }
    }

    #[test]
    fn help_documents_every_exit_code() {
        let help = Cli::command().render_help().to_string();
        for code in [exit::SUCCESS, exit::FAILURE, exit::USAGE, exit::CPU, exit::STOPPED] {
            assert!(help.contains(&format!("\n  {code}  ")), "{code} is not in\n{help}");
        }
    }
}
