//! Files read, and places in them.

use std::{
    fs,
    ops::Range,
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::load::{LoadError, Warning, unreadable::unreadable};

/// A text file in memory.
#[derive(Debug)]
pub(super) struct Source {
    path: PathBuf,
    pub(super) text: Arc<str>,
}

impl Source {
    pub(super) fn read(path: &Path) -> Result<Arc<Self>, LoadError> {
        let bytes = fs::read(path).map_err(|error| unreadable(path, &error))?;
        let text = String::from_utf8(bytes).map_err(|e| {
            LoadError::new(
                path,
                format!("is not UTF-8 text: byte {} is invalid", e.utf8_error().valid_up_to()),
            )
            .help("save the file as UTF-8")
        })?;
        Ok(Arc::new(Self { path: path.to_owned(), text: text.into() }))
    }

    /// Text that is in no file.
    pub(super) fn named(name: &Path, text: &str) -> Arc<Self> {
        Arc::new(Self { path: name.to_owned(), text: text.into() })
    }

    /// An error that underlines a range of bytes.
    pub(super) fn range_error(&self, range: Range<usize>, message: impl Into<String>) -> LoadError {
        LoadError::within(&self.path, &self.text, range, message)
    }

    pub(super) fn span(self: &Arc<Self>, range: Range<usize>) -> Span {
        Span { source: Arc::clone(self), range }
    }
}

/// A piece of a text file, to point at.
#[derive(Clone, Debug)]
pub(in crate::load) struct Span {
    source: Arc<Source>,
    range: Range<usize>,
}

impl Span {
    /// An error that underlines this piece.
    pub(super) fn error(&self, message: impl Into<String>) -> LoadError {
        self.source.range_error(self.range.clone(), message)
    }

    /// A warning about this piece.
    pub(in crate::load) fn warning(&self, message: impl Into<String>) -> Warning {
        Warning::within(&self.source.path, &self.source.text, self.range.clone(), message)
    }

    /// A name taken as relative to the folder of this piece's file.
    pub(super) fn beside(&self, file_name: &str) -> PathBuf {
        self.source.path.parent().unwrap_or(Path::new("")).join(file_name)
    }
}
