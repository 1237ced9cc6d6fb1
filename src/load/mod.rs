//! Files to a [`SceneDescription`]: the door at which bad numbers stop.

mod error;

use std::path::Path;

pub use error::{LoadError, Warning};

use crate::scene::SceneDescription;

/// What the command line may say about a file.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// `-D name=value`: values of `$name`, stronger than `<default>`.
    pub defines: Vec<(String, String)>,
}

/// A loaded scene, and what was legal but probably wrong in its files.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    /// The scene.
    pub description: SceneDescription,
    /// In the order found.
    pub warnings: Vec<Warning>,
}

/// Loads a scene file (`.xml`) or a bare mesh (`.obj`, `.ply`).
///
/// # Errors
/// [`LoadError`] with file, line, column and the way out.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded, LoadError> {
    let _ = (path, options);
    Ok(Loaded::default())
}
