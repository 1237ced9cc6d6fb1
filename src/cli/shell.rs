//! `packlight completions SHELL` and `packlight man FOLDER`: what the command line says of itself.

use std::path::PathBuf;

use clap::{Args, Command, CommandFactory};
use clap_complete::Shell;

use super::{Cli, console, failure::Failure, output::check_writable};
use crate::picture::write_whole;

/// Arguments of `completions`.
#[derive(Clone, Debug, Args)]
pub(super) struct Completions {
    /// Whose words are to be completed
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

/// Arguments of `man`.
#[derive(Clone, Debug, Args)]
pub(super) struct Manual {
    /// Folder for one page a command: packlight.1, packlight-render.1 …
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

/// Prints a script for a shell.
pub(super) fn complete(arguments: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Cli::command(), "packlight", &mut script);
    console::print(&String::from_utf8_lossy(&script))
}

/// Writes pages for `man`.
pub(super) fn manual(arguments: &Manual) -> Result<(), Failure> {
    let mut program = Cli::command();
    program.build();
    write_page(arguments, &program, "packlight")?;
    for command in program.get_subcommands().filter(|command| command.get_name() != "help") {
        write_page(arguments, command, &format!("packlight-{}", command.get_name()))?;
    }
    Ok(())
}

fn write_page(arguments: &Manual, command: &Command, name: &str) -> Result<(), Failure> {
    let path = arguments.folder.join(format!("{name}.1"));
    check_writable(&path)?;
    let mut page = Vec::new();
    let rendered = clap_mangen::Man::new(command.clone()).render(&mut page);
    rendered
        .and_then(|()| write_whole(&path, &page))
        .map_err(|error| Failure::Sentence(format!("{}: {error}", path.display())))
}
