//! `bench SCENE --whitted`: the picture of 1979 once more, and how much longer it used to take.

use std::{
    fmt,
    time::{Duration, Instant},
};

use serde::Serialize;

use super::{Arguments, Failure};
use crate::{
    cli::{
        console,
        overrides::{IntegratorName, Overrides},
        source::Source,
    },
    compile::compile_owned,
    load::Loaded,
    render::{Settings, render},
};

/// Pixels along each side, one sample each.
const SIZE: u32 = 512;
/// On a VAX-11/780, as published in 1980 \[Whi80\].
const VAX: Duration = Duration::from_secs(74 * 60);
/// On a personal computer of 2006, as told in Ramamoorthi's lecture.
const PC: Duration = Duration::from_secs(6);

/// The time of the best run, and what it is compared to.
#[derive(Clone, Debug, Serialize)]
struct Frame {
    scene: String,
    width: u32,
    height: u32,
    threads: usize,
    rays: u64,
    milliseconds: f64,
    times_vax_1980: f64,
    times_pc_2006: f64,
}

/// Renders the scene by recursion, [`SIZE`] × [`SIZE`] pixels with one sample each, as often as the arguments
/// say after a warm-up.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let path = arguments.scene.clone().unwrap_or_default();
    let (Loaded { mut description, .. }, _) = Source::new(path, arguments.defines.clone()).load()?;
    let overrides = Overrides {
        integrator: Some(IntegratorName::Whitted),
        spp: Some(1),
        width: Some(SIZE),
        height: Some(SIZE),
        seed: None,
    };
    overrides.apply(&mut description);
    let scene = compile_owned(description, arguments.quality.quality())?;
    let once = || {
        let start = Instant::now();
        let statistics = render(&scene, &Settings::default(), &|_| {}).statistics;
        (start.elapsed(), statistics)
    };
    let (first, warm_up) = once();
    let best = (0..arguments.repeat).map(|_| once().0).min().unwrap_or(first).as_secs_f64();
    let frame = Frame {
        scene: arguments.name(),
        width: SIZE,
        height: SIZE,
        threads: rayon::current_num_threads(),
        rays: warm_up.camera_rays + warm_up.bounce_rays + warm_up.shadow_rays,
        milliseconds: best * 1e3,
        times_vax_1980: VAX.as_secs_f64() / best,
        times_pc_2006: PC.as_secs_f64() / best,
    };
    if arguments.json { console::print_json_line(&frame) } else { console::print(&frame.to_string()) }
}

impl fmt::Display for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, width, height, threads, rays, milliseconds, times_vax_1980, times_pc_2006 } = self;
        writeln!(f, "{scene}")?;
        writeln!(f, "  {width} x {height} pixels, one sample each, recursion: {} k rays", rays / 1000)?;
        writeln!(f, "  {milliseconds:.1} ms on {threads} threads")?;
        writeln!(f, "  {times_vax_1980:.0} times as fast as a VAX-11/780 in 1980 (74 minutes)")?;
        writeln!(f, "  {times_pc_2006:.0} times as fast as a PC in 2006 (6 seconds)")
    }
}
