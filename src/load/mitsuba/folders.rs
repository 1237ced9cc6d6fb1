//! Where the files are that a scene names.

use std::path::{Path, PathBuf};

use super::source::Span;
use crate::load::LoadError;

/// Folders in which files are looked for, first that of the last `path` element, last that of the scene.
#[derive(Debug, Default)]
pub(super) struct Folders(Vec<PathBuf>);

impl Folders {
    /// Those of a scene file.
    pub(super) fn of_scene(path: &Path) -> Self {
        Self(vec![path.parent().unwrap_or(Path::new("")).to_owned()])
    }

    /// Another one, before all others.
    pub(super) fn prepend(&mut self, folder: PathBuf) {
        self.0.insert(0, folder);
    }

    /// Where a name may lead: after our folders, to that of the file in which it stands.
    fn candidates(&self, span: &Span, name: &str) -> Vec<PathBuf> {
        let mut candidates: Vec<PathBuf> = self.0.iter().map(|folder| folder.join(name)).collect();
        candidates.push(span.beside(name));
        let mut seen = Vec::new();
        candidates.retain(|path| {
            let new = !seen.contains(path);
            seen.push(path.clone());
            new
        });
        candidates
    }

    /// A file.
    ///
    /// # Errors
    /// If there is none, at the name.
    pub(super) fn file(&self, span: &Span, name: &str) -> Result<PathBuf, LoadError> {
        let candidates = self.candidates(span, name);
        candidates.iter().find(|path| path.is_file()).cloned().ok_or_else(|| {
            span.error(format!("there is no file `{name}`")).label("not found").help(format!(
                "looked for {}; names are relative to the scene file's folder, or to a <path value=\"…\"/>",
                candidates
                    .iter()
                    .map(|path| absolute(path).display().to_string())
                    .collect::<Vec<_>>()
                    .join(", ")
            ))
        })
    }

    /// A folder, looked for beside the file in which its name stands, then as files are.
    ///
    /// # Errors
    /// If there is none, at the name.
    pub(super) fn folder(&self, span: &Span, name: &str) -> Result<PathBuf, LoadError> {
        let beside = [span.beside(name)];
        let candidates = || beside.iter().cloned().chain(self.0.iter().map(|folder| folder.join(name)));
        candidates().find(|path| path.is_dir()).ok_or_else(|| {
            span.error(format!("there is no folder `{name}`"))
                .label("not found")
                .help(format!("looked for {}", absolute(&beside[0]).display()))
        })
    }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}
