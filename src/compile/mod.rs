//! A description to columns in leaf order, ids and a tree.

mod attributes;
mod canonical;
mod corners;
mod filter;
mod instances;
mod lights;
mod materials;
mod mesh;
mod needs;
mod primitives;
mod queries;
mod shapes;
mod streams;
mod surfaces;
mod tree;
mod vertices;

use std::{
    mem,
    time::{Duration, Instant},
};

pub use lights::envmap;
pub use needs::{Needs, needs};
pub use primitives::Primitives;
pub use queries::Asked;
pub use shapes::Degenerate;
pub use surfaces::Surface;
pub use tree::TreeShape;

use glam::Vec3;

use crate::bvh::{Bvh, Child, Quality, Reference};
use crate::camera::Camera;
use crate::film::Filter;
use crate::geometry::Aabb;
use crate::light::{Light, LightChoice, LightId, Sight};
use crate::material::MaterialTable;
use crate::scene::{
    Aov, AovChannel, Film, Integrator, Projection, Sampler, SceneDescription, Sensor, Shape, ShapeGroup,
};
use crate::texture::TextureTable;
use attributes::AttributedMeshes;
use instances::Instances;
use shapes::{Metered, Named};
use surfaces::Surfaces;

/// A scene ready to be traced.
#[derive(Debug)]
pub struct Scene {
    pub(crate) primitives: Primitives,
    pub(crate) bvh: Bvh,
    surfaces: Surfaces,
    pub(crate) materials: MaterialTable,
    pub(crate) textures: TextureTable,
    pub(crate) lights: Vec<Light>,
    /// Which of them is sampled where one is.
    pub(crate) light_choice: LightChoice,
    /// Lights that rays which leave the scene see.
    pub(crate) environments: Vec<LightId>,
    /// Where rays may find light.
    pub(crate) sight: Sight,
    /// Size of the bounds of everything that can be hit.
    extent: Vec3,
    /// In place of what the camera sees.
    pub(crate) metered: Option<Metered>,
    pub(crate) camera: Camera,
    pub(crate) filter: Filter,
    /// Size of the picture.
    pub film: Film,
    /// Samples per pixel and seed.
    pub sampler: Sampler,
    /// What is estimated.
    pub integrator: Integrator,
    /// What the camera sees besides.
    pub aovs: Vec<AovChannel>,
    /// Are (u, v) among what the camera sees?
    pub shows_uv: bool,
    summary: Summary,
    degenerate: Vec<Degenerate>,
}

/// What was compiled, for people.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// Triangles that can be hit.
    pub triangles: u64,
    /// Spheres, disks and cylinders.
    pub quadrics: u64,
    /// Triangles left out because they have no area.
    pub degenerate: u64,
    /// Materials after compilation.
    pub materials: u32,
    /// Lights, area lights included.
    pub lights: u32,
    /// Groups of shapes. What is in them counts once above and below.
    pub groups: u32,
    /// Places where groups stand.
    pub instances: u64,
    /// Primitives that can be hit in all instances, each counted wherever it stands.
    pub placed: u64,
    /// Bytes that an instance adds: its maps, its box, its slot and its part of the upper tree.
    pub instance_bytes: u64,
    /// Nodes of the tree, and of the groups' trees.
    pub bvh_nodes: u64,
    /// Bytes that tracing reads: nodes, primitive blocks and instances.
    pub bvh_bytes: u64,
    /// Time from boxes to everything that tracing reads: tree and primitive blocks.
    pub bvh_time: Duration,
    /// How much work went into the tree.
    pub quality: Quality,
}

impl Scene {
    /// Is its sensor an irradiance meter on a shape that can be hit?
    pub fn has_meter(&self) -> bool {
        self.metered.is_some()
    }

    /// What was compiled.
    pub fn summary(&self) -> Summary {
        self.summary
    }

    /// Which shapes have triangles without area, which are left out: in the world, then in groups.
    pub fn degenerate(&self) -> &[Degenerate] {
        &self.degenerate
    }
}

/// Why a description can't be compiled.
#[derive(Debug, Clone, thiserror::Error)]
pub enum CompileError {
    /// More primitives than a tree can name.
    #[error("the scene has {0} primitives, more than the {max} that a tree can hold; split it", max = MAX_PRIMITIVES)]
    TooManyPrimitives(u64),
    /// A coordinate that does not fit 32 bits once it is in the world.
    #[error("shape `{shape}` reaches beyond what 32-bit floats can hold; scale the scene down")]
    OutOfRange {
        /// Name of the shape, or of the group that is placed.
        shape: String,
    },
    /// A shape that shines in a group.
    #[error("shape `{shape}` shines, but stands in a group; let it stand in the scene itself")]
    EmitterInGroup {
        /// Name of the shape.
        shape: String,
    },
}

/// Padding of blocks takes some of the slots that a child's word can name.
const MAX_PRIMITIVES: u64 = Child::LIMIT as u64 / 2;

/// [`compile_with`] the default quality.
///
/// # Errors
/// [`CompileError`].
pub fn compile(description: &SceneDescription) -> Result<Scene, CompileError> {
    compile_with(description, Quality::default())
}

