//! Errors and warnings that name the place and the way out.

use std::{
    error::Error,
    fmt,
    ops::Range,
    path::Path,
    sync::{Arc, OnceLock},
};

use miette::{Diagnostic, LabeledSpan, NamedSource, Severity, SourceCode, SourceSpan};

/// Why a file was refused.
///
/// `Display` is one line, `file:line:column: what is wrong` (line and column, counted from 1, only
/// where the file is text); as a [`miette::Diagnostic`] it also shows the offending text underlined,
/// and the help.
// Boxed: every function of `load/` returns it, and none of them should pay for it when all is well.
#[derive(Debug, Clone)]
pub struct LoadError(Box<Inner>);

/// Text longer than this is not shown with an error: files without line breaks are one line.
const MAX_SHOWN: usize = 4096;

/// Bytes of the longest message.
const MAX_MESSAGE: usize = 2048;

#[derive(Debug, Clone)]
struct Inner {
    path: String,
    /// The text, and the byte that is meant. Lines are counted where somebody asks: of warnings, few are shown.
    position: Option<(Arc<str>, usize)>,
    place: OnceLock<String>,
    message: String,
    label: String,
    help: Option<String>,
    // Of one text there may be many warnings.
    excerpt: Option<(NamedSource<Arc<str>>, SourceSpan)>,
}

impl LoadError {
    /// Something is wrong with the file as a whole, or with a place that `message` describes.
    pub fn new(path: &Path, message: impl Into<String>) -> Self {
        Self(Box::new(Inner {
            path: path.display().to_string(),
            position: None,
            place: OnceLock::new(),
            message: shortened(message.into()),
            label: "here".into(),
            help: None,
            excerpt: None,
        }))
    }

    /// Something is wrong at a byte range of a text file.
    pub fn at(path: &Path, text: &str, range: Range<usize>, message: impl Into<String>) -> Self {
        Self::within(path, &text.into(), range, message)
    }

    /// [`at`](Self::at), of a text that several messages show.
    pub(super) fn within(
        path: &Path,
        text: &Arc<str>,
        range: Range<usize>,
        message: impl Into<String>,
    ) -> Self {
        let start = char_boundary(text, range.start);
        let mut error = Self::new(path, message);
        error.0.position = Some((Arc::clone(text), start));
        if shown(text, start) <= MAX_SHOWN {
            error.0.excerpt = Some((
                NamedSource::new(&error.0.path, Arc::clone(text)),
                (start, range.end.min(text.len()).saturating_sub(start)).into(),
            ));
        }
        error
    }

    /// Words under the underlined text.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.0.label = shortened(label.into());
        self
    }

    /// The way out.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.0.help = Some(shortened(help.into()));
        self
    }

    /// `file` or `file:line:column`.
    pub fn place(&self) -> &str {
        self.0.place.get_or_init(|| match &self.0.position {
            Some((text, byte)) => place(&self.0.path, text, *byte),
            None => self.0.path.clone(),
        })
    }
}

/// Without its middle, if it is longer than anybody reads: a file may name a thing by a million letters.
fn shortened(mut message: String) -> String {
    if message.len() > MAX_MESSAGE {
        let end = char_boundary(&message, message.len() - MAX_MESSAGE / 4);
        message.replace_range(char_boundary(&message, MAX_MESSAGE / 2)..end, " … ");
    }
    message
}

/// `file:line:column` of a byte of a text file, counted from 1 in characters.
fn place(path: &str, text: &str, byte: usize) -> String {
    let before = &text[..byte];
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
    format!("{path}:{line}:{column}")
}

/// Bytes of the line in which a byte stands, and of its neighbours; of long ones not all, but more than are shown.
fn shown(text: &str, byte: usize) -> usize {
    let before = &text[char_boundary(text, byte.saturating_sub(MAX_SHOWN + 1))..byte];
    let after = &text[byte..];
    let after = &after[..char_boundary(after, MAX_SHOWN + 4)];
    let length = |line: Option<&str>| line.map_or(0, str::len);
    let mut before = before.rsplit('\n');
    let mut after = after.split('\n');
    [before.next(), before.next(), after.next(), after.next()].into_iter().map(length).sum()
}

