//! The file of a record: measurements are merged into it one by one, so that a record can be made in pieces.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::row::Row;

/// What a file begins with.
const HEAD: &str =
    "# Made by `cargo bench --bench record`. README.md beside this file says what is in the columns.\n";

/// A file and its rows.
#[derive(Clone, Debug)]
pub(crate) struct Book {
    path: PathBuf,
    rows: Vec<Row>,
}

impl Book {
    /// Opens a file; one that is not there is an empty one.
    pub(crate) fn open(path: &Path) -> Result<Self, String> {
        let mut book = Self { path: path.to_owned(), rows: Vec::new() };
        if path.exists() {
            let told = |error: csv::Error| format!("{}: {error}", path.display());
            let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path).map_err(told)?;
            book.rows = reader.deserialize().collect::<Result<_, _>>().map_err(told)?;
        }
        Ok(book)
    }

    /// The newest record of a folder: files begin with their dates.
    pub(crate) fn newest(folder: &Path) -> Result<Self, String> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let files = entries.map(|entry| entry.path());
        let newest = files.filter(|path| path.extension().is_some_and(|extension| extension == "csv")).max();
        Self::open(&newest.ok_or_else(|| format!("{} holds no record yet", folder.display()))?)
    }

    /// Where it is kept.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// All measurements, in the order in which they were first made.
    pub(crate) fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Takes a measurement, in place of an earlier one of the same thing, and writes the file.
    pub(crate) fn take(&mut self, row: Row) -> Result<(), String> {
        match self.rows.iter_mut().find(|earlier| row.replaces(earlier)) {
            Some(earlier) => *earlier = row,
            None => self.rows.push(row),
        }
        self.save()
    }

    /// Writes beside the file and renames, so that a record is whole or as it was.
    fn save(&self) -> Result<(), String> {
        let told = |error: &dyn std::error::Error| format!("{}: {error}", self.path.display());
        let mut writer = csv::Writer::from_writer(HEAD.as_bytes().to_vec());
        for row in &self.rows {
            writer.serialize(row).map_err(|error| told(&error))?;
        }
        let bytes = writer.into_inner().map_err(|error| told(&error))?;
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder).map_err(|error| told(&error))?;
        }
        let unfinished = self.path.with_extension("csv.unfinished");
        fs::write(&unfinished, bytes).map_err(|error| told(&error))?;
        fs::rename(&unfinished, &self.path).map_err(|error| told(&error))
    }
}
