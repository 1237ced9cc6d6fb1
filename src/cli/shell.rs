//! `packlight completions SHELL` and `packlight man FOLDER`: what the command line says of itself.

use std::{
    fs,
    path::{Path, PathBuf},
};

use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;

use super::{Cli, console, failure::Failure, output::check_writable};
use crate::picture::write_whole;

const SHELLS: &str = "\
Examples:
  source <(packlight completions bash)
  packlight completions zsh > ~/.zfunc/_packlight
  packlight completions fish \\
      > ~/.config/fish/completions/packlight.fish";

const PAGES: &str = "\
Examples:
  packlight man ~/.local/share/man/man1";

/// Arguments of `completions`.
#[derive(Clone, Debug, Args)]
#[command(after_help = SHELLS)]
pub(super) struct Completions {
    /// Whose words are to be completed
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Arguments of `man`.
#[derive(Clone, Debug, Args)]
#[command(after_help = PAGES)]
pub(super) struct Manual {
    /// Folder for one page a command: packlight.1, packlight-render.1 …; made if it is not there
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

/// Prints a script for a shell.
pub(super) fn complete(arguments: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "packlight", &mut script);
    console::print_as_it_is(&String::from_utf8_lossy(&script))
}

/// Writes pages for `man`.
pub(super) fn manual(arguments: &Manual) -> Result<(), Failure> {
    // `packlight help` has nothing to say that a page does not, and lanes are those of one machine.
    let mut program = Cli::command().disable_help_subcommand(true).version(env!("CARGO_PKG_VERSION"));
    program.build();
    let folder = &arguments.folder;
    fs::create_dir_all(folder)
        .map_err(|error| Failure::Sentence(format!("{}: {error}", folder.display())))?;
    write_pages(&arguments.folder, &program, "packlight")
}

/// The page of a command, and those of the commands below it.
fn write_pages(folder: &Path, command: &Command, name: &str) -> Result<(), Failure> {
    let path = folder.join(format!("{name}.1"));
    check_writable(&path)?;
    let mut page = Vec::new();
    let rendered = clap_mangen::Man::new(command.clone()).render(&mut page);
    rendered
        .and_then(|()| write_whole(&path, &page))
        .map_err(|error| Failure::Sentence(format!("{}: {error}", path.display())))?;
    command
        .get_subcommands()
        .try_for_each(|below| write_pages(folder, below, &format!("{name}-{}", below.get_name())))
}
