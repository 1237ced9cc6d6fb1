//! `packlight brdf MODEL -o PLOT`: what a reflection model looks like, and whether it is one.

mod check;
mod plot;
mod sheet;

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueHint, error::ErrorKind, value_parser};

use super::{
    console,
    failure::{Failure, warn},
    output::check_writable,
    source::definition,
    threads::ThreadsOption,
};
use crate::{
    load::{LoadOptions, load_material, read_material},
    lobe::{Certificate, Curves, PageOptions, Swatch, page},
    picture::write_whole,
    scene::Material,
};
use plot::Plot;

const WHICH: &str = "Which material";
const WHAT: &str = "What is made of it";

const AFTER_HELP: &str = "\
MODEL is a bsdf of the scene format on one line,
plugin:name=value,name=value. A colour is three numbers with
blanks between them; file names are relative to the working
directory.

Examples:
  packlight brdf roughconductor:material=Au -o gold.svg
  packlight brdf \"phong:diffuse_reflectance=0.3 0.1 0.1\" \\
      -o phong.png --light 60
  packlight brdf ward:alpha_u=0.1,alpha_v=0.4 --check
  packlight brdf --scene scenes/spheres.xml \\
      --material brushed-metal -o b.svg --csv b.csv
  packlight brdf sheet -o sheet.png";

/// Arguments of `brdf`.
#[derive(Clone, Debug, Args)]
#[command(after_help = AFTER_HELP, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,

    /// A model and its parameters, as in "roughconductor:alpha=0.3,material=Au"
    #[arg(value_name = "MODEL", required_unless_present = "scene", conflicts_with = "scene")]
    model: Option<String>,

    /// A scene to take the material from
    #[arg(long, value_name = "FILE", help_heading = WHICH, requires = "material", value_hint = ValueHint::FilePath)]
    scene: Option<PathBuf>,

    /// The id of a bsdf in it, or of a shape that has one
    #[arg(long, value_name = "ID", help_heading = WHICH, requires = "scene")]
    material: Option<String>,

    /// Value of `$NAME` in the scene; repeatable
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", help_heading = WHICH, value_parser = definition, requires = "scene")]
    defines: Vec<(String, String)>,

    /// Plots: slices, the lobe, the albedo and a lit sphere, as .svg or .png
    #[arg(short, long, value_name = "PLOT", help_heading = WHAT, value_parser = Plot::parse)]
    output: Option<Plot>,

    /// The numbers of the plots
    #[arg(long, value_name = "FILE", help_heading = WHAT, value_hint = ValueHint::FilePath)]
    csv: Option<PathBuf>,

    /// Prove that it is a reflection model: reciprocity, albedo, isotropy, density, sampling; exit code 1 if
    /// it is not
    #[arg(long, help_heading = WHAT)]
    check: bool,

    /// Degrees from the normal of the light that the lobe is drawn for
    #[arg(long, value_name = "DEGREES", help_heading = WHAT, default_value = "40", value_parser = degrees)]
    light: f32,

    /// Slices on a logarithmic scale of four decades
    #[arg(long, help_heading = WHAT)]
    log: bool,

    /// Samples a pixel of the rendered pictures
    #[arg(long, value_name = "N", help_heading = WHAT, default_value = "64", value_parser = value_parser!(u32).range(1..))]
    spp: u32,

    #[command(flatten)]
    threads: ThreadsOption,
}

#[derive(Clone, Debug, Subcommand)]
enum Command {
    /// Draw all models on lit spheres in one picture
    Sheet(sheet::Arguments),
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(Command::Sheet(arguments)) = &arguments.command {
        return sheet::run(arguments);
    }
    if arguments.output.is_none() && arguments.csv.is_none() && !arguments.check {
        let message = "nothing is asked for: name a plot by -o or a table by --csv, or --check the model";
        return Err(Failure::usage("brdf", ErrorKind::MissingRequiredArgument, message));
    }
    for path in
        [arguments.output.as_ref().map(|plot| &plot.path), arguments.csv.as_ref()].into_iter().flatten()
    {
        check_writable(path)?;
    }
    let swatch = Swatch::new(arguments.load()?)?;
    arguments.threads.pool()?.install(|| arguments.make(&swatch))
}

impl Arguments {
    fn load(&self) -> Result<Material, Failure> {
        let (material, warnings) = match (&self.model, &self.scene, &self.material) {
            (_, Some(scene), Some(id)) => load_material(
                scene,
                id,
                &LoadOptions { defines: self.defines.clone(), ..LoadOptions::default() },
            )?,
            (model, ..) => read_material(model.as_deref().unwrap_or_default())?,
        };
        warn(&warnings);
        Ok(material)
    }

    /// The material as a title.
    fn title(&self) -> String {
        match (&self.model, &self.scene, &self.material) {
            (_, Some(scene), Some(id)) => format!("{id} of {}", scene.display()),
            (model, ..) => model.clone().unwrap_or_default(),
        }
    }

    fn make(&self, swatch: &Swatch) -> Result<(), Failure> {
        if self.output.is_some() || self.csv.is_some() {
            self.draw(swatch)?;
        }
        if !self.check {
            return Ok(());
        }
        let certificate = Certificate::new(swatch)?;
        console::print(&check::table(&self.title(), &certificate))?;
        match certificate.passed() {
            true => Ok(()),
            false => Err(Failure::Sentence(format!("{} is not a reflection model", self.title()))),
        }
    }

    fn draw(&self, swatch: &Swatch) -> Result<(), Failure> {
        let curves = Curves::new(swatch);
        if let Some(path) = &self.csv {
            write_whole(path, curves.csv().as_bytes())
                .map_err(|error| Failure::Sentence(format!("{}: {error}", path.display())))?;
        }
        if let Some(plot) = &self.output {
            let options = PageOptions { light: self.light, logarithmic: self.log, samples: self.spp };
            plot.write(page(&self.title(), swatch, &curves, options)?)?;
        }
        Ok(())
    }
}

fn degrees(argument: &str) -> Result<f32, String> {
    match argument.parse::<f32>() {
        Ok(degrees) if (0.0..90.0).contains(&degrees) => Ok(degrees),
        _ => Err("expected an angle from the normal, from 0 to less than 90 degrees".into()),
    }
}
