//! Camera, film and sampler.

use glam::DAffine3;

use crate::picture::Place;

/// A camera and what belongs to it. Camera space looks along +Z, +Y is up and **+X points to the
/// left** of the picture, as in Mitsuba.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Camera to world.
    pub to_world: DAffine3,
    /// How directions become pixels.
    pub projection: Projection,
    /// Rays start at this distance along the axis, in camera space; nearer geometry is invisible.
    pub near_clip: f64,
    /// Rays end at this distance along the axis, in camera space.
    pub far_clip: f64,
    /// The picture.
    pub film: Film,
    /// Samples per pixel.
    pub sampler: Sampler,
}

impl Default for Sensor {
    fn default() -> Self {
        Self {
            to_world: DAffine3::IDENTITY,
            projection: Projection::Perspective { x_fov: 0.738_448_6 },
            near_clip: 0.01,
            far_clip: 10_000.0,
            film: Film::default(),
            sampler: Sampler::default(),
        }
    }
}

/// The projection of a [`Sensor`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Pinhole.
    Perspective {
        /// Angle that the film's **width** spans, radians, in (0, π). Loaders convert other axes.
        x_fov: f64,
    },
    /// A lens without thickness: what is not at `focus_distance` is blurred.
    ThinLens {
        /// As seen from the centre of the lens; see [`Projection::Perspective`].
        x_fov: f64,
        /// Radius of the aperture, a disc, in camera space; positive.
        aperture_radius: f64,
        /// Distance along the axis of the plane in focus, in camera space; positive.
        focus_distance: f64,
    },
    /// Parallel rays; the film's width spans camera x in [-1, 1].
    Orthographic,
    /// No camera: the mean irradiance of a shape's surface, on the side of its normal, in W/m². Of the other
    /// fields only the film, which has one pixel, and the sampler count.
    IrradianceMeter {
        /// Place in [`SceneDescription::shapes`](super::SceneDescription::shapes).
        shape: u32,
    },
}

/// Size of the picture in pixels, and how samples become pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1; row 0 is the top.
    pub height: u32,
    /// The part that is rendered; `None` is all of it. It lies within the film.
    pub crop: Option<Crop>,
    /// What a pixel sees.
    pub filter: ReconstructionFilter,
    /// The channels of the picture, where it shows light.
    pub format: PixelFormat,
}

impl Film {
    /// All of a film of this size, by the box filter.
    pub const fn new(width: u32, height: u32) -> Self {
        Self { width, height, crop: None, filter: ReconstructionFilter::Box, format: PixelFormat::Rgb }
    }

    /// The part that is rendered.
    pub fn window(&self) -> Crop {
        self.crop.unwrap_or(Crop { x: 0, y: 0, width: self.width, height: self.height })
    }

    /// Where the picture is in the film, if it is a part of it.
    pub fn place(&self) -> Option<Place> {
        self.crop.map(|Crop { x, y, .. }| Place { x, y, width: self.width, height: self.height })
    }
}

impl Default for Film {
    fn default() -> Self {
        Self::new(768, 576)
    }
}

/// What is stored of a pixel. Luminance is the Y of linear sRGB; alpha is the share of the pixel in which the
/// camera sees a surface, whatever it is made of, or an environment that the `path` integrator shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PixelFormat {
    /// `R G B`.
    #[default]
    Rgb,
    /// `R G B A`.
    Rgba,
    /// `Y`.
    Luminance,
    /// `Y A`.
    LuminanceAlpha,
}

/// A rectangle of pixels of a [`Film`]. Its pixels are to the bit what they are in the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
}

/// The curve by which radiance about a pixel's centre counts, the same in x and in y. Lengths are in
/// pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ReconstructionFilter {
    /// The pixel itself, all of it alike.
    #[default]
    Box,
    /// A pyramid.
    Tent {
        /// Half of its base, in pixels; positive.
        radius: f64,
    },
    /// A bell curve, lowered so that it ends at four standard deviations.
    Gaussian {
        /// Standard deviation, in pixels; positive.
        stddev: f64,
    },
    /// Mitchell's and Netravali's cubics \[MN88\]; ends at 2 pixels.
    Mitchell {
        /// Share of blur.
        b: f64,
        /// Share of ringing.
        c: f64,
    },
    /// The sharpest of these that does not ring far: [`ReconstructionFilter::Mitchell`] with b = 0 and c = ½.
    CatmullRom,
    /// sinc x · sinc x/n.
    Lanczos {
        /// n: lobes on each side, and where it ends, in pixels; at least 1.
        lobes: u32,
    },
}

/// Where sample positions come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampler {
    /// Samples per pixel, at least 1.
    pub sample_count: u32,
    /// Changes every random decision of the render.
    pub seed: u32,
}

impl Default for Sampler {
    fn default() -> Self {
        Self { sample_count: 4, seed: 0 }
    }
}
