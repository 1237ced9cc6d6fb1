//! The file that a render will write, checked while there is nothing to lose yet.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
    process,
};

use super::failure::Failure;
use crate::picture::Format;

/// A path whose extension says what to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Output {
    pub(super) path: PathBuf,
    pub(super) format: Format,
}

impl Output {
    /// For clap: a usage error if the extension is unknown.
    pub(super) fn parse(argument: &str) -> Result<Self, String> {
        let path = PathBuf::from(argument);
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let format = match extension.as_str() {
            "exr" => Format::Exr,
            "hdr" => Format::Hdr,
            "png" => Format::Png,
            _ => return Err("the extension decides what is written: .exr, .hdr or .png".into()),
        };
        Ok(Self { path, format })
    }

    /// [`check_writable`].
    pub(super) fn check(&self) -> Result<(), Failure> {
        check_writable(&self.path)
    }
}

/// Whether a file could be written now: an hour of rendering should not end in a mistyped folder. Leaves
/// nothing behind.
pub(super) fn check_writable(path: &Path) -> Result<(), Failure> {
    let shown = path.display();
    if path.is_dir() {
        return Err(Failure::Sentence(format!("{shown} is a folder; name a file in it")));
    }
    if path.exists() && !path.is_file() {
        // A device or a pipe is written into, whatever its folder.
        return Ok(());
    }
    let folder = folder(path);
    if !folder.is_dir() {
        let folder = folder.display();
        return Err(Failure::Sentence(format!("{shown}: there is no folder {folder}; create it first")));
    }
    // Permission bits don't tell: read-only mounts, quotas and access lists do.
    let probe = folder.join(format!(".packlight-{}.probe", process::id()));
    File::create(&probe).and_then(|_| fs::remove_file(&probe)).map_err(|error| {
        Failure::Sentence(format!("{shown}: can't write into {}: {error}", folder.display()))
    })
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_decides_in_any_case() {
        for (name, format) in [("a.exr", Format::Exr), ("b/a.HDR", Format::Hdr), ("a.b.Png", Format::Png)] {
            assert_eq!(Output::parse(name).unwrap().format, format);
        }
        for name in ["a", "a.", "a.jpg", "exr", ".exr", "a.exr.gz"] {
            assert!(Output::parse(name).is_err(), "{name}");
        }
    }

    #[test]
    fn a_bare_name_is_written_here() {
        assert_eq!(folder(Path::new("a.exr")), Path::new("."));
        assert_eq!(folder(Path::new("b/a.exr")), Path::new("b"));
    }

    #[test]
    fn a_missing_folder_and_a_folder_as_a_file_are_refused() {
        assert!(Output::parse("no/such/folder/a.exr").unwrap().check().is_err());
        let folder = Output { path: "src".into(), format: Format::Exr };
        assert!(folder.check().is_err());
    }
}
