//! What a render took, counted while it ran.

use std::time::Duration;

/// Lanes that did work, of the lanes that ran.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LaneUse {
    /// Lanes with work.
    pub active: u64,
    /// Lanes in all: eight a group.
    pub total: u64,
}

impl LaneUse {
    /// Active / total in [0, 1]; 0 if nothing ran.
    pub fn ratio(self) -> f64 {
        if self.total == 0 { 0.0 } else { self.active as f64 / self.total as f64 }
    }
}

/// Counts of one render.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Pixel samples.
    pub samples: u64,
    /// Rays from the camera.
    pub camera_rays: u64,
    /// Rays from a surface to the next one.
    pub bounce_rays: u64,
    /// Rays to a light.
    pub shadow_rays: u64,
    /// Lane use of tracing.
    pub trace_lanes: LaneUse,
    /// Lane use of shading.
    pub shade_lanes: LaneUse,
    /// Samples with a NaN or infinite value, kept out of the film.
    pub invalid_samples: u64,
    /// Pixel (x, y) and sample of the first of them, in picture order.
    pub first_invalid: Option<(u32, u32, u32)>,
    /// Wall time of rendering, without loading and building.
    pub time: Duration,
}
