//! What can go wrong with a picture file.

use std::path::PathBuf;

/// A picture that could not be read or written; the message names the file and the way out.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file could not be opened, read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
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
