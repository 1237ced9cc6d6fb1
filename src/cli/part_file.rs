//! Files that hold a part of a render.
//!
//! ```text
//! an OpenEXR file: the picture so far · the part · length of the part, 8 bytes · MARK
//! ```
//!
//! So whatever shows pictures shows a checkpoint; what is behind the last pixel is nobody's business but
//! ours.

use std::{fs, path::Path};

use super::failure::Failure;
use crate::{
    picture::{Format, PictureError, Style, encode_with, write_whole},
    render::part::{Part, PartFormatError},
};

const MARK: &[u8; 8] = b"plpart01";

/// The bytes of a file that is a picture and a part of it.
fn to_bytes(part: &Part, style: &Style) -> Result<Vec<u8>, String> {
    let picture = encode_with(&part.picture(), Format::Exr, style).map_err(|error| error.to_string())?;
    let part = part.to_bytes();
    let length = (part.len() as u64).to_le_bytes();
    Ok([&picture[..], &part, &length, MARK].concat())
}

/// Writes a part whole or not at all.
pub(super) fn save(part: &Part, path: &Path, style: &Style) -> Result<(), String> {
    let failed = |error: String| format!("{}: {error}", path.display());
    let bytes = to_bytes(part, style).map_err(failed)?;
    write_whole(path, &bytes).map_err(|error| failed(error.to_string()))
}

fn from_bytes(bytes: &[u8]) -> Result<Part, PartFormatError> {
    let part =
        bytes.strip_suffix(MARK).and_then(|bytes| bytes.split_last_chunk()).and_then(|(bytes, length)| {
            let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
            bytes.get(bytes.len().checked_sub(length)?..)
        });
    part.map_or(Err(PartFormatError::Foreign), Part::from_bytes)
}

/// Reads a part.
pub(super) fn load(path: &Path) -> Result<Part, Failure> {
    let failed = |error: String| Failure::Sentence(format!("{}: {error}", path.display()));
    let bytes = fs::read(path).map_err(|source| PictureError::Io { path: path.into(), source })?;
    from_bytes(&bytes).map_err(|error| match error {
        PartFormatError::Foreign => failed(format!(
            "{error}; those are what --checkpoint and --shard write, and an .exr of a render that was stopped"
        )),
        _ => failed(error.to_string()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_part_is_told() {
        for bytes in
            [&b""[..], b"plpart01", b"\xff\xff\xff\xff\xff\xff\xff\xffplpart01", b"v/1\x01 a picture"]
        {
            assert_eq!(from_bytes(bytes), Err(PartFormatError::Foreign));
        }
        let cut = [&b"abc"[..], &3u64.to_le_bytes(), MARK].concat();
        assert_eq!(from_bytes(&cut), Err(PartFormatError::Foreign));
    }
}
