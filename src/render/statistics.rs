//! What a render took, counted while it ran.

use std::{
    ops::AddAssign,
    time::{Duration, Instant},
};

/// Lanes that did work, of the lanes that ran.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LaneUse {
    /// Lanes with work.
    pub active: u64,
    /// Lanes in all: eight or sixteen a group.
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

    /// A group with this many lanes at work: in eights.
    pub(super) fn add(&mut self, active: u32) {
        self.active += u64::from(active);
        self.total += u64::from(active.next_multiple_of(crate::simd::LANES as u32));
    }
}

impl AddAssign for LaneUse {
    fn add_assign(&mut self, other: Self) {
        self.active += other.active;
        self.total += other.total;
    }
}

/// What a thread that renders packets does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    Trace,
    Sort,
    Shade,
    Add,
}

/// Where the time of a render by packets went: time on a clock, summed over threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Profile {
    /// Rays through the tree, nearest hits and shadows.
    pub trace: Duration,
    /// Which material each hit has, and sorting by it.
    pub sort: Duration,
    /// Camera rays, materials, lights and random numbers; reading paths and writing them.
    pub shade: Duration,
    /// What vertices have brought into the film, and paths that end taken out.
    pub add: Duration,
}

impl Profile {
    /// The stages' shares of their sum, in the order of the fields; 0 if nothing ran.
    pub fn shares(&self) -> [f64; 4] {
        let stages = [self.trace, self.sort, self.shade, self.add].map(|stage| stage.as_secs_f64());
        let total: f64 = stages.iter().sum();
        stages.map(|stage| if total > 0.0 { stage / total } else { 0.0 })
    }
}

impl AddAssign for Profile {
    fn add_assign(&mut self, other: Self) {
        self.trace += other.trace;
        self.sort += other.sort;
        self.shade += other.shade;
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
    /// Stages of the packet pipeline.
    pub profile: Profile,
    /// Samples with a NaN or infinite value, kept out of the film.
    pub invalid_samples: u64,
    /// Pixel (x, y) and sample of the first of them, in picture order.
    pub first_invalid: Option<(u32, u32, u32)>,
    /// Wall time of rendering, without loading and building.
    pub time: Duration,
}

impl Statistics {
    /// Counts the time since `start` to a stage; now.
    pub(super) fn spend(&mut self, stage: Stage, start: Instant) -> Instant {
        let now = Instant::now();
        let spent = match stage {
            Stage::Trace => &mut self.profile.trace,
            Stage::Sort => &mut self.profile.sort,
            Stage::Shade => &mut self.profile.shade,
            Stage::Add => &mut self.profile.add,
        };
        *spent += now - start;
        now
    }

    /// Adds the counts of another part of the same picture.
    pub(super) fn merge(&mut self, other: &Self) {
        self.samples += other.samples;
        self.camera_rays += other.camera_rays;
        self.bounce_rays += other.bounce_rays;
        self.shadow_rays += other.shadow_rays;
        self.trace_lanes += other.trace_lanes;
        self.shade_lanes += other.shade_lanes;
        self.profile += other.profile;
        self.invalid_samples += other.invalid_samples;
        let in_picture_order = |&(x, y, sample): &(u32, u32, u32)| (y, x, sample);
        self.first_invalid =
            self.first_invalid.into_iter().chain(other.first_invalid).min_by_key(in_picture_order);
    }
}
