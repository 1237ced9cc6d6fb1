//! `packlight compare REFERENCE TEST`: how two pictures differ.

use std::{fmt, path::PathBuf};

use clap::Args;
use serde::Serialize;

use super::{
    console,
    failure::Failure,
    output::Output,
    quantity::{counted, grouped, significant},
};
use crate::{
    compare::{difference, false_colours, flip_hdr, flip_ldr},
    picture::{Encoding, Picture, Preview, decode, save},
};

const EXAMPLES: &str = "\
Examples:
  packlight compare reference.exr test.exr -o difference.png
  packlight compare a.exr b.exr --max-flip 0.05 --json";

/// Arguments of `compare`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// What is right
    #[arg(value_name = "REFERENCE")]
    reference: PathBuf,

    /// What is asked about
    #[arg(value_name = "TEST")]
    test: PathBuf,

    /// Picture of the differences that are seen (FLIP), from black over red to white: .png
    #[arg(short, long, value_name = "OUT", value_parser = Output::parse)]
    output: Option<Output>,

    /// Fail if the mean FLIP error is above this
    #[arg(long, value_name = "ERROR")]
    max_flip: Option<f64>,

    /// Fail if the relative mean squared error is above this
    #[arg(long, value_name = "ERROR")]
    max_relmse: Option<f64>,

    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// Field names are the keys of `--json`.
#[derive(Clone, Debug, Serialize)]
struct Comparison {
    reference: String,
    test: String,
    /// Where the difference was drawn.
    output: Option<String>,
    width: u32,
    height: u32,
    /// Test in reference; `null` where both are black.
    mean_ratio: [Option<f64>; 3],
    rel_mse: f64,
    rmse: f64,
    largest: f64,
    flip: f64,
    /// `hdr`: over exposures; `ldr`: as on a screen.
    flip_kind: &'static str,
    different_numbers: u64,
    pixels_not_finite: u64,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { reference, test, output, .. } = arguments;
    output.as_ref().map_or(Ok(()), Output::check)?;
    let read = |path: &PathBuf| Ok::<Picture, Failure>(decode(path, Encoding::Srgb)?);
    let pictures = (read(reference)?, read(test)?);
    let refused = |error: crate::compare::CompareError| {
        Failure::Sentence(format!("{} and {}: {error}", reference.display(), test.display()))
    };
    let numbers = difference(&pictures.0, &pictures.1).map_err(refused)?;
    // A file of bytes ends at white; light does not.
    let is_light = |path: &PathBuf| {
        path.extension()
            .is_some_and(|kind| kind.eq_ignore_ascii_case("exr") || kind.eq_ignore_ascii_case("hdr"))
    };
    let (flip_kind, flip) = if is_light(reference) || is_light(test) {
        ("hdr", flip_hdr(&pictures.0, &pictures.1))
    } else {
        ("ldr", flip_ldr(&pictures.0, &pictures.1))
    };
    let flip = flip.map_err(refused)?;
    if let Some(output) = output {
        save(&false_colours(pictures.0.width, &flip), &output.path, Preview::default())?;
    }
    let mean = flip.iter().map(|&error| f64::from(error)).sum::<f64>() / flip.len() as f64;
    let comparison = Comparison {
        reference: reference.display().to_string(),
        test: test.display().to_string(),
        output: output.as_ref().map(|output| output.path.display().to_string()),
        width: pictures.0.width,
        height: pictures.0.height,
        mean_ratio: numbers.mean_ratio.map(|ratio| Some(ratio).filter(|ratio| ratio.is_finite())),
        rel_mse: numbers.rel_mse,
        rmse: numbers.rmse,
        largest: numbers.largest,
        flip: mean,
        flip_kind,
        different_numbers: numbers.different,
        pixels_not_finite: numbers.not_finite,
    };
    if arguments.json {
        console::print_json(&comparison)?;
    } else {
        console::print(&comparison.to_string())?;
    }
    let limits = [("FLIP", mean, arguments.max_flip), ("relMSE", numbers.rel_mse, arguments.max_relmse)];
    for (name, value, limit) in limits {
        if let Some(limit) = limit.filter(|limit| value.is_nan() || value > *limit) {
            let test = test.display();
            return Err(Failure::Sentence(format!("{test}: {name} is {value:.6}, above {limit}")));
        }
    }
    Ok(())
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} in place of {}, {} x {}", self.test, self.reference, self.width, self.height)?;
        writeln!(f, "{}", self.output.as_ref().map_or(String::new(), |output| format!(" -> {output}")))?;
        if self.different_numbers == 0 {
            return writeln!(f, "  the same to the bit");
        }
        let ratio = |ratio: Option<f64>| ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.6}"));
        let [r, g, b] = self.mean_ratio.map(ratio);
        writeln!(f, "  mean ratio  {r} {g} {b}")?;
        writeln!(f, "  relMSE      {}", significant(self.rel_mse))?;
        writeln!(f, "  RMSE        {}, at most {}", significant(self.rmse), significant(self.largest))?;
        writeln!(f, "  FLIP        {:.6} ({})", self.flip, self.flip_kind)?;
        writeln!(f, "  different   {} numbers", grouped(self.different_numbers))?;
        if self.pixels_not_finite > 0 {
            let pixels = counted(self.pixels_not_finite, "pixel");
            writeln!(f, "  left out    {pixels} that are not finite")?;
        }
        Ok(())
    }
}
