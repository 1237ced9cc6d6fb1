//! `packlight info SCENE`: what was loaded, and what it was compiled to.

mod kinds;

use std::{collections::BTreeMap, fmt, time::Duration};

use clap::Args;
use serde::Serialize;

use super::{
    console,
    failure::Failure,
    memory::{self, Expected},
    overrides::IntegratorName,
    quality::{QualityName, QualityOption},
    quantity::{self, counted, grouped, time},
    source::{Source, warn_of_degenerate},
};
use crate::{
    compile::{Summary, TreeShape, compile_owned},
    load::Loaded,
    render::Conditions,
    scene::{Integrator, Projection, SceneDescription, Sensor},
    simd::cpu,
};

const EXAMPLES: &str = "\
Examples:
  packlight info scenes/cornell.xml
  packlight info bunny.obj --quality high
  packlight info scenes/cornell.xml -D spp=64 --json";

/// Arguments of `info`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    #[command(flatten)]
    source: Source,

    #[command(flatten)]
    quality: QualityOption,

    /// One JSON object on stdout
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (Loaded { description, origins, .. }, load_time) = arguments.source.load()?;
    let quality = arguments.quality.quality();
    let conditions = Conditions { quality, threads: rayon::current_num_threads(), keeps_sums: false };
    let expected = Expected::new(&description, &conditions);
    let described = Described::new(&description);
    let compiled = compile_owned(description, quality)?;
    warn_of_degenerate(&origins, &compiled);
    let scene = arguments.source.path.display().to_string();
    let compiled = (compiled.summary(), compiled.tree_shape());
    let info = Info::new(scene, described, compiled, &expected, load_time);
    if arguments.json { console::print_json(&info) } else { console::print(&info.to_string()) }
}

/// What is told of a description, which does not outlive its compilation.
struct Described {
    digest: String,
    shapes: usize,
    material_kinds: BTreeMap<String, u64>,
    emitter_kinds: BTreeMap<String, u64>,
    sensor: Sensor,
    integrator: Integrator,
}

impl Described {
    fn new(description: &SceneDescription) -> Self {
        Self {
            digest: format!("{:016x}", description.fingerprint()),
            shapes: description.shapes.len(),
            material_kinds: kinds::kinds(&description.materials),
            emitter_kinds: kinds::kinds(&description.emitters),
            sensor: description.sensor.clone(),
            integrator: description.integrator.clone(),
        }
    }
}

