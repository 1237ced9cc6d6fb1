//! What the command line makes of a scene, as far as it can be known before anything is compiled.

use std::time::Duration;

use clap::error::ErrorKind;

use super::{Arguments, denoised, share};
use crate::{
    cli::{failure::Failure, memory::Expected, output::Output, overrides::IntegratorName},
    load::Loaded,
    picture::{Format, check_layout},
    render::{self, Conditions, Plan, Shard},
    scene::{PixelFormat, Projection, SceneDescription, Sensor},
};

/// A render before anything is compiled.
pub(super) struct Planned {
    /// The scene with everything that the command line says of it.
    pub(super) loaded: Loaded,
    pub(super) load_time: Duration,
    /// What is to be rendered.
    pub(super) plan: Plan,
    pub(super) memory: Expected,
}

/// Loads the scene, and sees whether all that is asked for fits it, and into memory.
pub(super) fn planned(arguments: &Arguments, output: &Output) -> Result<Planned, Failure> {
    let (mut loaded, load_time) = arguments.source.load()?;
    let description = &mut loaded.description;
    arguments.overrides().apply(description);
    let film = &mut description.sensor.film;
    let crop = arguments.crop.of(film).map_err(|message| refused(ErrorKind::ValueValidation, message))?;
    film.crop = crop.or(film.crop);
    description.aovs = arguments.layers();
    can_hold(output.format, description)?;
    if arguments.denoise {
        can_denoise(arguments, description)?;
        description.aovs.extend(denoised::besides(&description.aovs));
    }
    arguments.style.warn_of_idle(output.format);
    can_be_written(description)?;
    let plan = plan(arguments, description, output.format)?;
    let may_be_part = arguments.time_limit.is_some() || plan.shard != Shard::WHOLE;
    let keeps_sums = arguments.keep.keeps_sums() || may_be_part && output.format == Format::Exr;
    let conditions = Conditions {
        quality: arguments.quality.quality(),
        threads: rayon::current_num_threads(),
        keeps_sums,
    };
    let memory = arguments.memory.check(description, &conditions)?;
    Ok(Planned { loaded, load_time, plan, memory })
}

fn refused(kind: ErrorKind, message: impl Into<String>) -> Failure {
    Failure::usage("render", kind, message.into())
}

/// Named channels fit nowhere but into an EXR.
fn can_hold(format: Format, description: &SceneDescription) -> Result<(), Failure> {
    if format == Format::Exr || (!is_aov(description) && description.aovs.is_empty()) {
        return Ok(());
    }
    let message = "layers and the aov integrator write named channels, which only an .exr can hold";
    Err(refused(ErrorKind::ArgumentConflict, message))
}

/// What encoders refuse is refused while nothing is lost.
fn can_be_written(description: &SceneDescription) -> Result<(), Failure> {
    let window = description.sensor.film.window();
    let names = render::channels(description);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    check_layout(window.width, window.height, &names)
        .map_err(|error| Failure::Sentence(format!("the picture can't be written: {error}")))
}

/// Noise is that of light, in a whole picture that a camera sees.
fn can_denoise(arguments: &Arguments, description: &SceneDescription) -> Result<(), Failure> {
    let why = if is_aov(description) {
        "--denoise takes the noise out of light, which the aov integrator does not write"
    } else if matches!(description.sensor.projection, Projection::IrradianceMeter { .. }) {
        "--denoise needs a picture, and a meter has one number"
    } else if arguments.share.get()?.is_some() {
        "--denoise needs a whole picture, and a shard has none"
    } else {
        return Ok(());
    };
    Err(refused(ErrorKind::ArgumentConflict, why))
}

fn is_aov(description: &SceneDescription) -> bool {
    IntegratorName::from(&description.integrator) == IntegratorName::Aov
}

/// What is to be rendered of the scene.
fn plan(arguments: &Arguments, description: &SceneDescription, format: Format) -> Result<Plan, Failure> {
    let refuse = |message: &str| Err(refused(ErrorKind::ArgumentConflict, message));
    let target_error = arguments.target_error;
    if target_error.is_some() && is_aov(description) {
        return refuse("--target-error is the error of light, which the aov integrator does not write");
    }
    let Some(shard) = arguments.share.get()? else {
        return Ok(Plan { target_error, ..Plan::default() });
    };
    if format != Format::Exr {
        return refuse("the sums of a shard fit only into an .exr");
    }
    if target_error.is_some() && shard.by == render::ShardBy::Samples {
        return refuse("--target-error needs all samples of a tile at hand; use --shard-by tiles");
    }
    let Sensor { film, sampler, .. } = &description.sensor;
    if film.format != PixelFormat::Rgb {
        return refuse("shards are merged without the scene, and so only with a pixel_format of rgb");
    }
    match share::too_many(shard, sampler.sample_count, render::tile_count(film.window())) {
        Some(why) => refuse(&why),
        None => Ok(Plan { shard, target_error }),
    }
}
