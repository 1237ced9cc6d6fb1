//! `packlight merge part-*.exr -o OUT`: shards to the picture that one machine would have made.

use std::path::PathBuf;

use clap::Args;

use super::{
    console,
    failure::Failure,
    metadata::{About, samples},
    output::Output,
    part_file,
    quantity::counted,
    style::StyleOptions,
};
use crate::{
    picture::save_with,
    render::part::{Merged, Part, merge},
};

const EXAMPLES: &str = "\
Examples:
  packlight merge part-*.exr -o whole.exr
  packlight merge part-*.exr -o preview.png --partial";

/// Arguments of `merge`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// What `render --shard` has written, all of it, in any order
    #[arg(value_name = "PART", required = true)]
    parts: Vec<PathBuf>,

    /// Picture to write: .exr, .hdr or .png
    #[arg(short, long, value_name = "OUT", value_parser = Output::parse)]
    output: Output,

    /// Merge what is there, even if parts are missing or not finished
    #[arg(long)]
    partial: bool,

    #[command(flatten)]
    style: StyleOptions,

    /// No summary
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Output { path, format } = &arguments.output;
    arguments.output.check()?;
    arguments.style.warn_of_idle(*format);
    let load = |path: &PathBuf| Ok((path.display().to_string(), part_file::load(path)?));
    let parts = arguments.parts.iter().map(load).collect::<Result<Vec<(String, Part)>, Failure>>()?;
    let count = parts.len();
    let Merged { facts, scene, samples: asked, picture, statistics, coverage, missing } =
        merge(parts, arguments.partial).map_err(|error| Failure::Sentence(error.to_string()))?;
    let about = About { scene: &scene, facts: &facts, samples: asked, statistics: &statistics, coverage };
    save_with(&picture, path, &arguments.style.style(&about))?;
    if arguments.quiet {
        return Ok(());
    }
    let left_out = match missing.len() {
        0 => String::new(),
        n => format!(", {} not there", counted(n as u64, "shard")),
    };
    console::print(&format!(
        "{} of {scene} -> {}\n  picture  {} x {}, {} samples a pixel{left_out}\n",
        counted(count as u64, "part"),
        path.display(),
        picture.width,
        picture.height,
        samples(coverage, asked),
    ))
}
