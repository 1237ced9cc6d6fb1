//! The MERL database's binary files \[MPB03\].
//!
//! ```text
//! i32 90, i32 90, i32 180, then 3 × 90·90·180 f64, little-endian: all of red, green, blue;
//! f = value × (1, 1.15, 1.66)/1500
//! ```

use super::{MERL_CELLS, MerlTable};

/// What a stored number is multiplied with, by channel.
const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
const HEADER: usize = 12;

/// Why bytes are no MERL table.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MerlError {
    /// The file does not begin with 90, 90, 180.
    #[error("its table has {0} × {1} × {2} cells, not 90 × 90 × 180: it is no MERL file")]
    Cells(i32, i32, i32),
    /// Too short or too long.
    #[error("it has {found} bytes, but a MERL file has {expected}")]
    Size {
        /// Bytes in the file.
        found: usize,
        /// Bytes of any MERL file.
        expected: usize,
    },
    /// NaN or an infinity.
    #[error("value {0} of {1} is not a finite number")]
    NotFinite(usize, &'static str),
}

impl MerlTable {
    /// Reads a file's bytes.
    ///
    /// # Errors
    /// [`MerlError`].
    pub fn decode(bytes: &[u8]) -> Result<Self, MerlError> {
        let cells: usize = MERL_CELLS.iter().product();
        let expected = HEADER + cells * 3 * 8;
        let size = MerlError::Size { found: bytes.len(), expected };
        let (header, body) = bytes.split_at_checked(HEADER).ok_or_else(|| size.clone())?;
        let mut sides = header.chunks_exact(4).map(|b| i32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        let mut side = || sides.next().unwrap_or(0);
        let found = [side(), side(), side()];
        if found != MERL_CELLS.map(|n| n as i32) {
            return Err(MerlError::Cells(found[0], found[1], found[2]));
        }
        if bytes.len() != expected {
            return Err(size);
        }
        let mut values = vec![[0.0; 3]; cells];
        for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
            let plane = &body[channel * cells * 8..][..cells * 8];
            for (i, (cell, b)) in values.iter_mut().zip(plane.chunks_exact(8)).enumerate() {
                let stored = f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]);
                let value = (stored * SCALE[channel]) as f32;
                if !value.is_finite() {
                    return Err(MerlError::NotFinite(i, name));
                }
                cell[channel] = value;
            }
        }
        Ok(Self::new(values))
    }

    /// The bytes of a file.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADER + self.values.len() * 24);
        for side in MERL_CELLS {
            bytes.extend((side as i32).to_le_bytes());
        }
        for (channel, scale) in SCALE.into_iter().enumerate() {
            bytes
                .extend(self.values.iter().flat_map(|cell| (f64::from(cell[channel]) / scale).to_le_bytes()));
        }
        bytes
    }
}
