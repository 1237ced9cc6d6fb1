//! `packlight render SCENE -o OUT`.

mod aovs;
mod crop;
pub(super) mod denoised;
mod display;
mod keep;
pub(super) mod lesson;
mod meanwhile;
mod plan;
mod rescue;
mod save;
mod share;

use std::time::{Duration, Instant};

use clap::{Args, ValueEnum, error::ErrorKind, value_parser};

use super::{
    MACHINE, console, duration,
    failure::{Failure, warn_of},
    memory::{self, MemoryOption},
    metadata,
    output::{Output, check_writable},
    overrides::{IntegratorName, MAX_SIDE, Overrides},
    progress::Bar,
    quality::QualityOption,
    replay::{self, Replay},
    report::{Report, Sources},
    signals,
    source::{Source, warn_of_degenerate},
    style::StyleOptions,
    threads::ThreadsOption,
    way::RouteName,
};
use crate::{
    compile::compile_owned,
    load::Loaded,
    picture::Format,
    render::{self, Coverage, Settings, Watch},
    scene::{AovChannel, Film},
};
use crop::CropOptions;
use keep::{KeepOptions, Name};
use lesson::Lesson;
use plan::{Planned, planned};
use save::Ended;
use share::ShardOptions;

const PICTURE: &str = "Picture";
const REPORT: &str = "Report";

const EXAMPLES: &str = "\
Examples:
  packlight render room.xml -o room.exr --aov albedo,normal
  packlight render room.xml -o quick.png --time-limit 10s
  packlight render room.xml -o clean.exr \\
      --spp 4096 --target-error 0.01
  packlight render room.xml -o small.png \\
      --width 400 --spp 64 --denoise --tonemap agx
  packlight render room.xml -o a.exr --crop 200,312,96,180
  packlight render room.xml -o live.exr \\
      --display-server localhost:14158
  packlight render room.xml -o long.exr \\
      --checkpoint kept.exr --resume kept.exr
  packlight render room.xml -o part-3.exr --shard 3/16";

/// Arguments of `render`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,

    /// Picture to write: .exr (linear, all channels), .hdr (linear) or .png (8-bit sRGB)
    #[arg(short, long, visible_alias = "outfile", value_name = "OUT", value_parser = Output::parse, required_unless_present = "pixel")]
    output: Option<Output>,

    /// How light is transported, in place of what the scene says
    #[arg(long, value_name = "NAME", help_heading = PICTURE)]
    integrator: Option<IntegratorName>,

    /// Samples per pixel
    #[arg(long, value_name = "N", help_heading = PICTURE, allow_negative_numbers = true, value_parser = value_parser!(u32).range(1..))]
    spp: Option<u32>,

    /// Columns; without --height the aspect ratio is kept
    #[arg(long, value_name = "W", help_heading = PICTURE, value_parser = side())]
    width: Option<u32>,

    /// Rows; without --width the aspect ratio is kept
    #[arg(long, value_name = "H", help_heading = PICTURE, value_parser = side())]
    height: Option<u32>,

    #[command(flatten, next_help_heading = PICTURE)]
    crop: CropOptions,

    /// Seed of every random decision
    #[arg(long, value_name = "N", help_heading = PICTURE, allow_negative_numbers = true)]
    seed: Option<u32>,

    /// Layers of the .exr beside the picture: what the camera sees, averaged over the pixel
    #[arg(long, value_name = "NAME,…", help_heading = PICTURE, value_delimiter = ',')]
    aov: Vec<aovs::Layer>,

    /// A second picture without noise, OUT.denoised.EXT, by Open Image Denoise; OUT stays as it is
    ///
    /// It looks at the layers albedo and normal; they are in the files only if --aov names them, and in a part to
    /// be continued. The library is looked for where OIDN_LIB says, else where the system has libraries.
    #[arg(long, help_heading = PICTURE, conflicts_with = "pixel")]
    denoise: bool,

    /// A part of the picture is done when its relative error is estimated to be as small as this; --spp is
    /// the most it takes
    #[arg(long, value_name = "ERROR", help_heading = PICTURE, allow_negative_numbers = true, value_parser = error)]
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
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, conflicts_with = "output", value_parser = replay::pixel)]
    pixel: Option<[u32; 2]>,

    /// Only this sample of the pixel, from 0
    #[arg(long, value_name = "N", requires = "pixel", value_parser = value_parser!(u32).range(..i64::from(u32::MAX)))]
    sample: Option<u32>,

    #[command(flatten, next_help_heading = MACHINE)]
    threads: ThreadsOption,

    /// Eight rays at a time, or one at a time as a reference
    #[arg(long, value_name = "NAME", help_heading = MACHINE, default_value = "packet")]
    backend: Backend,

    /// How packets go through the tree: for measurement
    #[arg(long, value_name = "WAY", help_heading = MACHINE, default_value = "chosen")]
    way: RouteName,

    #[command(flatten, next_help_heading = MACHINE)]
    quality: QualityOption,

    /// Show the picture while it is rendered: in tev, or whatever listens there as tev does
    #[arg(long, value_name = "HOST:PORT", help_heading = MACHINE, conflicts_with = "pixel", value_parser = display::parse)]
    display_server: Option<display::Server>,

    #[command(flatten, next_help_heading = MACHINE)]
    memory: MemoryOption,

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
    if arguments.denoise {
        check_writable(&denoised::beside(&output.path))?;
    }
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
    let way_on = match arguments.continued_by(output) {
        Some(kept) => format!("--resume {kept} continues it"),
        None => "what is to be continued needs an .exr, or a --checkpoint".into(),
    };
    Err(Failure::Stopped(format!("stopped: {path} has {samples} samples a pixel; {way_on}")))
}

