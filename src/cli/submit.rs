//! `packlight submit slurm SCENE -o OUT --shards N`: a render for the machines of a cluster.
//!
//! What a batch system can do it does: it has the array, starts again what a dead machine left, and holds the
//! merge back. Ours are the commands that it runs, and a look at scene and options before N machines do.

mod script;

use std::{
    env, fs,
    io::ErrorKind,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};

use super::{Cli, Command as Ours, console, failure::Failure, output::Output, render};
use crate::picture::write_whole;
use script::{Script, quoted};

/// What an array may have; Slurm's own limit, `MaxArraySize`, is 1001 unless its owner set another.
const MOST: i64 = 1 << 20;

const EXAMPLES: &str = "\
Examples:
  packlight submit slurm room.xml -o room.exr --shards 16
  packlight submit slurm room.xml -o room.exr --shards 16 \\
      --cpus 8 --sbatch=--time=9:00 --run
  packlight submit slurm room.xml -o room.exr --shards 64 \\
      -- --spp 4096

Scene, OUT and the program must be where all nodes see them.
Submitted twice, it goes on from its checkpoints. How OUT is
written (--exr-type half …) is up to `merge`: render by the
script, merge again by hand.";

/// Arguments of `submit`.
#[derive(Clone, Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    engine: Engine,
}

#[derive(Clone, Debug, Subcommand)]
enum Engine {
    /// A Slurm array that renders shards, and a job that merges them
    Slurm(Box<Slurm>),
}

#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
struct Slurm {
    /// Scene, as for `render`
    #[arg(value_name = "SCENE")]
    scene: PathBuf,

    /// Picture of the merge: .exr, .hdr or .png
    #[arg(short, long, value_name = "OUT", value_parser = Output::parse)]
    output: Output,

    /// Parts, one a task of the array
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(1..=MOST))]
    shards: u32,

    /// What is shared out: tiles of the picture, or samples of all of it
    #[arg(long, value_name = "WHAT", default_value = "tiles")]
    shard_by: By,

    /// Cores, and so threads, of a shard
    #[arg(long, value_name = "N", default_value = "1", value_parser = value_parser!(u32).range(1..=1024))]
    cpus: u32,

    /// Option of sbatch for both jobs, as in --sbatch=--partition=long; repeatable
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    sbatch: Vec<String>,

    /// packlight on the nodes, if it is not where this one is
    #[arg(long, value_name = "PATH")]
    program: Option<PathBuf>,

    /// Submit it, too
    #[arg(long)]
    run: bool,

    /// Options of `render` for every shard, after --
    #[arg(last = true, value_name = "RENDER-OPTIONS")]
    options: Vec<String>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum By {
    Tiles,
    Samples,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Engine::Slurm(slurm) = &arguments.engine;
    slurm.output.check()?;
    slurm.check_render()?;
    let script = slurm.script()?;
    let path = slurm.output.path.with_extension("slurm.sh");
    let failed = |path: &Path, error: &dyn std::fmt::Display| {
        Failure::Sentence(format!("{}: {error}", path.display()))
    };
    fs::create_dir_all(&script.folder).map_err(|error| failed(Path::new(&script.folder), &error))?;
    write_whole(&path, script.to_string().as_bytes()).map_err(|error| failed(&path, &error))?;
    if slurm.run {
        return submit(&path);
    }
    let path = text(&path)?;
    console::print(&format!("{path}: submit it by `sh {}`, or by --run\n", quoted(&path)))
}

/// Runs the script and tells what Slurm says.
fn submit(script: &Path) -> Result<(), Failure> {
    let shown = script.display();
    let probe = Command::new("sbatch").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if let Err(error) = probe {
        let why = match error.kind() {
            ErrorKind::NotFound => "there is no sbatch on the PATH".to_owned(),
            _ => format!("sbatch can't be started: {error}"),
        };
        return Err(Failure::Sentence(format!(
            "{why}; {shown} is written, run it by sh on a machine that has Slurm"
        )));
    }
    let failed = |why: String| Failure::Sentence(format!("{shown}: {why}"));
    let output = Command::new("sh").arg(script).stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.map_err(|error| failed(format!("sh can't be started: {error}")))?;
    console::print(&String::from_utf8_lossy(&output.stdout))?;
    if output.status.success() {
        return Ok(());
    }
    Err(failed("Slurm did not take it; what it says is above".into()))
}

impl Slurm {
    fn by(&self) -> &'static str {
        match self.shard_by {
            By::Tiles => "tiles",
            By::Samples => "samples",
        }
    }

    /// A mistake is told here, once, and not by every task of the array.
    fn check_render(&self) -> Result<(), Failure> {
        let (scene, shard) = (text(&self.scene)?, format!("1/{}", self.shards));
        let arguments = ["packlight", "render", &scene, "-o", "part.exr", "--shard", &shard, "--shard-by"];
        let kept = [self.by(), "--checkpoint", "kept.exr", "--resume", "kept.exr", "--threads", "1"];
        let words = arguments.iter().chain(&kept).copied().chain(self.options.iter().map(String::as_str));
        match Cli::try_parse_from(words)?.command {
            Ours::Render(arguments) => render::check(&arguments),
            _ => Ok(()),
        }
    }

    fn script(&self) -> Result<Script, Failure> {
        let failed = |what: &str, error: std::io::Error| Failure::Sentence(format!("{what}: {error}"));
        let program = match &self.program {
            Some(program) => program.clone(),
            None => {
                env::current_exe().map_err(|error| failed("packlight does not know where it is", error))?
            }
        };
        let here = env::current_dir().map_err(|error| failed("the current folder", error))?;
        let name = self.output.path.file_stem().unwrap_or_default();
        let folder = self.output.path.with_extension(format!("{}-{}", self.shards, self.by()));
        let script = Script {
            here: text(&here)?,
            program: text(&program)?,
            scene: text(&self.scene)?,
            output: text(&self.output.path)?,
            folder: text(&folder)?,
            name: text(Path::new(name))?,
            shards: self.shards,
            by: self.by(),
            cpus: self.cpus,
            sbatch: self.sbatch.clone(),
            options: self.options.clone(),
        };
        let words = self.sbatch.iter().chain(&self.options);
        words.map(|word| text(Path::new(word))).collect::<Result<Vec<_>, _>>()?;
        Ok(script)
    }
}

/// What can stand on a line of a script.
fn text(path: &Path) -> Result<String, Failure> {
    match path.to_str() {
        Some(text) if !text.chars().any(char::is_control) => Ok(text.to_owned()),
        _ => {
            let shown = path.display();
            Err(Failure::Sentence(format!("`{shown}` has characters that a script can't hold; rename it")))
        }
    }
}