/// The last boundary of a character at or before a byte.
fn char_boundary(text: &str, byte: usize) -> usize {
    (0..=byte.min(text.len())).rev().find(|&byte| text.is_char_boundary(byte)).unwrap_or(0)
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place(), self.0.message)
    }
}

impl Error for LoadError {}

impl Diagnostic for LoadError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.0.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.0.excerpt.as_ref().map(|(source, _)| source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (_, span) = self.0.excerpt.as_ref()?;
        let label = LabeledSpan::new_with_span(Some(self.0.label.clone()), *span);
        Some(Box::new(std::iter::once(label)))
    }
}

/// Something legal that is probably not meant; the scene still loads. It is shown as an error is, and two are
/// equal that say the same of one place.
#[derive(Debug, Clone)]
pub struct Warning(LoadError);

impl Warning {
    /// About the file as a whole, or about a place that `message` describes. One sentence: what was found,
    /// and what was done about it.
    pub fn new(path: &Path, message: impl Into<String>) -> Self {
        Self(LoadError::new(path, message))
    }

    /// About a byte range of a text that several messages show.
    pub(super) fn within(
        path: &Path,
        text: &Arc<str>,
        range: Range<usize>,
        message: impl Into<String>,
    ) -> Self {
        Self(LoadError::within(path, text, range, message))
    }

    /// Words under the underlined text.
    #[must_use]
    pub fn label(self, label: impl Into<String>) -> Self {
        Self(self.0.label(label))
    }

    /// What to do about it.
    #[must_use]
    pub fn help(self, help: impl Into<String>) -> Self {
        Self(self.0.help(help))
    }

    /// `file` or `file:line:column`.
    pub fn place(&self) -> &str {
        self.0.place()
    }

    /// What is said of the place.
    pub fn message(&self) -> &str {
        &self.0.0.message
    }
}

impl PartialEq for Warning {
    fn eq(&self, other: &Self) -> bool {
        let told = |warning: &Self| warning.0.0.position.as_ref().map(|(_, byte)| *byte);
        told(self) == told(other) && self.message() == other.message() && self.0.0.path == other.0.0.path
    }
}

impl Eq for Warning {}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Error for Warning {}

impl Diagnostic for Warning {
    fn severity(&self) -> Option<Severity> {
        Some(Severity::Warning)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Diagnostic::help(&self.0)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.0.source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.0.labels()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_without_end_are_not_shown() {
        for (text, is_shown) in [
            ("a\nb\nc".to_owned(), true),
            (format!("a\nb\nc\n{}", "d".repeat(5000)), true),
            (format!("a\nb\n{}", "c".repeat(5000)), false),
            (format!("{}\nb", "a".repeat(5000)), false),
        ] {
            let error = LoadError::at(Path::new("f"), &text, 2..3, "");
            assert_eq!(error.source_code().is_some(), is_shown, "{}", text.len());
        }
    }

    #[test]
    fn long_messages_keep_their_ends() {
        let name = "ä".repeat(1_000_000);
        let told = LoadError::new(Path::new("f"), format!("there is no `{name}` here")).to_string();
        assert!(told.len() < 2 * MAX_MESSAGE, "{}", told.len());
        assert!(told.starts_with("f: there is no `ä") && told.ends_with("ä` here"), "{told}");
        let short = "x".repeat(MAX_MESSAGE);
        assert_eq!(shortened(short.clone()), short);
    }

    #[test]
    fn places_count_characters_from_one() {
        let text = "äö\nü x";
        for (byte, expected) in
            [(0, "f:1:1"), (1, "f:1:1"), (2, "f:1:2"), (5, "f:2:1"), (8, "f:2:3"), (99, "f:2:4")]
        {
            assert_eq!(LoadError::at(Path::new("f"), text, byte..byte + 1, "").place(), expected, "{byte}");
        }
    }
}
