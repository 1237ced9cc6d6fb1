//! `packlight render SCENE -o OUT`.

use std::time::Instant;

use clap::{Args, CommandFactory, ValueEnum, error::ErrorKind, value_parser};

use super::{
    Cli, console,
    failure::{Failure, warn_of},
    memory,
    output::Output,
    overrides::{IntegratorName, MAX_SIDE, Overrides},
    progress::Bar,
    quality::QualityOption,
    replay::{self, Replay},
    report::{Report, Sources},
    source::Source,
    threads,
};
use crate::{
    compile::compile_with,
    picture::{Format, Preview, save},
    render::{self, Settings},
    scene::Film,
};

const PICTURE: &str = "Picture";
const MACHINE: &str = "Machine (never changes a bit of the picture)";

/// Arguments of `render`.
#[derive(Clone, Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// Picture to write: .exr (linear, all channels), .hdr (linear) or .png (8-bit sRGB)
    #[arg(short, long, value_name = "OUT", value_parser = Output::parse, required_unless_present = "pixel")]
    output: Option<Output>,

    /// How light is transported, in place of what the scene says
    #[arg(long, value_name = "NAME", help_heading = PICTURE)]
    integrator: Option<IntegratorName>,

    /// Samples per pixel
    #[arg(long, value_name = "N", help_heading = PICTURE, value_parser = value_parser!(u32).range(1..))]
    spp: Option<u32>,

    /// Columns; without --height the aspect ratio is kept
    #[arg(long, value_name = "W", help_heading = PICTURE, value_parser = side())]
    width: Option<u32>,

    /// Rows; without --width the aspect ratio is kept
    #[arg(long, value_name = "H", help_heading = PICTURE, value_parser = side())]
    height: Option<u32>,

    /// Seed of every random decision
    #[arg(long, value_name = "N", help_heading = PICTURE)]
    seed: Option<u32>,

    /// Stops by which a .png is brightened
    #[arg(long, value_name = "STOPS", help_heading = PICTURE, allow_negative_numbers = true, value_parser = stops)]
    exposure: Option<f32>,

    /// In place of a picture, the numbers of this pixel's samples
    #[arg(long, value_name = "X,Y", conflicts_with = "output", value_parser = replay::pixel)]
    pixel: Option<[u32; 2]>,

    /// Only this sample of the pixel, from 0
    #[arg(long, value_name = "N", requires = "pixel")]
    sample: Option<u32>,

    /// Threads; one a core if not given
    #[arg(long, value_name = "N", help_heading = MACHINE, value_parser = threads::count())]
    threads: Option<usize>,

    /// Eight rays at a time, or one at a time as a reference
    #[arg(long, value_name = "NAME", help_heading = MACHINE, default_value = "packet")]
    backend: Backend,

    #[command(flatten, next_help_heading = MACHINE)]
    quality: QualityOption,

    /// Shade hits as they come, not sorted by material: for measurement
    #[arg(long, help_heading = MACHINE)]
    no_sort: bool,

    /// No progress bar and no summary
    #[arg(short, long)]
    quiet: bool,

    /// The summary as one JSON object on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Backend {
    Packet,
    Scalar,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pool = threads::pool(arguments.threads)?;
    if let Some(pixel) = arguments.pixel {
        let replay = pool.install(|| numbers(arguments, pixel))?;
        return if arguments.json {
            console::print_json(&replay)
        } else {
            console::print(&replay.to_string())
        };
    }
    let Some(output) = &arguments.output else { return Ok(()) };
    output.check()?;
    let report = pool.install(|| picture(arguments, output))?;

    if let Some(warning) = report.warning() {
        warn_of(warning);
    }
    if arguments.json {
        console::print_json(&report)
    } else if arguments.quiet {
        Ok(())
    } else {
        console::print(&report.to_string())
    }
}

/// Load, compile, and one pixel by itself.
fn numbers(arguments: &Arguments, pixel: [u32; 2]) -> Result<Replay, Failure> {
    let (mut description, _) = arguments.source.load()?;
    arguments.overrides().apply(&mut description);
    let Film { width, height, .. } = description.sensor.film;
    if pixel[0] >= width || pixel[1] >= height {
        let message = format!("--pixel is outside of the picture, which has {width} x {height} pixels");
        return Err(Cli::command().error(ErrorKind::ValueValidation, message).into());
    }
    let scene = compile_with(&description, arguments.quality.quality())?;
    let name = arguments.source.path.display().to_string();
    Ok(Replay::new(&scene, name, &arguments.settings(), pixel, arguments.sample))
}

/// Load, compile, render, save.
fn picture(arguments: &Arguments, output: &Output) -> Result<Report, Failure> {
    let (mut description, load_time) = arguments.source.load()?;
    arguments.overrides().apply(&mut description);
    can_hold(output.format, IntegratorName::from(&description.integrator))?;
    if arguments.exposure.is_some() && output.format != Format::Png {
        warn_of("--exposure only changes a .png; the numbers of this file stay linear");
    }

    let scene = compile_with(&description, arguments.quality.quality())?;
    let settings = arguments.settings();
    let bar = Bar::new(arguments.quiet);
    let start = Instant::now();
    let mut rendered = render::render(&scene, &settings, &|progress| bar.show(progress));
    bar.finish();
    if rendered.statistics.time.is_zero() {
        rendered.statistics.time = start.elapsed();
    }
    let preview = Preview { exposure: arguments.exposure.unwrap_or(0.0), ..Preview::default() };
    save(&rendered.picture, &output.path, preview)?;

    Ok(Report::from(Sources {
        scene: arguments.source.path.display().to_string(),
        output: output.path.display().to_string(),
        options: arguments.options(),
        description: &description,
        settings,
        summary: scene.summary(),
        statistics: rendered.statistics,
        load_time,
        threads: rayon::current_num_threads(),
        peak_memory: memory::peak(),
    }))
}

/// Named channels fit nowhere but into an EXR.
fn can_hold(format: Format, integrator: IntegratorName) -> Result<(), Failure> {
    if integrator != IntegratorName::Aov || format == Format::Exr {
        return Ok(());
    }
    let message = "the aov integrator writes named channels, which only an .exr can hold";
    Err(Cli::command().error(ErrorKind::ArgumentConflict, message).into())
}

impl Arguments {
    fn overrides(&self) -> Overrides {
        Overrides {
            integrator: self.integrator,
            spp: self.spp,
            width: self.width,
            height: self.height,
            seed: self.seed,
        }
    }

    fn settings(&self) -> Settings {
        let backend = match self.backend {
            Backend::Packet => render::Backend::Packet,
            Backend::Scalar => render::Backend::Scalar,
        };
        Settings { backend, sort: !self.no_sort }
    }

    /// What of the command line decides the picture, as it would be typed after the scene.
    fn options(&self) -> String {
        let option = |name: &str, value: Option<String>| value.map(|value| format!(" --{name} {value}"));
        let number = |name: &str, value: Option<u32>| option(name, value.map(|value| value.to_string()));
        [
            Some(self.source.options()).filter(|options| !options.is_empty()),
            option("integrator", self.integrator.map(|name| name.to_string())),
            number("width", self.width),
            number("height", self.height),
            number("seed", self.seed),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

fn side() -> clap::builder::RangedI64ValueParser<u32> {
    value_parser!(u32).range(1..=i64::from(MAX_SIDE))
}

fn stops(argument: &str) -> Result<f32, String> {
    match argument.parse::<f32>() {
        Ok(stops) if stops.is_finite() => Ok(stops),
        _ => Err("expected a number of stops, as in --exposure -1.5".into()),
    }
}
