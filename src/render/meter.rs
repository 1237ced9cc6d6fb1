//! A light meter: irradiance at one point, or over a surface, with its standard error.
//!
//! Samples of one pixel are stratified, so their spread says nothing of the error of their mean. The
//! meter therefore measures with many pixels, each with random numbers of its own and all at the same
//! place: what they read is independent, and the error of the mean is that of any mean \[PJH23\] (section
//! 2.1).

use glam::DVec3;

use super::{Receiver, Settings, irradiance::Irradiance, paths, render_with, statistics::Statistics};
use crate::{compile::Scene, film::Filter, scene};

/// Independent readings: a side of a square of pixels.
const SIDE: u32 = 16;

/// What a meter reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// E in W/m², three bands.
    pub irradiance: DVec3,
    /// Of that mean: one standard deviation, in W/m².
    pub standard_error: DVec3,
    /// Samples in all.
    pub samples: u64,
    /// Of them, with a value that is not finite, left out.
    pub invalid_samples: u64,
}

/// Measures on the current rayon pool with at least `samples`. Paths are as long as the scene's integrator
/// allows; a point that receives counts as a vertex, a sensor does not. The scene's film and sampler are not
/// used but for the seed.
pub fn measure(mut scene: Scene, receiver: Receiver, samples: u64, settings: &Settings) -> Reading {
    scene.film = scene::Film::new(SIDE, SIDE);
    scene.filter = Filter::BOX;
    scene.aovs.clear();
    let each = samples.div_ceil(u64::from(SIDE * SIDE)).clamp(1, u32::MAX.into());
    scene.sampler.sample_count = each as u32;
    let integrator = integrator(&scene.integrator, receiver);
    let rendered = render_with(&scene, &integrator, settings, &|_| {});
    let Statistics { samples, invalid_samples, .. } = rendered.statistics;
    let bands = ["R", "G", "B"].map(|name| statistics(rendered.picture.plane(name).unwrap_or_default()));
    Reading {
        irradiance: DVec3::from(bands.map(|(mean, _)| mean)),
        standard_error: DVec3::from(bands.map(|(_, error)| error)),
        samples,
        invalid_samples,
    }
}

/// What a receiver receives by paths as long as those of another integrator.
pub(super) fn integrator(as_long: &scene::Integrator, receiver: Receiver) -> Irradiance {
    let (max_depth, rr_depth) = match *as_long {
        scene::Integrator::Path { max_depth, rr_depth, .. }
        | scene::Integrator::Irradiance { max_depth, rr_depth } => (max_depth, rr_depth),
        scene::Integrator::Direct { .. } => (Some(2), 5),
        scene::Integrator::Whitted { max_depth } => (Some(max_depth), 5),
        scene::Integrator::AmbientOcclusion { .. } | scene::Integrator::Aov { .. } => (None, 5),
    };
    // Where it stands in a camera's place, what it sees is the first vertex.
    let before = u32::from(receiver == Receiver::Sensor);
    let longer = |depth: u32| depth.saturating_add(before);
    let paths = paths(max_depth.map(longer), longer(rr_depth), false);
    Irradiance { paths, receiver: Some(receiver) }
}

/// The mean of independent readings, and its standard error.
fn statistics(readings: &[f32]) -> (f64, f64) {
    let count = readings.len() as f64;
    let mean = readings.iter().map(|&x| f64::from(x)).sum::<f64>() / count;
    let squares: f64 = readings.iter().map(|&x| (f64::from(x) - mean) * (f64::from(x) - mean)).sum();
    (mean, (squares / (count - 1.0) / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_of_a_mean() {
        // Variance 5/3 of 4 readings.
        let (mean, error) = statistics(&[1.0, 2.0, 3.0, 4.0]);
        assert_eq!(mean, 2.5);
        assert!((error - (5.0f64 / 12.0).sqrt()).abs() < 1e-12);
    }
}
