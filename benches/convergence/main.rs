//! How error falls with the number of samples: `cargo bench --bench convergence`.
//!
//! Each picture is rendered small with 1, 2, 4, … samples a pixel and compared with one of many samples
//! and another seed. The slope of log error over log N is printed, a picture of it is drawn, and the
//! command fails where error falls slower than N^-½.

mod plot;

use std::{path::Path, process::ExitCode};

use packlight::{
    compile::{Scene, compile},
    load::{LoadOptions, load},
    picture::Picture,
    render::{Settings, render},
    scene::{Film, Integrator},
};

/// Pictures, small: error is a mean over pixels, so few are enough.
const FILM: Film = Film::new(48, 36);
/// Samples a pixel: powers of two, where the sequence is stratified.
const COUNTS: [u32; 9] = [1, 2, 4, 8, 16, 32, 64, 128, 256];
/// Of what the others are compared with.
const REFERENCE: u32 = 8192;
const REFERENCE_SEED: u32 = 1_000_003;
/// Error may fall by this exponent at least: −½ but for the noise of the fit.
const SLOWEST: f64 = -0.48;

/// Relative error against N.
struct Curve {
    name: &'static str,
    points: Vec<(f64, f64)>,
}

impl Curve {
    /// The exponent of N, by least squares in logarithms.
    fn slope(&self) -> f64 {
        let count = self.points.len() as f64;
        let logs: Vec<(f64, f64)> = self.points.iter().map(|&(n, error)| (n.ln(), error.ln())).collect();
        let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let product: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        product / logs.iter().map(|p| (p.0 - x) * (p.0 - x)).sum::<f64>()
    }
}

fn cases() -> [(&'static str, &'static str, Option<Integrator>); 4] {
    [
        ("ambient occlusion", "cornell", Some(Integrator::AmbientOcclusion { distance: f32::INFINITY })),
        ("direct light", "cornell", Some(Integrator::Direct { hide_emitters: false })),
        ("paths in a box", "cornell", None),
        ("light from a sky", "sky", Some(Integrator::Direct { hide_emitters: false })),
    ]
}

fn curve(name: &'static str, file: &str, integrator: Option<Integrator>) -> Result<Curve, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/{file}.xml"));
    let mut description =
        load(&path, &LoadOptions::default()).map_err(|error| error.to_string())?.description;
    description.sensor.film = FILM;
    description.integrator = integrator.unwrap_or(description.integrator);
    let mut scene = compile(&description).map_err(|error| error.to_string())?;
    let reference = picture(&mut scene, REFERENCE, REFERENCE_SEED);
    let points = COUNTS.map(|count| {
        let error = relative_error(&picture(&mut scene, count, 0), &reference);
        (f64::from(count), error)
    });
    Ok(Curve { name, points: points.into() })
}

fn picture(scene: &mut Scene, count: u32, seed: u32) -> Picture {
    (scene.sampler.sample_count, scene.sampler.seed) = (count, seed);
    render(scene, &Settings::default(), &|_| {}).picture
}

/// The root of the mean squared difference, over the mean.
fn relative_error(one: &Picture, reference: &Picture) -> f64 {
    let samples = |picture: &Picture| -> Vec<f64> {
        picture.channels.iter().flat_map(|c| &c.samples).map(|&x| f64::from(x)).collect()
    };
    let (one, reference) = (samples(one), samples(reference));
    let squares: f64 = one.iter().zip(&reference).map(|(a, b)| (a - b) * (a - b)).sum();
    let count = reference.len() as f64;
    (squares / count).sqrt() / (reference.iter().sum::<f64>() / count)
}

fn main() -> ExitCode {
    let curves: Result<Vec<Curve>, String> =
        cases().into_iter().map(|(name, file, integrator)| curve(name, file, integrator)).collect();
    let drawn = curves.and_then(|curves| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/convergence/convergence.svg");
        plot::draw(&curves, &path)?;
        Ok(curves)
    });
    let curves = match drawn {
        Ok(curves) => curves,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::FAILURE;
        }
    };
    let mut slow = false;
    println!("{:<18} {:>9} {:>9} {:>9}", "relative error", "N = 1", "N = 256", "exponent");
    for curve in &curves {
        let (first, last) = (curve.points[0].1, curve.points[curve.points.len() - 1].1);
        println!("{:<18} {first:>9.4} {last:>9.4} {:>9.3}", curve.name, curve.slope());
        slow |= curve.slope() > SLOWEST;
    }
    if slow { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}
