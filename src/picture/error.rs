//! What can go wrong with a picture file.

use std::{io, path::PathBuf};

/// A picture that could not be read or written; the message names the file and the way out.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file could not be opened, read or written.
    #[error("{}: {}", path.display(), said(source))]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The file is not what its name says, is damaged, or uses a feature that is not supported.
    #[error("{}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What was expected, and the way out.
        reason: String,
    },
}

/// What the system says, in words where it says it often.
fn said(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".into(),
        _ => error.to_string(),
    }
}
