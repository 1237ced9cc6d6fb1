//! A file that can't be read, and which one may have been meant.

use std::{
    ffi::OsStr,
    fs, io,
    path::{self, Path, PathBuf},
};

use super::{LoadError, mitsuba::nearest};

/// Names in a folder that are compared with the one that is not there.
const MOST: usize = 10_000;

/// What the system says of a file, with the way out.
pub(super) fn unreadable(path: &Path, error: &io::Error) -> LoadError {
    if error.kind() != io::ErrorKind::NotFound {
        return LoadError::new(path, format!("can't be read: {error}"));
    }
    let missing = LoadError::new(path, "can't be read: there is no such file");
    match meant(path) {
        Some(other) => missing.help(format!("did you mean `{}`?", other.display())),
        None => {
            missing.help(format!("looked for {}", path::absolute(path).as_deref().unwrap_or(path).display()))
        }
    }
}

/// The file beside it of the same kind whose name is most like it, if any is alike.
fn meant(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = fs::read_dir(folder).ok()?.take(MOST).flatten();
    let files: Vec<PathBuf> = entries
        .map(|entry| path.with_file_name(entry.file_name()))
        .filter(|file| file.extension() == path.extension())
        .collect();
    let stem = |path: &Path| path.file_stem().and_then(OsStr::to_str).map(String::from);
    let stems: Vec<String> = files.iter().map(|file| stem(file).unwrap_or_default()).collect();
    let found = nearest(&stem(path)?, stems.iter().map(String::as_str))?;
    let at = stems.iter().position(|stem| stem == found)?;
    files.get(at).cloned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_of_the_same_kind_is_meant() {
        let folder = tempfile::tempdir().expect("the folder for temporary files can be written");
        for name in ["cornell.xml", "cornel.obj", "whitted.xml"] {
            fs::write(folder.path().join(name), "").expect("writable");
        }
        let meant = |name: &str| meant(&folder.path().join(name));
        assert_eq!(meant("cornel.xml"), Some(folder.path().join("cornell.xml")));
        for far in ["quark.xml", "no/such/cornell.xml", "cornell.ply"] {
            assert_eq!(meant(far), None, "{far}");
        }
        // A name without a folder is one in this one.
        assert_eq!(super::meant(Path::new("Carg.toml")), Some("Cargo.toml".into()));
    }
}
