//! Values that vary over a surface.

use std::sync::Arc;

use glam::DAffine2;

use super::Rgb;
use crate::picture::Picture;

/// A colour for each uv.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(Rgb),
    /// 2 × 2 fields a unit of uv: `color0` where (frac u > ½) == (frac v > ½).
    Checkerboard {
        /// Linear sRGB.
        color0: Rgb,
        /// Linear sRGB.
        color1: Rgb,
        /// Applied to uv first.
        to_uv: DAffine2,
    },
    /// A picture; **v = 0 is its top row**, v grows downwards; texel centres at (i + ½)/n.
    Bitmap {
        /// Linear sRGB channels `R G B`.
        picture: Arc<Picture>,
        /// How texels are combined.
        filter: Filter,
        /// What lies outside [0, 1]².
        wrap: Wrap,
        /// Applied to uv first.
        to_uv: DAffine2,
    },
    /// What meshes say of their vertices or faces. Surfaces without it have the value 0.
    MeshAttribute {
        /// Of an [`Attribute`](super::Attribute).
        name: String,
        /// Factor on its values.
        scale: f32,
    },
}

/// How the texels about a point are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The four nearest, linearly.
    #[default]
    Bilinear,
    /// The nearest.
    Nearest,
}

/// How a texture continues outside the unit square.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Periodically.
    #[default]
    Repeat,
    /// Mirrored at each integer.
    Mirror,
    /// With its border texel.
    Clamp,
}
