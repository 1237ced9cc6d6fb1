//! How much memory a description will need, before it is taken: counts times sizes.

use super::{
    surfaces::{CanonicalRow, ShapeRow, SphereRow},
    vertices::{Mapped, Vertex},
};
use crate::bvh::Quality;
use crate::geometry::{Canonical, Placement, Triangle};
use crate::picture::Picture;
use crate::scene::{Geometry, Instance, Mesh, SceneDescription, Shape};

/// Bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// The description: meshes, shapes and instances.
    pub meshes: u64,
    /// What the system has back of that before the tree is built, if the description is given away
    /// ([`compile_owned`](super::compile_owned)): large pieces; the allocator keeps others for what comes next.
    pub returned: u64,
    /// Pictures and tables of the description, and the texels that are made of them.
    pub textures: u64,
    /// What shading reads of surfaces.
    pub columns: u64,
    /// What tracing reads: nodes, primitives in leaf order, instances.
    pub tree: u64,
    /// What is taken beyond that while a tree is built, and given back.
    pub building: u64,
}

/// Slots of a block that stay empty, and nodes, are so much of a tree for each triangle: between 24 bytes (a
/// terrain) and 39 (a soup) were counted at a million triangles.
const NODES_PER_PRIMITIVE: u64 = 32;
/// Three vertices in their block, and a number.
const TRIANGLE_SLOT: u64 = 40;
/// Centre, radius, number.
const SPHERE_SLOT: u64 = 20;

/// What a file says of an instance, kept so that a warning can show it: 115 bytes were counted for one that is moved.
const TEXT: u64 = 115;
/// What the allocator keeps of the elements that an instance was read from, counted with twenty thousand of them.
const READING: u64 = 450;

/// What a shape adds.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    shapes: u64,
    triangles: u64,
    /// Vertices without texture coordinates.
    vertices: u64,
    /// Vertices with texture coordinates.
    mapped: u64,
    /// Triangles that shine: they are kept a second time.
    kept: u64,
    spheres: u64,
    canonicals: u64,
    instances: u64,
}

impl Counts {
    fn of(shapes: &[Shape]) -> Self {
        let mut counts = Self { shapes: shapes.len() as u64, ..Self::default() };
        for shape in shapes {
            let (triangles, vertices, mapped) = match &shape.geometry {
                Geometry::Mesh { mesh, .. } => {
                    let (triangles, vertices) = (mesh.triangles.len() as u64, mesh.positions.len() as u64);
                    if mesh.uvs.is_empty() { (triangles, vertices, 0) } else { (triangles, 0, vertices) }
                }
                Geometry::Cube => (12, 0, 24),
                Geometry::Rectangle => (2, 0, 4),
                Geometry::Sphere { .. } => {
                    counts.spheres += 1;
                    continue;
                }
                Geometry::Disk | Geometry::Cylinder { .. } => {
                    counts.canonicals += 1;
                    continue;
                }
            };
            counts.triangles += triangles;
            counts.vertices += vertices;
            counts.mapped += mapped;
            counts.kept += if shape.radiance.is_some() { triangles } else { 0 };
        }
        counts
    }

    fn primitives(&self) -> u64 {
        self.triangles + self.spheres + self.canonicals + self.instances
    }

    fn columns(&self) -> u64 {
        let normal_and_sum = 16;
        self.primitives() * 4
            + self.shapes * size_of::<ShapeRow>() as u64
            + self.triangles * size_of::<[u32; 3]>() as u64
            + self.vertices * size_of::<Vertex>() as u64
            + self.mapped * size_of::<Mapped>() as u64
            + self.kept * (size_of::<Triangle>() as u64 + normal_and_sum)
            + self.spheres * size_of::<SphereRow>() as u64
            + self.canonicals * size_of::<CanonicalRow>() as u64
    }

    fn tree(&self) -> u64 {
        self.primitives() * NODES_PER_PRIMITIVE
            + self.triangles * TRIANGLE_SLOT
            + self.spheres * SPHERE_SLOT
            + self.canonicals * size_of::<Option<(Canonical, u32)>>() as u64
            + self.instances * (size_of::<Placement>() as u64 + 8)
    }

    /// References and the binary tree, less what takes their place. With the tree, 72 (a terrain) to 97 bytes (a soup) a
    /// triangle were counted at a million, 150 to 234 at high quality.
    fn building(&self, quality: Quality) -> u64 {
        let beyond = match quality {
            Quality::Fast | Quality::Medium => 20,
            Quality::High => 135,
        };
        self.primitives() * beyond
    }
}

/// What compiling a description will take.
pub fn needs(description: &SceneDescription, quality: Quality) -> Needs {
    let resources = description.resources();
    let upper = Counts { instances: description.instances.len() as u64, ..Counts::of(&description.shapes) };
    let groups: Vec<Counts> = description.groups.iter().map(|group| Counts::of(&group.shapes)).collect();
    let all = || groups.iter().chain([&upper]);
    let shapes: u64 = all().map(|counts| counts.shapes).sum();
    let texels = |picture: &&Picture| u64::from(picture.width) * u64::from(picture.height) * 12;
    let sky_sums = resources.environments.iter().map(texels).sum::<u64>() / 3;
    let pictures = || resources.textures.iter().chain(&resources.environments);
    Needs {
        returned: resources.meshes.iter().copied().map(returned).sum(),
        meshes: resources.meshes.iter().copied().map(mesh_bytes).sum::<u64>()
            + shapes * size_of::<Shape>() as u64
            + description.instances.len() as u64 * (size_of::<Instance>() as u64 + TEXT + READING),
        textures: pictures().map(|picture| picture_bytes(picture)).sum::<u64>()
            + pictures().map(texels).sum::<u64>()
            + sky_sums
            + resources.tables.iter().map(|table| table.bytes()).sum::<u64>(),
        columns: all().map(Counts::columns).sum::<u64>(),
        tree: all().map(Counts::tree).sum(),
        building: all().map(|counts| counts.building(quality)).max().unwrap_or(0),
    }
}

fn mesh_bytes(mesh: &Mesh) -> u64 {
    let Mesh { positions, normals, uvs, triangles, attributes } = mesh;
    // Values of attributes become textures, by way of a copy of the corners.
    let values: usize = attributes.iter().map(|attribute| 2 * size_of_val(attribute.values.as_slice())).sum();
    let corners = if attributes.is_empty() { 1 } else { 2 };
    let bytes = size_of_val(positions.as_slice())
        + size_of_val(normals.as_slice())
        + size_of_val(uvs.as_slice())
        + corners * size_of_val(triangles.as_slice())
        + values;
    bytes as u64
}

/// Allocators have pieces that are at least so large from the system, one by one.
const LARGE: u64 = 32 << 20;

fn returned(mesh: &Mesh) -> u64 {
    let Mesh { positions, normals, uvs, triangles, .. } = mesh;
    let pieces = [
        size_of_val(positions.as_slice()),
        size_of_val(normals.as_slice()),
        size_of_val(uvs.as_slice()),
        size_of_val(triangles.as_slice()),
    ];
    pieces.into_iter().map(|piece| piece as u64).filter(|&piece| piece >= LARGE).sum()
}

fn picture_bytes(picture: &Picture) -> u64 {
    picture.channels.iter().map(|channel| size_of_val(channel.samples.as_slice()) as u64).sum()
}
