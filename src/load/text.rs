//! Text files as exporters write them.

use std::{fs, ops::Range, path::Path};

use super::{LoadError, unreadable::unreadable};

const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// A file as UTF-8, without the mark that some editors put first. Names in other 8-bit encodings lose letters
/// but don't stop the file: everything that counts is ASCII.
pub(super) fn read(path: &Path) -> Result<String, LoadError> {
    let mut bytes = read_bytes(path)?;
    if bytes.starts_with(BYTE_ORDER_MARK) {
        bytes.drain(..BYTE_ORDER_MARK.len());
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_order_mark_is_no_text() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        for (bytes, expected) in [("\u{feff}v 0 0 0", "v 0 0 0"), ("v \u{feff}", "v \u{feff}"), ("", "")] {
            fs::write(&path, bytes).unwrap();
            assert_eq!(read(&path).unwrap(), expected);
        }
        fs::write(&path, b"\xff\xfev\0").unwrap();
        assert!(read(&path).unwrap_err().to_string().contains("UTF-16"));
    }
}
