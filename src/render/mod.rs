//! Scene to film.
//!
//! Tiles are handed to the threads of the current rayon pool. A tile is rendered by the wavefront (eight
//! rays at a time) or by the reference (one), and both call the same integrators.

mod alpha;
mod ao;
mod aov;
mod budget;
mod camera_rays;
mod census;
mod connections;
mod departure;
mod direct;
mod frame;
mod group;
mod integrator;
mod irradiance;
mod layers;
pub mod measure;
pub mod meter;
pub mod part;
mod path;
mod pixel_format;
mod ray_classes;
mod reference;
mod rows;
mod shading;
mod shard;
mod sort;
mod statistics;
mod trace;
mod vertex;
mod wavefront;
mod whitted;

pub use budget::{Budget, Conditions, channels};
pub use census::{Census, Crowd, Ends, census};
pub use frame::{Coverage, Frame, Plan, TileView, Watch, tile_count};
pub use irradiance::Receiver;
pub use ray_classes::{Query, RayClass, ray_classes};
pub use shard::{Shard, ShardBy};
pub use statistics::{LaneUse, Profile, Statistics};
pub use trace::Route;

use bumpalo::Bump;

use crate::{
    bvh::{Tracer, Traversal},
    compile::Scene,
    picture::Picture,
    scene,
};
use integrator::Integrator;
use irradiance::Irradiance;
use part::{Difference, Part, differ};
use path::PathTracer;
use wavefront::Wavefront;

/// Which of the two pipelines renders. Their pictures are equal to the bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Backend {
    /// Eight rays at a time.
    #[default]
    Packet,
    /// One ray at a time, from the scalar functions: the reference.
    Scalar,
}

/// How to render. None of it changes a bit of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Packet or scalar.
    pub backend: Backend,
    /// Hits are sorted by material before they are shaded.
    pub sort: bool,
    /// How the packet backend's rays go through the tree.
    pub route: Route,
}

impl Default for Settings {
    fn default() -> Self {
        Self { backend: Backend::Packet, sort: true, route: Route::default() }
    }
}

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Pixel samples finished.
    pub done: u64,
    /// Pixel samples in all.
    pub total: u64,
}

/// A finished render.
#[derive(Clone, Debug, Default)]
pub struct Rendered {
    /// The channels of the film's [`PixelFormat`](scene::PixelFormat), or those of the AOV integrator.
    pub picture: Picture,
    /// What it took.
    pub statistics: Statistics,
}

/// Something to be done with whatever integrator the scene asks for.
trait Task {
    type Done;
    fn run<I: Integrator>(self, integrator: &I) -> Self::Done;
}

fn with_integrator<T: Task>(scene: &Scene, task: T) -> T::Done {
    if scene.has_meter() {
        return task.run(&meter::integrator(&scene.integrator, Receiver::Sensor));
    }
    match scene.integrator.clone() {
        scene::Integrator::Path { max_depth, rr_depth, hide_emitters } => {
            task.run(&paths(max_depth, rr_depth, hide_emitters))
        }
        scene::Integrator::Direct { hide_emitters } => task.run(&direct::Direct { hide_emitters }),
        scene::Integrator::Whitted { max_depth } => task.run(&whitted::Whitted { max_depth }),
        scene::Integrator::AmbientOcclusion { distance } => task.run(&ao::AmbientOcclusion { distance }),
        scene::Integrator::Irradiance { max_depth, rr_depth } => {
            task.run(&Irradiance { paths: paths(max_depth, rr_depth, false), receiver: None })
        }
        scene::Integrator::Aov { channels } => task.run(&aov::AovIntegrator::new(channels)),
    }
}

/// Renders on the current rayon pool. `progress` is called from its threads, now and then.
pub fn render(scene: &Scene, settings: &Settings, progress: &(dyn Fn(Progress) + Sync)) -> Rendered {
    struct Render<'a>(&'a Scene, &'a Settings, &'a (dyn Fn(Progress) + Sync));
    impl Task for Render<'_> {
        type Done = Rendered;
        fn run<I: Integrator>(self, integrator: &I) -> Rendered {
            render_with(self.0, integrator, self.1, self.2)
        }
    }
    with_integrator(scene, Render(scene, settings, progress)).formatted(scene, settings)
}

