//! Pictures at rest: named planes of floats, read from and written to EXR, HDR, PNG and JPEG.
//!
//! The only room that names the crates `image` and `exr`.

mod decode;
mod encode;
mod error;
mod limits;
mod openexr;
mod srgb;

pub use decode::{Encoding, decode};
pub use encode::{Format, Preview, encode, save, to_srgb, write_whole};
pub use error::PictureError;

/// Planes of 32-bit floats, all of one size. Row 0 is the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `R G B` for colours, in that order; any names for AOVs.
    pub channels: Vec<Channel>,
}

impl Picture {
    /// The samples of a channel.
    pub fn plane(&self, name: &str) -> Option<&[f32]> {
        self.channels.iter().find(|channel| channel.name == name).map(|channel| channel.samples.as_slice())
    }
}

/// One plane of a [`Picture`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Channel {
    /// As EXR files name it: `R`, `nn.X`.
    pub name: String,
    /// Row-major, `width` × `height`.
    pub samples: Vec<f32>,
}
