//! Why a command stopped, and how that is told on stderr.

use std::{
    fmt::Display,
    io::{IsTerminal, Write, stderr},
};

use miette::{GraphicalReportHandler, GraphicalTheme};

use super::exit;
use crate::{
    compile::CompileError,
    load::{LoadError, Warning},
    picture::PictureError,
};

/// Wide enough for a path and a sentence, narrow enough to read.
const REPORT_WIDTH: usize = 100;

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
            Self::Usage(error) => drop(error.print()),
            Self::Scene(error) => tell(&report(error, theme(stderr().is_terminal(), no_color()))),
            Self::Sentence(sentence) => tell(&format!("error: {sentence}\n")),
            Self::Stopped(sentence) => tell(&format!("{sentence}\n")),
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
    for warning in warnings {
        warn_of(warning);
    }
}

/// A warning that is not about a file.
pub(super) fn warn_of(warning: impl Display) {
    tell(&format!("warning: {warning}\n"));
}

fn tell(text: &str) {
    // If stderr is closed there is nobody left to tell.
    let _ = stderr().lock().write_all(text.as_bytes());
}

/// <https://no-color.org>: set and not empty.
fn no_color() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
}

fn theme(terminal: bool, no_color: bool) -> GraphicalTheme {
    match (terminal, no_color) {
        (false, _) => GraphicalTheme::none(),
        (true, true) => GraphicalTheme::unicode_nocolor(),
        (true, false) => GraphicalTheme::unicode(),
    }
}

fn report(error: &LoadError, theme: GraphicalTheme) -> String {
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_width(REPORT_WIDTH)
        .with_break_words(false)
        .with_links(false)
        .without_syntax_highlighting();
    let mut text = String::new();
    match handler.render_report(&mut text, error) {
        Ok(()) => text,
        Err(_) => format!("error: {error}\n"),
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
        let text = report(&error(), theme(false, false));
        assert!(text.is_ascii() && !text.contains('\x1b'), "{text}");
        for part in ["a.xml:2:4: unknown element <shap>", "did you mean <shape>?", "<shap/>"] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
    }

    #[test]
    fn no_color_is_honoured_on_a_terminal() {
        assert!(!report(&error(), theme(true, true)).contains('\x1b'));
        assert!(report(&error(), theme(true, false)).contains('\x1b'));
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
