//! What a render took, counted while it ran.

use std::{ops::AddAssign, time::Duration};

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

impl LaneUse {
    /// Packets filled with this many rays.
    pub(super) fn of_packets(rays: usize) -> Self {
        let total = rays.next_multiple_of(crate::simd::LANES);
        Self { active: rays as u64, total: total as u64 }
    }

    /// A group of eight with this many lanes at work.
    pub(super) fn add(&mut self, active: u32) {
        self.active += u64::from(active);
        self.total += crate::simd::LANES as u64;
    }
}

impl AddAssign for LaneUse {
    fn add_assign(&mut self, other: Self) {
        self.active += other.active;
        self.total += other.total;
    }
}

/// Time by stage, summed over threads. The reference has no stages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stages {
    /// Rays to the next surface.
    pub trace: Duration,
    /// Sorting, surfaces, materials and lights.
    pub shade: Duration,
    /// Rays to lights.
    pub connect: Duration,
    /// Adding what vertices said, and closing the ranks of the paths that go on.
    pub add: Duration,
}

impl AddAssign for Stages {
    fn add_assign(&mut self, other: Self) {
        self.trace += other.trace;
        self.shade += other.shade;
        self.connect += other.connect;
        self.add += other.add;
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
    /// Where the time of the threads went.
    pub stages: Stages,
    /// Wall time of rendering, without loading and building.
    pub time: Duration,
}

impl Statistics {
    /// Adds the counts of another part of the same picture.
    pub(super) fn merge(&mut self, other: &Self) {
        self.samples += other.samples;
        self.camera_rays += other.camera_rays;
        self.bounce_rays += other.bounce_rays;
        self.shadow_rays += other.shadow_rays;
        self.trace_lanes += other.trace_lanes;
        self.shade_lanes += other.shade_lanes;
        self.stages += other.stages;
        self.invalid_samples += other.invalid_samples;
        let in_picture_order = |&(x, y, sample): &(u32, u32, u32)| (y, x, sample);
        self.first_invalid =
            self.first_invalid.into_iter().chain(other.first_invalid).min_by_key(in_picture_order);
    }
}
