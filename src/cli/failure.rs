//! Why a command stopped, and how that is told on stderr.

use std::{
    fmt::Display,
    io::{IsTerminal, Write, stderr},
};

use clap::{CommandFactory, error::ErrorKind};
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};
use terminal_size::{Width, terminal_size_of};

use super::{Cli, console::folded, excerpt::Excerpt, exit, quantity::counted};
use crate::{
    compile::CompileError,
    load::{LoadError, Warning},
    picture::PictureError,
};

/// Wide enough for a path and a sentence, narrow enough to read.
const MAX_WIDTH: usize = 100;
const MIN_WIDTH: usize = 20;
/// Away from a terminal a sentence is one line, to be searched for.
const ENDLESS: usize = 1 << 20;
/// More than this of them are not read.
const MAX_WARNINGS: usize = 20;

/// Why a command stopped.
#[derive(Debug)]
pub(super) enum Failure {
    /// The command line asks for something that does not exist or does not go together.
    Usage(clap::Error),
    /// A scene was refused: told with the offending text underlined.
    Scene(Box<LoadError>),
    /// Everything else, in a sentence that names the file and the way out.
    Sentence(String),
    /// Somebody wished it to stop: what was written, in a sentence.
    Stopped(String),
}

impl Failure {
    /// What can't be done by `command`, or not with these options: told with how it is used.
    pub(super) fn usage(command: &str, kind: ErrorKind, message: impl Display) -> Self {
        let mut program = Cli::command();
        program.build();
        let command = program.find_subcommand(command).unwrap_or(&program);
        Self::Usage(command.clone().error(kind, message))
    }

    /// The exit code.
    pub(super) fn code(&self) -> u8 {
        match self {
            // clap counts `--help` and `--version` among its errors, with code 0.
            Self::Usage(error) => u8::try_from(error.exit_code()).unwrap_or(exit::USAGE),
            Self::Scene(_) | Self::Sentence(_) => exit::FAILURE,
            Self::Stopped(_) => exit::STOPPED,
        }
    }

    /// Writes to stderr (help and version: to stdout). A closed pipe is not worth another failure.
    pub(super) fn tell(&self) {
        match self {
            Self::Usage(error) if error.use_stderr() && stderr().is_terminal() => {
                let text = error.render();
                // clap breaks help at blanks, and errors nowhere.
                tell_sentence(&if no_color() { text.to_string() } else { text.ansi().to_string() });
            }
            Self::Usage(error) => drop(error.print()),
            Self::Scene(error) => tell_report(&**error),
            Self::Sentence(sentence) => tell_sentence(&format!("{} {sentence}", headed("error:", RED))),
            Self::Stopped(sentence) => tell_sentence(sentence),
        }
    }
}

impl From<clap::Error> for Failure {
    fn from(error: clap::Error) -> Self {
        Self::Usage(error)
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<CompileError> for Failure {
    fn from(error: CompileError) -> Self {
        Self::Sentence(error.to_string())
    }
}

impl From<PictureError> for Failure {
    fn from(error: PictureError) -> Self {
        Self::Sentence(error.to_string())
    }
}

/// Warnings go to stderr, so that stdout stays what was asked for.
pub(super) fn warn(warnings: &[Warning]) {
    for warning in &warnings[..warnings.len().min(MAX_WARNINGS)] {
        tell_report(warning);
    }
    if let Some(more @ 1..) = warnings.len().checked_sub(MAX_WARNINGS) {
        warn_of(format!("and {}", counted(more as u64, "other warning")));
    }
}

/// A warning that is not about a file.
pub(super) fn warn_of(warning: impl Display) {
    tell_sentence(&format!("{} {warning}", headed("warning:", YELLOW)));
}

// As in the reports about files.
const RED: u8 = 31;
const YELLOW: u8 = 33;

/// The word that a sentence begins with, in a colour where there are any.
fn headed(word: &str, colour: u8) -> String {
    let coloured = stderr().is_terminal() && !no_color();
    if coloured { format!("\x1b[{colour}m{word}\x1b[0m") } else { word.to_owned() }
}

fn tell_sentence(text: &str) {
    tell(&folded(text, width()));
}

fn tell(text: &str) {
    // If stderr is closed there is nobody left to tell.
    let _ = stderr().lock().write_all(text.as_bytes());
}

/// <https://no-color.org>: set and not empty.
fn no_color() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
}

/// The words stand where signs would, so that they can be searched for.
fn theme(terminal: bool, no_color: bool) -> GraphicalTheme {
    let mut theme = match (terminal, no_color) {
        (false, _) => GraphicalTheme::none(),
        (true, true) => GraphicalTheme::unicode_nocolor(),
        (true, false) => GraphicalTheme::unicode(),
    };
    theme.characters.error = "error:".into();
    theme.characters.warning = "warning:".into();
    theme
}

fn tell_report(told: &dyn Diagnostic) {
    tell(&report(told, theme(stderr().is_terminal(), no_color()), width()));
}

/// Columns that a message may take.
fn width() -> usize {
    terminal_size_of(stderr())
        .map_or(ENDLESS, |(Width(columns), _)| usize::from(columns).clamp(MIN_WIDTH, MAX_WIDTH))
}

fn report(told: &dyn Diagnostic, theme: GraphicalTheme, width: usize) -> String {
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_width(width)
        .with_break_words(false)
        .with_links(false)
        .without_syntax_highlighting();
    let excerpt = Excerpt::of(told, width);
    let told = excerpt.as_ref().map_or(told, |excerpt| excerpt as &dyn Diagnostic);
    let mut text = String::new();
    match handler.render_report(&mut text, told) {
        Ok(()) => text.trim_start().to_owned(),
        Err(_) => format!("{told}\n"),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn error() -> LoadError {
        let text = "<scene>\n  <shap/>\n</scene>\n";
        LoadError::at(Path::new("a.xml"), text, 11..15, "unknown element <shap>")
            .help("did you mean <shape>?")
    }

    #[test]
    fn away_from_a_terminal_a_report_is_plain_ascii() {
        let text = report(&error(), theme(false, false), ENDLESS);
        assert!(text.is_ascii() && !text.contains('\x1b'), "{text}");
        for part in ["a.xml:2:4: unknown element <shap>", "did you mean <shape>?", "<shap/>"] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
    }

    #[test]
    fn a_sentence_is_as_wide_as_the_terminal_and_elsewhere_one_line() {
        let long = "word ".repeat(60);
        let error = LoadError::new(Path::new("a.xml"), long.trim());
        assert_eq!(report(&error, theme(false, false), ENDLESS).trim_end().lines().count(), 1);
        let narrow = report(&error, theme(true, true), 50);
        assert!(narrow.lines().count() > 6, "{narrow}");
        assert!(narrow.lines().all(|line| line.chars().count() <= 50), "{narrow}");
    }

    #[test]
    fn no_color_is_honoured_on_a_terminal() {
        assert!(!report(&error(), theme(true, true), MAX_WIDTH).contains('\x1b'));
        assert!(report(&error(), theme(true, false), MAX_WIDTH).contains('\x1b'));
    }

    #[test]
    fn failures_have_the_documented_codes() {
        assert_eq!(Failure::from(error()).code(), exit::FAILURE);
        assert_eq!(Failure::Sentence(String::new()).code(), exit::FAILURE);
        let usage = clap::Error::new(clap::error::ErrorKind::UnknownArgument);
        assert_eq!(Failure::from(usage).code(), exit::USAGE);
        let help = clap::Error::new(clap::error::ErrorKind::DisplayHelp);
        assert_eq!(Failure::from(help).code(), exit::SUCCESS);
    }
}
