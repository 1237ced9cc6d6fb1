//! `packlight render SCENE -o OUT`.

mod aovs;
mod keep;
pub(super) mod lesson;
mod rescue;
mod share;

use std::time::{Duration, Instant};

use clap::{Args, CommandFactory, ValueEnum, error::ErrorKind, value_parser};

use super::{
    Cli, console, duration,
    failure::{Failure, warn_of},
    memory,
    metadata::{self, About},
    output::Output,
    overrides::{IntegratorName, MAX_SIDE, Overrides},
    part_file,
    progress::Bar,
    quality::QualityOption,
    replay::{self, Replay},
    report::{Report, Sources},
    signals,
    source::{Source, warn_of_degenerate},
    style::StyleOptions,
    threads::ThreadsOption,
};
use crate::{
    compile::compile_with,
    load::Loaded,
    picture::{Format, save_with},
    render::{self, Coverage, Frame, Plan, Settings, Watch},
    scene::{Film, PixelFormat, SceneDescription, Sensor},
};
use keep::{KeepOptions, Name};
use lesson::Lesson;
use share::ShardOptions;

const PICTURE: &str = "Picture";
const MACHINE: &str = "Machine (never changes a bit of the picture)";

const REPORT: &str = "Report";

const EXAMPLES: &str = "\
Examples:
  packlight render scenes/cornell.xml -o cornell.exr --aov albedo,normal,depth
  packlight render scenes/cornell.xml -o preview.png --time-limit 10s --tonemap agx
  packlight render scenes/cornell.xml -o clean.exr --spp 4096 --target-error 0.01
  packlight render scenes/cornell.xml -o long.exr --checkpoint kept.exr --resume kept.exr
  packlight render scenes/cornell.xml -o part-3.exr --shard 3/16";

/// Arguments of `render`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
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

    /// Layers of the .exr beside the picture: what the camera sees, averaged over the pixel
    #[arg(long, value_name = "NAME,…", help_heading = PICTURE, value_delimiter = ',')]
    aov: Vec<aovs::Layer>,

    /// A part of the picture is done when its relative error is estimated to be as small as this; --spp is
    /// the most it takes
    #[arg(long, value_name = "ERROR", help_heading = PICTURE, value_parser = error)]
    target_error: Option<f32>,

    /// Stop after this time, with as many samples as there are then
    #[arg(long, value_name = "TIME", help_heading = PICTURE, value_parser = duration::parse)]
    time_limit: Option<Duration>,

    #[command(flatten)]
    style: StyleOptions,

    #[command(flatten)]
    keep: KeepOptions,

    #[command(flatten)]
    share: ShardOptions,

    /// In place of a picture, the numbers of this pixel's samples
    #[arg(long, value_name = "X,Y", conflicts_with = "output", value_parser = replay::pixel)]
    pixel: Option<[u32; 2]>,

    /// Only this sample of the pixel, from 0
    #[arg(long, value_name = "N", requires = "pixel")]
    sample: Option<u32>,

    #[command(flatten, next_help_heading = MACHINE)]
    threads: ThreadsOption,

    /// Eight rays at a time, or one at a time as a reference
    #[arg(long, value_name = "NAME", help_heading = MACHINE, default_value = "packet")]
    backend: Backend,

    #[command(flatten, next_help_heading = MACHINE)]
    quality: QualityOption,

    /// Shade hits as they come, not sorted by material: for measurement
    #[arg(long, help_heading = MACHINE)]
    no_sort: bool,

    /// No progress bar and no summary
    #[arg(short, long, help_heading = REPORT)]
    quiet: bool,

    /// Counts the rays of one sample by kind: what they meet in the tree, full lanes, what sorting
    /// does, how paths end
    #[arg(long, help_heading = REPORT, conflicts_with = "quiet")]
    stats: bool,

    /// The summary as one JSON object on stdout
    #[arg(long, help_heading = REPORT)]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Backend {
    Packet,
    Scalar,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pool = arguments.threads.pool()?;
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
    arguments.keep.check()?;
    signals::listen();
    let (report, coverage) = pool.install(|| picture(arguments, output))?;

    if let Some(warning) = report.warning() {
        warn_of(warning);
    }
    if arguments.json {
        console::print_json(&report)?;
    } else if !arguments.quiet {
        console::print(&report.to_string())?;
    }
    if coverage.complete || !signals::wished() {
        return Ok(());
    }
    let samples = metadata::samples(coverage, report.samples_per_pixel());
    let path = output.path.display();
    Err(Failure::Stopped(match output.format {
        Format::Exr => {
            format!("stopped: {path} has {samples} samples a pixel; --resume {path} continues it")
        }
        _ => format!("stopped: {path} has {samples} samples a pixel"),
    }))
}

