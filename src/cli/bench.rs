//! `packlight bench`: how fast rays are traced, the scene's own or those of a file.

mod row;
mod whitted;

use std::{fs, path::PathBuf, sync::Arc};

use clap::Args;
use glam::DAffine3;

use super::{
    MACHINE, console,
    failure::{Failure, warn, warn_of},
    quality::QualityOption,
    ray_file,
    source::{Source, definition},
    threads::ThreadsOption,
    way::WayName,
};
use crate::{
    compile::{Scene, compile_owned},
    geometry::ray_file::{RayFile, encode},
    load::{Loaded, load_mesh},
    render::{Query, RayClass, measure, ray_classes},
    scene::{Geometry, Material, MaterialIndex, SceneDescription, Shape},
};
use row::{Build, Row, Table};

const EXAMPLES: &str = "\
Examples:
  packlight bench scenes/cornell.xml
  packlight bench gen:terrain:1M --threads 1 --quality high
  packlight bench scenes/cornell.xml --save-rays rays --json
  packlight bench --mesh bunny.obj --rays rays/diffuse.rays
  packlight bench scenes/whitted.xml --whitted";

/// Arguments of `bench`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(super) struct Arguments {
    /// Scene or bare mesh, as for `render`; without --rays its own camera, shadow, ambient occlusion
    /// and bounce rays are traced
    #[arg(value_name = "SCENE", required_unless_present = "mesh", conflicts_with = "mesh")]
    scene: Option<PathBuf>,

    /// Value of `$NAME` in the scene, stronger than its <default>; repeatable
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = definition)]
    defines: Vec<(String, String)>,

    /// In place of a scene: the triangles of an .obj or .ply file, or made on the spot
    /// (gen:KIND:N[:SEED] with KIND soup, terrain, spheres or hair and N like 100k)
    #[arg(long, value_name = "MESH", requires = "rays")]
    mesh: Option<PathBuf>,

    /// Rays to trace: raw little-endian f32, ox oy oz t_near dx dy dz t_far for each
    #[arg(long, value_name = "FILE")]
    rays: Option<PathBuf>,

    /// What is asked of the rays of a file: closest (the nearest hit) or any (is it blocked?)
    #[arg(long, value_name = "QUERY", requires = "rays", default_value = "closest", value_parser = query)]
    query: Query,

    /// Write the scene's own rays into this folder, a file a class
    #[arg(long, value_name = "DIR", conflicts_with = "rays")]
    save_rays: Option<PathBuf>,

    /// The picture of 1979 in place of rays: 512 x 512, one sample a pixel, recursion; its time beside those of
    /// 1980 and 2006
    #[arg(long, requires = "scene", conflicts_with_all = ["rays", "save_rays", "mesh", "way"])]
    whitted: bool,

    #[command(flatten, next_help_heading = MACHINE)]
    threads: ThreadsOption,

    /// Timed runs after a warm-up; the best counts
    #[arg(long, value_name = "K", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repeat: u32,

    /// How the rays go through the tree; the answers stay the same to the bit
    #[arg(long, value_name = "WAY", help_heading = MACHINE, default_value = "chosen")]
    way: WayName,

    #[command(flatten, next_help_heading = MACHINE)]
    quality: QualityOption,

    /// One JSON object a class on stdout, a line each, without the single-ray path
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pool = arguments.threads.pool()?;
    if arguments.whitted {
        return pool.install(|| whitted::run(arguments));
    }
    pool.install(|| bench(arguments))
}

fn bench(arguments: &Arguments) -> Result<(), Failure> {
    // Before the scene: a slip in the name of a file should not cost the time to build a tree.
    let file = arguments.read_rays()?;
    let scene = compile_owned(arguments.describe()?, arguments.quality.quality())?;
    let (classes, invalid) = match file {
        Some((class, invalid)) => (vec![class], invalid),
        None => (ray_classes(&scene), 0),
    };
    if let Some(folder) = &arguments.save_rays {
        save(folder, &classes)?;
    }
    let table = Table::within(console::columns());
    if !arguments.json {
        console::print(&Build::new(arguments.name(), scene.summary(), table).to_string())?;
    }
    for class in &classes {
        arguments.measure(&scene, class, invalid, table)?;
    }
    Ok(())
}

impl Arguments {
    fn name(&self) -> String {
        self.scene.as_ref().or(self.mesh.as_ref()).map(|path| path.display().to_string()).unwrap_or_default()
    }

    fn measure(&self, scene: &Scene, class: &RayClass, invalid: u64, table: Table) -> Result<(), Failure> {
        let packets = measure::packets_by(scene, class, self.way.into(), self.repeat);
        let mut row = Row::new(class, invalid, packets, scene.summary());
        if self.json {
            return console::print_json_line(&row);
        }
        let singles = measure::singles(scene, class, self.repeat);
        if (packets.hits, packets.t_sum.to_bits()) != (singles.hits, singles.t_sum.to_bits()) {
            warn_of(format!("{}: packets and single rays differ; please report it", class.name));
        }
        let counts = measure::count_packets(scene, class, self.way.into());
        row.compare(singles, counts, measure::count_singles(scene, class), table);
        console::print(&row.to_string())
    }

    fn read_rays(&self) -> Result<Option<(RayClass, u64)>, Failure> {
        let Some(path) = &self.rays else {
            return Ok(None);
        };
        let RayFile { rays, invalid } = ray_file::read(path)?;
        Ok(Some((RayClass { name: "file", query: self.query, rays }, invalid)))
    }

    fn describe(&self) -> Result<SceneDescription, Failure> {
        if let Some(path) = &self.scene {
            let (Loaded { description, .. }, _) = Source::new(path.clone(), self.defines.clone()).load()?;
            return Ok(description);
        }
        let (mesh, warnings) = load_mesh(self.mesh.as_deref().unwrap_or("".as_ref()))?;
        warn(&warnings);
        let shape = Shape {
            name: self.name(),
            geometry: Geometry::Mesh { mesh: Arc::new(mesh), face_normals: true },
            to_world: DAffine3::IDENTITY,
            flip_normals: false,
            material: MaterialIndex(0),
            radiance: None,
        };
        Ok(SceneDescription {
            shapes: vec![shape],
            materials: vec![Material::default()],
            ..Default::default()
        })
    }
}

fn save(folder: &std::path::Path, classes: &[RayClass]) -> Result<(), Failure> {
    let told = |error| Failure::Sentence(format!("can't write rays into {}: {error}", folder.display()));
    fs::create_dir_all(folder).map_err(told)?;
    for class in classes {
        fs::write(folder.join(format!("{}.rays", class.name)), encode(&class.rays)).map_err(told)?;
    }
    Ok(())
}

fn query(argument: &str) -> Result<Query, String> {
    match argument {
        "closest" => Ok(Query::Closest),
        "any" => Ok(Query::Any),
        _ => Err("expected `closest` or `any`".into()),
    }
}