/// Builds columns, lights, materials and the tree, on the current rayon pool.
///
/// # Errors
/// [`CompileError`].
pub fn compile_with(description: &SceneDescription, quality: Quality) -> Result<Scene, CompileError> {
    // Shapes share their meshes.
    compile_shapes(description, (description.shapes.clone(), description.groups.clone()), quality)
}

/// [`compile_with`] a description that is not needed any more: a mesh that nobody else holds is given back as soon as
/// its triangles are in columns, before the tree is built, so that the memory for both is not taken at once.
///
/// # Errors
/// [`CompileError`].
pub fn compile_owned(mut description: SceneDescription, quality: Quality) -> Result<Scene, CompileError> {
    let shapes = (mem::take(&mut description.shapes), mem::take(&mut description.groups));
    compile_shapes(&description, shapes, quality)
}

/// The description is asked for all but its shapes and groups.
fn compile_shapes(
    description: &SceneDescription,
    (shapes, groups): (Vec<Shape>, Vec<ShapeGroup>),
    quality: Quality,
) -> Result<Scene, CompileError> {
    let grouped = groups.iter().flat_map(|group| &group.shapes);
    let meshes = AttributedMeshes::new(shapes.iter().chain(grouped));
    let (materials, textures, material_ids) = materials::compile(&description.materials, &meshes);
    let meshes = meshes.numbers;
    let metered = match description.sensor.projection {
        Projection::IrradianceMeter { shape } => Some(shape),
        _ => None,
    };
    let named = Named { materials: &material_ids, meshes: &meshes, metered };
    let mut lights = lights::without_surface(&description.emitters);
    let shapes::Shapes { surfaces, mut references, mut degenerate, metered } =
        shapes::compile(shapes, &named, &mut lights)?;
    let first = surfaces.shape_of.len() as u32;
    let count = u64::from(first) + description.instances.len() as u64;
    if count > MAX_PRIMITIVES {
        return Err(CompileError::TooManyPrimitives(count));
    }

    let start = Instant::now();
    let instances =
        Instances::new((groups, &description.instances), &named, quality, first, &mut references)?;
    let bvh_time = start.elapsed();

    let bounds = references.iter().fold(Aabb::EMPTY, |bounds, reference| bounds.union(reference.aabb()));
    let extent = (bounds.max - bounds.min).max(Vec3::ZERO);
    let light_choice = lights::choice(&lights, 0.5 * extent.length());

    let start = Instant::now();
    let mut bvh = Bvh::build_with(references, quality);
    let primitives = Primitives::new(bvh.take_slots(), instances, &surfaces);
    let bvh_time = bvh_time + start.elapsed();

    let upper = size_of_val(bvh.nodes()) as u64;
    let mut summary = Summary {
        triangles: surfaces.triangles.len() as u64 - Degenerate::total(&degenerate),
        quadrics: surfaces.quadrics(),
        degenerate: Degenerate::total(&degenerate),
        materials: materials.len() as u32,
        lights: lights.len() as u32,
        bvh_nodes: bvh.nodes().len() as u64,
        bvh_bytes: upper + primitives.bytes() as u64,
        bvh_time,
        quality,
        ..Summary::default()
    };
    degenerate.extend(primitives.instances.degenerate());
    primitives.instances.add_to(&mut summary, upper as f64 / count.max(1) as f64);
    let environments = (0..lights.len()).filter(|&i| lights[i].is_environment());
    let environments = environments.map(|i| LightId(i as u32)).collect();
    let sight = Sight::new(&lights);
    Ok(Scene {
        primitives,
        bvh,
        surfaces,
        materials,
        textures,
        lights,
        light_choice,
        environments,
        sight,
        extent,
        metered,
        camera: camera(&description.sensor),
        filter: filter::compile(description.sensor.film.filter),
        film: description.sensor.film,
        sampler: description.sensor.sampler,
        integrator: description.integrator.clone(),
        aovs: description.aovs.clone(),
        shows_uv: shows_uv(description),
        summary,
        degenerate,
    })
}

/// Are texture coordinates to be seen in a layer?
fn shows_uv(description: &SceneDescription) -> bool {
    let shown = |layers: &[AovChannel]| layers.iter().any(|layer| layer.kind == Aov::Uv);
    let instead = match &description.integrator {
        Integrator::Aov { channels } => shown(channels),
        _ => false,
    };
    instead || shown(&description.aovs)
}

fn camera(sensor: &Sensor) -> Camera {
    let size = (sensor.film.width, sensor.film.height);
    let clip = (sensor.near_clip, sensor.far_clip);
    match sensor.projection {
        Projection::Perspective { x_fov } => {
            Camera::perspective(sensor.to_world, libm::tan(x_fov / 2.0), size, clip)
        }
        Projection::ThinLens { x_fov, aperture_radius, focus_distance } => {
            let lens = (aperture_radius, focus_distance);
            Camera::thin_lens(sensor.to_world, libm::tan(x_fov / 2.0), size, clip, lens)
        }
        // A meter has no camera; whoever asks for its rays gets some.
        Projection::Orthographic | Projection::IrradianceMeter { .. } => {
            Camera::orthographic(sensor.to_world, size, clip)
        }
    }
}

/// References for the tree: a box, an index and a class for each primitive that can be hit.
type References = Vec<Reference>;
