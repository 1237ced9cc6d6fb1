//! Text files as exporters write them.

use std::{fs, ops::Range, path::Path};

use super::{LoadError, unreadable::unreadable};

/// A file as UTF-8. Names in other 8-bit encodings lose letters but don't stop the file: everything
/// that counts is ASCII.
pub(super) fn read(path: &Path) -> Result<String, LoadError> {
    let bytes = read_bytes(path)?;
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(LoadError::new(path, "the file is UTF-16 text").help("Save it as UTF-8."));
    }
    if bytes.contains(&0) {
        return Err(LoadError::new(path, "expected a text file, found zero bytes in it"));
    }
    Ok(match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => String::from_utf8_lossy(error.as_bytes()).into_owned(),
    })
}

/// A file as it is.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, LoadError> {
    fs::read(path).map_err(|error| unreadable(path, &error))
}

/// Where `part`, a slice of `text`, stands in it.
pub(super) fn range_of(text: &str, part: &str) -> Range<usize> {
    let start = part.as_ptr().addr().saturating_sub(text.as_ptr().addr());
    start..start + part.len()
}
