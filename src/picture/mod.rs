//! Pictures at rest: named planes of floats, read from and written to EXR, HDR, PNG and JPEG.
//!
//! The only room that names the crates `image` and `exr`.

mod decode;
mod encode;
mod error;
mod exr_blocks;
mod exr_header;
mod exr_zip;
mod limits;
mod openexr;
mod srgb;
mod tonemap;

use std::fmt;

use crate::math::Digest;
pub use decode::{Encoding, decode};
pub use encode::{
    Format, Preview, Style, check_layout, encode, encode_with, save, save_with, to_srgb, write_whole,
};
pub use error::PictureError;
pub use openexr::{ExrCompression, ExrStyle};
pub use tonemap::Tone;

/// What the header of an OpenEXR file says in words: names and texts, in its order. Nothing, if it is none.
pub fn exr_attributes(bytes: &[u8]) -> Vec<(String, String)> {
    if bytes.starts_with(&openexr::MAGIC) { exr_header::strings(bytes) } else { Vec::new() }
}

/// Planes of 32-bit floats, all of one size. Row 0 is the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `R G B` for colours, in that order; any names for AOVs.
    pub channels: Vec<Channel>,
    /// Where it is in a larger one, if it is a part of one. Only an EXR says so.
    pub place: Option<Place>,
}

/// Where a picture is in the whole that it is a part of. In pixels of the whole, row 0 is the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The column in which it begins.
    pub x: u32,
    /// The row in which it begins.
    pub y: u32,
    /// Columns of the whole.
    pub width: u32,
    /// Rows of the whole.
    pub height: u32,
}

impl Picture {
    /// The samples of a channel.
    pub fn plane(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|channel| channel.name == name).map(|channel| channel.samples.as_slice())
    }
}

/// One plane of a [`Picture`].
#[derive(Clone, Default, PartialEq)]
pub struct Channel {
    /// As EXR files name it: `R`, `nn.X`.
    pub name: String,
    /// Row-major, `width` × `height`. Of colours, linear sRGB; of others, what the name says.
    pub samples: Vec<f32>,
}

/// The number of samples and a digest of them.
impl fmt::Debug for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Channel")
            .field("name", &self.name)
            .field("samples", &self.samples.len())
            .field("digest", &Digest::default().floats(self.samples.iter().copied()).value())
            .finish()
    }
}
