//! Errors and warnings that name the place and the way out.

use std::{fmt, ops::Range, path::Path};

use miette::{Diagnostic, NamedSource, SourceSpan};

/// Why a file was refused.
///
/// `Display` is one line, `file:line:column: what is wrong` (line and column, counted from 1, only
/// where the file is text); as a [`miette::Diagnostic`] it also shows the offending text underlined,
/// and the help.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{place}: {message}")]
pub struct LoadError {
    place: String,
    message: String,
    label: String,
    help: Option<String>,
    excerpt: Option<(NamedSource<String>, SourceSpan)>,
}

impl LoadError {
    /// Something is wrong with the file as a whole, or with a place that `message` describes.
    pub fn new(path: &Path, message: impl Into<String>) -> Self {
        Self {
            place: path.display().to_string(),
            message: message.into(),
            label: "here".into(),
            help: None,
            excerpt: None,
        }
    }

    /// Something is wrong at a byte range of a text file.
    pub fn at(path: &Path, text: &str, range: Range<usize>, message: impl Into<String>) -> Self {
        let start = text.floor_char_boundary(range.start.min(text.len()));
        let before = &text[..start];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        let name = path.display().to_string();
        Self {
            place: format!("{name}:{line}:{column}"),
            excerpt: Some((
                NamedSource::new(name, text.to_owned()),
                (start, range.end.saturating_sub(start)).into(),
            )),
            ..Self::new(path, message)
        }
    }

    /// Words under the underlined text.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// The way out.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// `file` or `file:line:column`.
    pub fn place(&self) -> &str {
        &self.place
    }
}

impl Diagnostic for LoadError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.excerpt.as_ref().map(|(source, _)| source as &dyn miette::SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        let (_, span) = self.excerpt.as_ref()?;
        let label = miette::LabeledSpan::new_with_span(Some(self.label.clone()), *span);
        Some(Box::new(std::iter::once(label)))
    }
}

/// Something legal that is probably not meant; the scene still loads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Warning {
    /// `file` or `file:line:column`.
    pub place: String,
    /// One sentence: what was found and what was done about it.
    pub message: String,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}
