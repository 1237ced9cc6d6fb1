//! `packlight meter SCENE [--at X,Y,Z --normal X,Y,Z]`: irradiance at a point, or over the surface that the
//! scene's own meter stands on.

use std::fmt;

use clap::{Args, value_parser};
use glam::{DVec3, Vec3};
use serde::Serialize;

use super::{
    MACHINE, console,
    failure::{Failure, warn_of},
    memory::MemoryOption,
    quality::QualityOption,
    quantity::grouped,
    source::Source,
    threads::ThreadsOption,
};
use crate::{
    compile::compile_owned,
    load::Loaded,
    render::{Conditions, Receiver, Settings, meter},
};

const EXAMPLES: &str = "\
Examples:
  packlight meter cornell.xml --at 0,0,0 --normal 0,1,0
  packlight meter room.xml --samples 1000000 --json";

/// Arguments of `meter`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// Where the meter is, if not where the scene's `irradiancemeter` is
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = vector, requires = "normal")]
    at: Option<Vec3>,

    /// Where it looks; of any length
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, value_parser = direction, requires = "at")]
    normal: Option<Vec3>,

    /// Samples, at least
    #[arg(long, value_name = "N", default_value_t = 65_536, value_parser = value_parser!(u64).range(1..))]
    samples: u64,

    /// Seed of every random decision
    #[arg(long, value_name = "N")]
    seed: Option<u32>,

    #[command(flatten, next_help_heading = MACHINE)]
    threads: ThreadsOption,

    #[command(flatten, next_help_heading = MACHINE)]
    quality: QualityOption,

    #[command(flatten, next_help_heading = MACHINE)]
    memory: MemoryOption,

    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let reading = arguments.threads.pool()?.install(|| measure(arguments))?;
    if reading.invalid_samples > 0 {
        let count = grouped(reading.invalid_samples);
        warn_of(format!("{count} samples were not finite numbers and were left out"));
    }
    if arguments.json { console::print_json(&reading) } else { console::print(&reading.to_string()) }
}

fn measure(arguments: &Arguments) -> Result<Reading, Failure> {
    let (Loaded { mut description, .. }, _) = arguments.source.load()?;
    let sampler = &mut description.sensor.sampler;
    sampler.seed = arguments.seed.unwrap_or(sampler.seed);
    let quality = arguments.quality.quality();
    let threads = rayon::current_num_threads();
    arguments.memory.check(&description, &Conditions { quality, threads, keeps_sums: false })?;
    let scene = compile_owned(description, quality)?;
    let point = arguments.at.zip(arguments.normal);
    let receiver = match point {
        Some((position, normal)) => Receiver::Point { position, normal },
        None if scene.has_meter() => Receiver::Sensor,
        None => {
            return Err(Failure::Sentence(
                "the scene has no irradiancemeter on a shape: say where to measure by --at and --normal"
                    .into(),
            ));
        }
    };
    let reading = meter::measure(scene, receiver, arguments.samples, &Settings::default());
    Ok(Reading {
        scene: arguments.source.path.display().to_string(),
        at: point.map(|(at, _)| at.to_array()),
        normal: point.map(|(_, normal)| normal.to_array()),
        irradiance_w_m2: reading.irradiance.to_array(),
        standard_error_w_m2: reading.standard_error.to_array(),
        samples: reading.samples,
        invalid_samples: reading.invalid_samples,
    })
}

/// Field names are the keys of `--json`; units are in the names.
#[derive(Clone, Debug, Serialize)]
struct Reading {
    scene: String,
    /// `None` is the surface of the scene's own meter.
    at: Option<[f32; 3]>,
    normal: Option<[f32; 3]>,
    irradiance_w_m2: [f64; 3],
    standard_error_w_m2: [f64; 3],
    samples: u64,
    invalid_samples: u64,
}

impl fmt::Display for Reading {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let vector = |[x, y, z]: [f32; 3]| format!("({x}, {y}, {z})");
        match self.at.zip(self.normal) {
            Some((at, normal)) => {
                writeln!(f, "{} at {}, towards {}", self.scene, vector(at), vector(normal))?;
            }
            None => writeln!(f, "{}, mean over the surface of its irradiancemeter", self.scene)?,
        }
        for (band, i) in ["red", "green", "blue"].into_iter().zip(0..) {
            let (mean, error) = (self.irradiance_w_m2[i], self.standard_error_w_m2[i]);
            let places = places(mean, error);
            writeln!(f, "  {band:<6} {mean:.places$} ± {error:.places$} W/m²")?;
        }
        writeln!(f, "  {} samples; ± is one standard error", grouped(self.samples))
    }
}

/// Digits behind the point, so that of an error two count, and of a mean without one six.
fn places(mean: f64, error: f64) -> usize {
    let (number, digits) = if error > 0.0 { (error, 2.0) } else { (mean.abs(), 6.0) };
    if number > 0.0 { (digits - 1.0 - number.log10().floor()).clamp(0.0, 12.0) as usize } else { 0 }
}

fn vector(argument: &str) -> Result<Vec3, String> {
    let numbers: Vec<f64> = argument.split(',').map_while(|number| number.trim().parse().ok()).collect();
    match numbers[..] {
        [x, y, z] if argument.split(',').count() == 3 && DVec3::new(x, y, z).as_vec3().is_finite() => {
            Ok(DVec3::new(x, y, z).as_vec3())
        }
        _ => Err("expected three numbers, as in 0,1.5,-2".into()),
    }
}

fn direction(argument: &str) -> Result<Vec3, String> {
    vector(argument)?.try_normalize().ok_or_else(|| "a direction has a length".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_count() {
        for (mean, error, shown) in [
            (1.570_926, 0.000_14, 5),
            (0.031_105, 3.1e-8, 9),
            (812.3, 14.0, 0),
            (25.0, 0.0, 4),
            (0.0, 0.0, 0),
            (1.0, 1e-30, 12),
        ] {
            assert_eq!(places(mean, error), shown, "{mean} ± {error}");
        }
    }

    #[test]
    fn three_numbers_are_a_place() {
        assert_eq!(vector("0, 1.5,-2"), Ok(Vec3::new(0.0, 1.5, -2.0)));
        for wrong in ["", "1,2", "1,2,3,4", "1,x,3", "1,2,inf", "1,2,1e300"] {
            assert!(vector(wrong).is_err(), "{wrong}");
        }
        assert_eq!(direction("0,0,-7"), Ok(Vec3::NEG_Z));
        assert!(direction("0,0,0").is_err());
    }
}