impl Frame {
    /// A picture of which nothing is rendered yet.
    pub fn new(scene: &Scene, plan: Plan) -> Self {
        struct Channels<'a>(&'a Scene);
        impl Task for Channels<'_> {
            type Done = Vec<String>;
            fn run<I: Integrator>(self, integrator: &I) -> Vec<String> {
                integrator.all_channels(self.0)
            }
        }
        Self::with_channels(scene, with_integrator(scene, Channels(scene)), plan)
    }

    /// A picture of which a part is there: the one of these facts, rendered by the same plan. It may have
    /// been asked for fewer samples.
    ///
    /// # Errors
    /// The [`Difference`] by which the part is one of another picture.
    pub fn resume(
        scene: &Scene,
        plan: Plan,
        facts: &[(String, String)],
        part: Part,
    ) -> Result<Self, Difference> {
        let mut frame = Self::new(scene, plan);
        let ours = frame.part("", facts);
        ours.same_picture(&part)?;
        differ("shard", part.plan.shard, plan.shard)?;
        if part.plan.shard.by != plan.shard.by || plan.shard != Shard::WHOLE {
            differ("number of samples", part.samples, ours.samples)?;
        }
        if part.tiles.iter().any(|tile| tile.film.samples.end > ours.samples) {
            differ("number of samples", part.samples, ours.samples)?;
        }
        frame.adopt(part);
        Ok(frame)
    }

    /// Renders what is missing, on the current rayon pool, until it is stopped.
    pub fn render(&self, scene: &Scene, settings: &Settings, watch: &Watch<'_>) {
        struct Render<'a>(&'a Frame, &'a Scene, &'a Settings, &'a Watch<'a>);
        impl Task for Render<'_> {
            type Done = ();
            fn run<I: Integrator>(self, integrator: &I) {
                let Self(frame, scene, settings, watch) = self;
                frame.run(scene, integrator, settings, watch);
            }
        }
        with_integrator(scene, Render(self, scene, settings, watch));
    }
}

/// What one sample of the pixel (x, y) brings: names of channels, and values that may be NaN or infinite.
/// A pixel outside of the film has samples too.
pub fn replay(scene: &Scene, settings: &Settings, pixel: (u32, u32), sample: u32) -> Vec<(String, f32)> {
    struct Replay<'a>(&'a Scene, &'a Settings, (u32, u32), u32);
    impl Task for Replay<'_> {
        type Done = Vec<(String, f32)>;
        fn run<I: Integrator>(self, integrator: &I) -> Self::Done {
            let Self(scene, settings, pixel, sample) = self;
            let values = match settings.backend {
                Backend::Packet => {
                    let arena = Bump::new();
                    let tracer = &mut Tracer::new(());
                    Wavefront::new((&arena, tracer), scene, integrator, settings).sample(pixel, sample)
                }
                Backend::Scalar => {
                    let (mut traversal, mut statistics) = (Traversal::new(()), Statistics::default());
                    reference::sample(scene, integrator, pixel, sample, &mut traversal, &mut statistics).0
                }
            };
            integrator.all_channels(scene).into_iter().zip(values).collect()
        }
    }
    with_integrator(scene, Replay(scene, settings, pixel, sample))
}

fn paths(max_depth: Option<u32>, rr_depth: u32, hide_emitters: bool) -> PathTracer {
    PathTracer { max_depth: max_depth.unwrap_or(u32::MAX), rr_depth, hide_emitters }
}

fn render_with<I: Integrator>(
    scene: &Scene,
    integrator: &I,
    settings: &Settings,
    progress: &(dyn Fn(Progress) + Sync),
) -> Rendered {
    let frame = Frame::with_channels(scene, integrator.all_channels(scene), Plan::default());
    frame.run(scene, integrator, settings, &Watch { progress, stop: &|| false });
    frame.develop()
}