/// Load, compile, and one pixel by itself.
fn numbers(arguments: &Arguments, pixel: [u32; 2]) -> Result<Replay, Failure> {
    let (Loaded { mut description, .. }, _) = arguments.source.load()?;
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

/// What can be known of a render before anything is compiled: whether the scene loads, and whether the
/// options fit it and each other.
pub(super) fn check(arguments: &Arguments) -> Result<(), Failure> {
    arguments.output.as_ref().map_or(Ok(()), |output| planned(arguments, output).map(drop))
}

/// The scene with everything that the command line says of it, the time it took to load, and what is to be
/// rendered.
fn planned(arguments: &Arguments, output: &Output) -> Result<(Loaded, Duration, Plan), Failure> {
    let (mut loaded, load_time) = arguments.source.load()?;
    let description = &mut loaded.description;
    arguments.overrides().apply(description);
    description.aovs = arguments.aov.iter().map(|layer| layer.channel()).collect();
    can_hold(output.format, description)?;
    if let Some(option) = arguments.style.only_for_png().filter(|_| output.format != Format::Png) {
        warn_of(format!("{option} only changes a .png; the numbers of this file stay linear"));
    }
    let plan = arguments.plan(description, output.format)?;
    Ok((loaded, load_time, plan))
}

/// Load, compile, render, save.
fn picture(arguments: &Arguments, output: &Output) -> Result<(Report, Coverage), Failure> {
    let (Loaded { description, origins, .. }, load_time, plan) = planned(arguments, output)?;
    let scene = compile_with(&description, arguments.quality.quality())?;
    warn_of_degenerate(&origins, &scene);
    let settings = arguments.settings();
    let facts = metadata::facts(&description);
    let file = arguments.source.path.file_name().unwrap_or_default().to_string_lossy();
    let name = Name { scene: &file, facts: &facts };
    let frame = arguments.keep.begin(&scene, plan, &name)?;
    let bar = Bar::new(arguments.quiet);
    let deadline = arguments.time_limit.map(|limit| Instant::now() + limit);
    let late = || deadline.is_some_and(|deadline| Instant::now() >= deadline);
    let watch = Watch { progress: &|progress| bar.show(progress), stop: &|| signals::wished() || late() };
    arguments.keep.keeping(&frame, &name, || frame.render(&scene, &settings, &watch));
    bar.finish();

    let coverage = frame.coverage();
    // A part keeps colours, to go on from; only a picture has the film's format.
    let is_part = output.format == Format::Exr && (plan.shard != render::Shard::WHOLE || !coverage.complete);
    let developed = frame.develop();
    let developed = if is_part { developed } else { developed.formatted(&scene, &settings) };
    save(arguments, output, &frame, &name, &developed, is_part)?;
    let report = Report::from(Sources {
        scene: arguments.source.path.display().to_string(),
        output: output.path.display().to_string(),
        options: arguments.options(),
        description: &description,
        coverage,
        settings,
        summary: scene.summary(),
        statistics: developed.statistics,
        lesson: arguments.stats.then(|| Lesson::new(&scene, &developed.statistics.profile)),
        load_time,
        threads: rayon::current_num_threads(),
        peak_memory: memory::peak(),
    });
    Ok((report, coverage))
}

/// The picture; and its sums, if it is a shard or not finished.
fn save(
    arguments: &Arguments,
    output: &Output,
    frame: &Frame,
    name: &Name<'_>,
    render::Rendered { picture, statistics }: &render::Rendered,
    is_part: bool,
) -> Result<(), Failure> {
    let about = About {
        scene: name.scene,
        facts: name.facts,
        samples: frame.samples(),
        statistics,
        coverage: frame.coverage(),
    };
    let style = arguments.style.style(&about);
    let saved = if is_part {
        part_file::save(&name.part(frame), &output.path, &style)
    } else {
        save_with(picture, &output.path, &style).map_err(|error| error.to_string())
    };
    let checkpoint = arguments.keep.checkpoint.as_deref();
    saved.map_err(|error| rescue::rescue(frame, name, &output.path, checkpoint, &error))
}

/// Named channels fit nowhere but into an EXR.
fn can_hold(format: Format, description: &SceneDescription) -> Result<(), Failure> {
    let is_aov = IntegratorName::from(&description.integrator) == IntegratorName::Aov;
    if format == Format::Exr || (!is_aov && description.aovs.is_empty()) {
        return Ok(());
    }
    let message = "layers and the aov integrator write named channels, which only an .exr can hold";
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

    /// What is to be rendered of the scene.
    fn plan(&self, description: &SceneDescription, format: Format) -> Result<Plan, Failure> {
        let refuse = |message: String| Err(Cli::command().error(ErrorKind::ArgumentConflict, message).into());
        let target_error = self.target_error;
        if target_error.is_some() && IntegratorName::from(&description.integrator) == IntegratorName::Aov {
            return refuse(
                "--target-error is the error of light, which the aov integrator does not write".into(),
            );
        }
        let Some(shard) = self.share.get()? else {
            return Ok(Plan { target_error, ..Plan::default() });
        };
        if format != Format::Exr {
            return refuse("the sums of a shard fit only into an .exr".into());
        }
        if target_error.is_some() && shard.by == render::ShardBy::Samples {
            return refuse("--target-error needs all samples of a tile at hand; use --shard-by tiles".into());
        }
        let Sensor { film, sampler, .. } = &description.sensor;
        if film.format != PixelFormat::Rgb {
            return refuse(
                "shards are merged without the scene, and so only with a pixel_format of rgb".into(),
            );
        }
        match share::too_many(shard, sampler.sample_count, render::tile_count(film.window())) {
            Some(why) => refuse(why),
            None => Ok(Plan { shard, target_error }),
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

fn error(argument: &str) -> Result<f32, String> {
    match argument.parse::<f32>() {
        Ok(error) if error > 0.0 && error < 1.0 => Ok(error),
        _ => Err("expected a relative error between 0 and 1, as in --target-error 0.01".into()),
    }
}
