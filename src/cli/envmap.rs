//! `packlight envmap PICTURE --sh -o OUT.json`: nine coefficients of a picture's light.

use std::{fmt, fs, path::PathBuf};

use clap::Args;
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use serde::Serialize;

use super::{
    console,
    failure::{Failure, warn_of},
};
use crate::{
    compile,
    light::{Envmap, ShCoefficients, sh_irradiance},
    load::sh::ShFile,
    picture::{Encoding, decode},
};

/// Directions in which nine coefficients are compared with the whole integral.
const NORMALS: u32 = 256;

const EXAMPLES: &str = "\
Examples:
  packlight envmap sky.exr --sh -o sky.json";

/// Arguments of `envmap`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// The environment: .exr, .hdr or any other picture, poles at the first and the last row
    #[arg(value_name = "PICTURE")]
    picture: PathBuf,

    /// Project it onto nine spherical harmonics, for the emitter `shlight`
    #[arg(long, required = true)]
    sh: bool,

    /// JSON to write
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let picture = decode(&arguments.picture, Encoding::Srgb)?;
    let mut samples = picture.channels.iter().flat_map(|channel| &channel.samples);
    let name = arguments.picture.display();
    if let Some(bad) = samples.clone().find(|sample| !sample.is_finite()) {
        return Err(Failure::Sentence(format!(
            "{name}: the picture has the value {bad}, which is no radiance"
        )));
    }
    if samples.any(|sample| *sample < 0.0) {
        warn_of(format!("{name}: the picture has negative values, which are taken as 0"));
    }
    let map = compile::envmap(&picture, 1.0, DMat3::IDENTITY);
    let projection = Projection::of(&map);
    let text = serde_json::to_string_pretty(&projection)
        .map_err(|error| Failure::Sentence(format!("the coefficients can't be written: {error}")))?;
    let name = arguments.output.display();
    fs::write(&arguments.output, text + "\n")
        .map_err(|error| Failure::Sentence(format!("{name}: can't be written: {error}")))?;
    console::print(&format!("{} -> {name}\n{projection}", arguments.picture.display()))
}

/// What is written: what `shlight` reads, and how good it is.
#[derive(Clone, Debug, Serialize)]
struct Projection {
    basis: &'static str,
    #[serde(flatten)]
    file: ShFile,
    /// Directions in which irradiance was compared.
    normals: u32,
    /// Over them and the whole sphere, W/m².
    mean_irradiance: [f64; 3],
    /// Root mean square and greatest |E₉ − E|, in units of the mean E.
    rms_error: [f64; 3],
    worst_error: [f64; 3],
}

impl Projection {
    fn of(map: &Envmap) -> Self {
        let coefficients = (0..map.cell_rows())
            .into_par_iter()
            .map(|row| map.project_row(row))
            .collect::<Vec<ShCoefficients>>()
            .into_iter()
            .fold([DVec3::ZERO; 9], |sum, row| std::array::from_fn(|i| sum[i] + row[i]));
        let normals: Vec<DVec3> = (0..NORMALS).map(spread).collect();
        let rows: Vec<Vec<DVec3>> =
            (0..map.cell_rows()).into_par_iter().map(|row| map.irradiance_row(row, &normals)).collect();
        let whole: Vec<DVec3> = (0..normals.len()).map(|n| rows.iter().map(|row| row[n]).sum()).collect();

        let mean = whole.iter().sum::<DVec3>() / f64::from(NORMALS);
        let unit = DVec3::from(mean.to_array().map(|e| if e > 0.0 { e } else { 1.0 }));
        let errors = normals.iter().zip(&whole).map(|(n, e)| (sh_irradiance(&coefficients, *n) - e) / unit);
        let errors: Vec<DVec3> = errors.collect();
        let squares = errors.iter().map(|e| e * e).sum::<DVec3>() / f64::from(NORMALS);
        Self {
            basis: "real, orthonormal, (0,0) (1,-1) (1,0) (1,1) (2,-2) (2,-1) (2,0) (2,1) (2,2); \
                    Y(1,-1) ~ y, Y(1,0) ~ z, Y(1,1) ~ x; the picture's poles are +y and -y",
            file: ShFile { coefficients: coefficients.map(|c| c.as_vec3().to_array()) },
            normals: NORMALS,
            mean_irradiance: mean.to_array(),
            rms_error: squares.to_array().map(f64::sqrt),
            worst_error: errors.iter().fold(DVec3::ZERO, |worst, e| worst.max(e.abs())).to_array(),
        }
    }
}

/// Directions spread evenly, along a spiral that turns by the golden angle.
fn spread(i: u32) -> DVec3 {
    const GOLDEN_TURN: f64 = 0.618_033_988_749_894_9;
    let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(NORMALS);
    let (sin, cos) = (std::f64::consts::TAU * GOLDEN_TURN * f64::from(i)).sin_cos();
    let r = (1.0 - y * y).sqrt();
    DVec3::new(r * cos, y, r * sin)
}

impl fmt::Display for Projection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |[r, g, b]: [f64; 3]| format!("{:.2} {:.2} {:.2} %", 100.0 * r, 100.0 * g, 100.0 * b);
        let [r, g, b] = self.mean_irradiance;
        writeln!(f, "  irradiance  {r:.4} {g:.4} {b:.4} W/m², mean over {} normals", self.normals)?;
        writeln!(f, "  error       {} root mean square, of the mean", percent(self.rms_error))?;
        writeln!(f, "              {} at worst, against the whole integral", percent(self.worst_error))
    }
}