/// Field names are the keys of `--json`; units are in the names.
#[derive(Clone, Debug, Serialize)]
struct Info {
    scene: String,
    /// By which checkpoints and shards know it.
    digest: String,
    shapes: usize,
    material_kinds: BTreeMap<String, u64>,
    emitter_kinds: BTreeMap<String, u64>,
    bvh_depth: u32,
    bvh_node_cost: f64,
    bvh_primitive_cost: f64,
    instructions_offered: Vec<&'static str>,
    triangles: u64,
    degenerate_triangles: u64,
    quadrics: u64,
    groups: u32,
    instances: u64,
    /// Primitives of all instances.
    placed_primitives: u64,
    /// What an instance adds to what tracing and shading read, its part of the upper tree included.
    bytes_per_instance: u64,
    materials: u32,
    lights: u32,
    bvh_nodes: u64,
    bvh_bytes: u64,
    bvh_seconds: f64,
    quality: &'static str,
    load_seconds: f64,
    /// The most memory that rendering is expected to take on as many threads as there are cores: what
    /// `--memory-limit` is compared with.
    memory_budget_bytes: u64,
    /// What it is taken for; not all of it at one time.
    memory_parts_bytes: Vec<(&'static str, u64)>,
    /// The most memory the program has had, the description of the scene included; absent where the system
    /// does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    peak_memory_bytes: Option<u64>,
    width: u32,
    height: u32,
    samples_per_pixel: u32,
    seed: u32,
    projection: &'static str,
    /// Of the film's width; absent where rays are parallel.
    #[serde(skip_serializing_if = "Option::is_none")]
    x_fov_degrees: Option<f64>,
    position: [f64; 3],
    looking: [f64; 3],
    integrator: String,
    max_depth: Option<u32>,
    lanes: String,
}

impl Info {
    fn new(
        scene: String,
        described: Described,
        (summary, tree): (Summary, TreeShape),
        expected: &Expected,
        load_time: Duration,
    ) -> Self {
        let Described { digest, shapes, material_kinds, emitter_kinds, sensor, integrator } = described;
        let (projection, x_fov_degrees) = match sensor.projection {
            Projection::Perspective { x_fov } => ("perspective", Some(x_fov.to_degrees())),
            Projection::ThinLens { x_fov, .. } => ("thinlens", Some(x_fov.to_degrees())),
            Projection::Orthographic => ("orthographic", None),
            Projection::IrradianceMeter { .. } => ("irradiancemeter", None),
        };
        Self {
            scene,
            digest,
            shapes,
            material_kinds,
            emitter_kinds,
            bvh_depth: tree.depth,
            bvh_node_cost: tree.node_cost,
            bvh_primitive_cost: tree.primitive_cost,
            instructions_offered: cpu::offered(),
            triangles: summary.triangles,
            degenerate_triangles: summary.degenerate,
            quadrics: summary.quadrics,
            groups: summary.groups,
            instances: summary.instances,
            placed_primitives: summary.placed,
            bytes_per_instance: summary.instance_bytes,
            materials: summary.materials,
            lights: summary.lights,
            bvh_nodes: summary.bvh_nodes,
            bvh_bytes: summary.bvh_bytes,
            bvh_seconds: summary.bvh_time.as_secs_f64(),
            quality: QualityName::from(summary.quality).name(),
            load_seconds: load_time.as_secs_f64(),
            memory_budget_bytes: expected.peak(),
            memory_parts_bytes: expected.budget.parts().to_vec(),
            peak_memory_bytes: memory::peak(),
            width: sensor.film.window().width,
            height: sensor.film.window().height,
            samples_per_pixel: sensor.sampler.sample_count,
            seed: sensor.sampler.seed,
            projection,
            x_fov_degrees,
            position: sensor.to_world.translation.to_array(),
            looking: sensor.to_world.matrix3.z_axis.normalize_or_zero().to_array(),
            integrator: IntegratorName::from(&integrator).to_string(),
            max_depth: match integrator {
                Integrator::Path { max_depth, .. } | Integrator::Irradiance { max_depth, .. } => max_depth,
                Integrator::Whitted { max_depth } => Some(max_depth),
                Integrator::Direct { .. } | Integrator::AmbientOcclusion { .. } | Integrator::Aov { .. } => {
                    None
                }
            },
            lanes: cpu::compiled(),
        }
    }
}

fn counts(count: u64, kinds: &BTreeMap<String, u64>) -> String {
    if kinds.is_empty() { grouped(count) } else { format!("{}: {}", grouped(count), kinds::listed(kinds)) }
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = |seconds: f64| time(Duration::from_secs_f64(seconds));
        let vector = |[x, y, z]: [f64; 3]| format!("({x:.3}, {y:.3}, {z:.3})");
        let sensor = match self.x_fov_degrees {
            Some(degrees) => format!("{}, {degrees:.2} degrees across", self.projection),
            None => self.projection.to_owned(),
        };
        let integrator = match self.max_depth {
            Some(depth) => format!("{}, depth at most {depth}", self.integrator),
            None => self.integrator.clone(),
        };
        let instances = match self.instances {
            0 => grouped(0),
            count => format!(
                "{} of {}, {} primitives, {} bytes an instance",
                grouped(count),
                counted(self.groups, "group"),
                grouped(self.placed_primitives),
                grouped(self.bytes_per_instance)
            ),
        };
        let rows = [
            ("shapes", grouped(self.shapes as u64)),
            ("triangles", grouped(self.triangles)),
            ("degenerate", grouped(self.degenerate_triangles)),
            ("quadrics", grouped(self.quadrics)),
            ("instances", instances),
            ("materials", counts(self.materials.into(), &self.material_kinds)),
            ("lights", counts(self.lights.into(), &self.emitter_kinds)),
            (
                "BVH",
                format!(
                    "{}, {} deep, {}, {} quality",
                    counted(self.bvh_nodes, "node"),
                    self.bvh_depth,
                    quantity::memory(self.bvh_bytes),
                    self.quality
                ),
            ),
            (
                "",
                format!(
                    "a line enters {:.1} nodes and meets {:.1} primitives (surface area heuristic)",
                    self.bvh_node_cost, self.bvh_primitive_cost
                ),
            ),
            ("time", format!("load {}, BVH {}", seconds(self.load_seconds), seconds(self.bvh_seconds))),
            (
                "memory",
                self.peak_memory_bytes
                    .map_or("unknown".into(), |bytes| format!("{} at the peak", quantity::memory(bytes)))
                    + &format!(", about {} to render", quantity::memory(self.memory_budget_bytes)),
            ),
            ("", memory::listed(&self.memory_parts_bytes)),
            ("film", format!("{} x {}", self.width, self.height)),
            ("samples", format!("{} a pixel, seed {}", self.samples_per_pixel, self.seed)),
            ("sensor", sensor),
            ("", format!("at {}, looking along {}", vector(self.position), vector(self.looking))),
            ("integrator", integrator),
            ("lanes", self.lanes.clone()),
            ("processor", self.instructions_offered.join(", ")),
            ("digest", self.digest.clone()),
        ];
        writeln!(f, "{}", self.scene)?;
        for (name, value) in rows {
            writeln!(f, "  {name:<11} {value}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info() -> Info {
        let summary = Summary {
            triangles: 69_451,
            bvh_bytes: 3 << 20,
            groups: 1,
            instances: 100_000,
            placed: 6_945_100_000,
            instance_bytes: 250,
            ..Summary::default()
        };
        let description = SceneDescription::default();
        let conditions = Conditions { quality: summary.quality, threads: 2, keeps_sums: false };
        let expected = Expected::new(&description, &conditions);
        let compiled = (summary, TreeShape::default());
        Info::new(
            "bunny.xml".into(),
            Described::new(&description),
            compiled,
            &expected,
            Duration::from_millis(5),
        )
    }

    #[test]
    fn the_table_holds_what_was_compiled() {
        let text = info().to_string();
        for part in [
            "69,451",
            "100,000 of 1 group, 6,945,100,000 primitives, 250 bytes an instance",
            "0 deep, 3.0 MiB, medium quality",
            "MiB to render",
            "program 8.5 MiB, film",
            "768 x 576",
            "perspective, 42.31 degrees",
            "path",
            "f32x8",
        ] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
    }

    #[test]
    fn json_names_its_units() {
        let json = serde_json::to_value(info()).unwrap();
        assert_eq!(json["load_seconds"], 0.005);
        assert_eq!(json["looking"], serde_json::json!([0.0, 0.0, 1.0]));
        assert!(json["max_depth"].is_null());
        assert_eq!(json["peak_memory_bytes"].is_u64(), memory::peak().is_some());
    }
}
