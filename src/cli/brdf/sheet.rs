//! `packlight brdf sheet -o OUT`: all models on one sheet.

use std::sync::Arc;

use clap::{Args, value_parser};
use glam::Vec3;

use super::plot::Plot;
use crate::{
    cli::{failure::Failure, output::check_writable, threads::ThreadsOption},
    load::read_material,
    lobe::{Cell, Swatch, sheet},
    scene::{Material, MerlTable},
};

const EXAMPLES: &str = "\
Examples:
  packlight brdf sheet -o sheet.png --spp 256";

/// Arguments of `brdf sheet`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// The sheet, as .png or .svg
    #[arg(short, long, value_name = "OUT", value_parser = Plot::parse)]
    output: Plot,

    /// Samples a pixel
    #[arg(long, value_name = "N", default_value = "64", value_parser = value_parser!(u32).range(1..))]
    spp: u32,

    #[command(flatten)]
    threads: ThreadsOption,
}

/// What is under each sphere, and what is on it.
const MODELS: [(&str, &str); 20] = [
    ("", "diffuse:reflectance=0.64 0.2 0.12"),
    ("three bands", "toon:reflectance=0.8 0.45 0.1,bands=3"),
    ("exponent 60", "phong:diffuse_reflectance=0.5 0.3 0.05,specular_reflectance=0.3,exponent=60"),
    (
        "alpha 0.1 across 0.3",
        "ward:diffuse_reflectance=0.1 0.08 0.2,specular_reflectance=0.5 0.45 0.6,alpha_u=0.1,alpha_v=0.3",
    ),
    ("a smooth coat", "plastic:diffuse_reflectance=0.05 0.22 0.5"),
    ("alpha 0.1", "roughplastic:diffuse_reflectance=0.1 0.4 0.15,alpha=0.1"),
    ("alpha 0.4", "roughplastic:diffuse_reflectance=0.1 0.4 0.15,alpha=0.4"),
    ("roughness 0.4", "principled:base_color=0.75 0.55 0.1,roughness=0.4"),
    ("clearcoat", "principled:base_color=0.5 0.03 0.04,roughness=0.5,clearcoat=1.0,clearcoat_gloss=0.9"),
    (
        "sheen, flatness",
        "principled:base_color=0.25 0.08 0.3,roughness=0.9,sheen=1.0,sheen_tint=0.5,flatness=0.5",
    ),
    ("gold", "conductor:material=Au"),
    ("copper, Beckmann, alpha 0.1", "roughconductor:material=Cu,alpha=0.1"),
    ("copper, GGX, alpha 0.3", "roughconductor:material=Cu,alpha=0.3,distribution=ggx"),
    ("aluminium, 0.08 across 0.35", "roughconductor:material=Al,alpha_u=0.08,alpha_v=0.35"),
    ("metallic, anisotropic", "principled:base_color=0.9 0.6 0.5,metallic=1.0,roughness=0.4,anisotropic=0.8"),
    ("index 1.5", "dielectric:int_ior=1.5,ext_ior=1.0"),
    ("alpha 0.1", "roughdielectric:int_ior=1.5,ext_ior=1.0,alpha=0.1"),
    ("GGX, alpha 0.3", "roughdielectric:int_ior=1.5,ext_ior=1.0,alpha=0.3,distribution=ggx"),
    ("spec_trans 1", "principled:base_color=0.7 0.9 0.8,roughness=0.15,spec_trans=1.0,eta=1.5"),
    ("the table of the copper above", TABLE),
];

/// The cell that is made, not read.
const TABLE: &str = "merl";
/// What is measured for it.
const TABULATED: &str = "roughconductor:material=Cu,alpha=0.3,distribution=ggx";

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    check_writable(&arguments.output.path)?;
    let cells =
        MODELS.into_iter().map(|(caption, line)| cell(caption, line)).collect::<Result<Vec<_>, _>>()?;
    let drawing = arguments
        .threads
        .pool()?
        .install(|| sheet("packlight's reflection models", &cells, arguments.spp))?;
    arguments.output.write(drawing)
}

fn cell(caption: &str, line: &str) -> Result<Cell, Failure> {
    let name = line.split(':').next().unwrap_or(line).to_owned();
    let material = if line == TABLE { tabulated()? } else { read_material(line)?.0 };
    Ok(Cell { name, caption: caption.to_owned(), material })
}

/// A material as a measurement would tell it.
fn tabulated() -> Result<Material, Failure> {
    let swatch = Swatch::new(read_material(TABULATED)?.0)?;
    let table = MerlTable::tabulate(|wo, wi| {
        let (f_cos, _) = swatch.seen_from::<f32>(wo.into()).eval(wi.into());
        Vec3::from(f_cos) / wi.z
    });
    Ok(Material::Measured { table: Arc::new(table) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_of_the_sheet_can_be_made() {
        for (caption, line) in MODELS.into_iter().filter(|(_, line)| *line != TABLE) {
            assert!(cell(caption, line).is_ok(), "{line}");
        }
    }
}