/// Load, compile, and one pixel by itself.
fn numbers(arguments: &Arguments, pixel: [u32; 2]) -> Result<Replay, Failure> {
    let (Loaded { mut description, .. }, _) = arguments.source.load()?;
    arguments.overrides().apply(&mut description);
    let Film { width, height, .. } = description.sensor.film;
    if pixel[0] >= width || pixel[1] >= height {
        let message = format!("--pixel is outside of the picture, which has {width} x {height} pixels");
        return Err(Failure::usage("render", ErrorKind::ValueValidation, message));
    }
    let scene = compile_owned(description, arguments.quality.quality())?;
    let name = arguments.source.path.display().to_string();
    Ok(Replay::new(&scene, name, &arguments.settings(), pixel, arguments.sample))
}

/// What can be known of a render before anything is compiled: whether the scene loads, and whether the
/// options fit it and each other.
pub(super) fn check(arguments: &Arguments) -> Result<(), Failure> {
    arguments.output.as_ref().map_or(Ok(()), |output| planned(arguments, output).map(drop))
}

/// Load, compile, render, save.
fn picture(arguments: &Arguments, output: &Output) -> Result<(Report, Coverage), Failure> {
    let Planned { loaded: Loaded { description, origins, .. }, load_time, plan, memory } =
        planned(arguments, output)?;
    let denoiser = arguments.denoise.then(denoised::load).transpose()?;
    let facts = metadata::facts(&description);
    let scene = compile_owned(description, arguments.quality.quality())?;
    warn_of_degenerate(&origins, &scene);
    let settings = arguments.settings();
    let file = arguments.source.path.file_name().unwrap_or_default().to_string_lossy();
    let name = Name { scene: &file, facts: &facts };
    let frame = arguments.keep.begin(&scene, plan, &name, arguments.quiet || arguments.json)?;
    let deadline = arguments.time_limit.map(|limit| Instant::now() + limit);
    let bar = Bar::new(arguments.quiet, deadline);
    let late = || deadline.is_some_and(|deadline| Instant::now() >= deadline);
    let watch = Watch { progress: &|progress| bar.show(progress), stop: &|| signals::wished() || late() };
    let render = || frame.render(&scene, &settings, &watch);
    let server = arguments.display_server.as_ref();
    arguments.keep.keeping(&frame, &name, || display::showing(server, &frame, &output.path, render));
    bar.finish();

    let coverage = frame.coverage();
    let denoiser = denoiser.as_ref();
    let ended = Ended { arguments, output, scene: &scene, frame: &frame, name: &name, denoiser };
    let (statistics, denoised) = ended.save()?;
    let report = Report::from(Sources {
        name: arguments.source.path.display().to_string(),
        output: output.path.display().to_string(),
        options: arguments.options(),
        scene: &scene,
        coverage,
        continued_by: arguments.continued_by(output).filter(|_| !signals::wished()),
        settings,
        summary: scene.summary(),
        lesson: arguments.stats.then(|| Lesson::new(&scene, &statistics.profile)),
        statistics,
        denoised,
        load_time,
        threads: rayon::current_num_threads(),
        memory_budget: memory.peak(),
        peak_memory: memory::peak(),
    });
    Ok((report, coverage))
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

    /// The layers that are asked for.
    fn layers(&self) -> Vec<AovChannel> {
        self.aov.iter().map(|layer| layer.channel()).collect()
    }

    /// The file from which this render could go on, if it has not ended.
    fn continued_by(&self, output: &Output) -> Option<String> {
        let picture = (output.format == Format::Exr).then_some(&output.path);
        picture.or(self.keep.checkpoint.as_ref()).map(|path| path.display().to_string())
    }

    fn settings(&self) -> Settings {
        let backend = match self.backend {
            Backend::Packet => render::Backend::Packet,
            Backend::Scalar => render::Backend::Scalar,
        };
        Settings { backend, sort: !self.no_sort, route: self.way.into() }
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
