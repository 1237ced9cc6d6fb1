//! Files of rays that commands are given.

use std::{fs, path::Path};

use super::failure::Failure;
use crate::geometry::ray_file::RayFile;

/// The rays of a file; one without any is refused.
pub(super) fn read(path: &Path) -> Result<RayFile, Failure> {
    let refuse = |message: String| Failure::Sentence(format!("{}: {message}", path.display()));
    let bytes = fs::read(path).map_err(|error| refuse(error.to_string()))?;
    let file = RayFile::decode(&bytes).map_err(|error| refuse(error.to_string()))?;
    if file.rays.is_empty() {
        return Err(refuse("there are no rays in the file".into()));
    }
    Ok(file)
}
