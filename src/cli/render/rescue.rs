//! When the picture can't be written: what is rendered goes where there is room.

use std::path::{Path, PathBuf};

use super::keep::{Name, quick};
use crate::{
    cli::{failure::Failure, part_file},
    render::Frame,
};

/// Keeps what was rendered beside the output, else with the checkpoint, here, or among temporary files, and
/// says where.
pub(super) fn rescue(
    frame: &Frame,
    name: &Name<'_>,
    output: &Path,
    checkpoint: Option<&Path>,
    error: &str,
) -> Failure {
    let part = name.part(frame);
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    let file = format!("{stem}.rescued.exr");
    let folders = [output.parent(), checkpoint.and_then(Path::parent)];
    let folders = folders.into_iter().flatten().map(PathBuf::from);
    let mut tried =
        folders.chain([PathBuf::from("."), std::env::temp_dir()]).map(|folder| folder.join(&file));
    // Never over something that is there: it may be what an earlier failure has left.
    let saved = tried.find(|path| !path.exists() && part_file::save(&part, path, &quick()).is_ok());
    Failure::Sentence(match saved {
        Some(path) => {
            let path = path.display();
            format!(
                "{error}; what was rendered is in {path}: when there is room, run the same command with \
                 --resume {path}, and nothing is rendered twice"
            )
        }
        None => format!("{error}; and what was rendered could be kept nowhere else"),
    })
}
