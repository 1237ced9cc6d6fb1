//! Scene to film.

mod statistics;

pub use statistics::{LaneUse, Statistics};

use crate::{compile::Scene, picture::Picture};

/// Which of the two pipelines renders. Their pictures are equal to the bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backend {
    /// Eight rays at a time.
    #[default]
    Packet,
    /// One ray at a time, from the scalar functions: the reference.
    Scalar,
}

/// How to render. None of it changes a bit of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Packet or scalar.
    pub backend: Backend,
    /// Hits are sorted by material before they are shaded.
    pub sort: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { backend: Backend::Packet, sort: true }
    }
}

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Pixel samples finished.
    pub done: u64,
    /// Pixel samples in all.
    pub total: u64,
}

/// A finished render.
#[derive(Clone, Debug, Default)]
pub struct Rendered {
    /// `R G B`, or the channels of the AOV integrator.
    pub picture: Picture,
    /// What it took.
    pub statistics: Statistics,
}

/// Renders on the current rayon pool. `progress` is called from its threads, now and then.
pub fn render(scene: &Scene, settings: &Settings, progress: &(dyn Fn(Progress) + Sync)) -> Rendered {
    let _ = (scene, settings, progress);
    Rendered::default()
}
