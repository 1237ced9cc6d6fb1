//! Things that can be hit.

use std::{fmt, sync::Arc};

use glam::{DAffine3, DVec3, Vec2, Vec3};

use super::{MaterialIndex, Rgb};
use crate::math::Digest;

/// A surface in the world.
#[derive(Clone, Debug)]
pub struct Shape {
    /// For messages: the `id` of the element, or the name of the file or group.
    pub name: String,
    /// In local space.
    pub geometry: Geometry,
    /// Local to world.
    pub to_world: DAffine3,
    /// Turns the normals round, and with them the side that is shaded and the side that emits.
    pub flip_normals: bool,
    /// How it reflects.
    pub material: MaterialIndex,
    /// Radiance emitted on the side of the normal, the same in all directions, W/(m² sr).
    pub radiance: Option<Rgb>,
}

/// Shapes in a space of their own, which are hit where instances place them.
#[derive(Clone, Debug, Default)]
pub struct ShapeGroup {
    /// For messages: the `id` of the element.
    pub name: String,
    /// The group's space is what they call the world. None of them shines.
    pub shapes: Vec<Shape>,
}

/// Place of a [`ShapeGroup`] in [`SceneDescription::groups`](super::SceneDescription::groups).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct GroupIndex(pub u32);

/// A group in the world.
#[derive(Clone, Copy, Debug)]
pub struct Instance {
    /// What stands there.
    pub group: GroupIndex,
    /// Group to world, any affine map that has an inverse. A map that mirrors leaves outward normals outward.
    pub to_world: DAffine3,
}

/// Local-space geometry, its normal and its texture coordinates.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// Outward normal; axis z: u = atan2(y, x)/2π in [0, 1), v = acos(z)/π. `to_world` must be a
    /// similarity (no non-uniform scale).
    Sphere {
        /// Local space.
        center: DVec3,
        /// Local space, positive.
        radius: f64,
    },
    /// [-1, 1]² in the xy plane, normal +z, uv = ((x+1)/2, (y+1)/2).
    Rectangle,
    /// Unit disc in the xy plane, normal +z, u = radius, v = angle/2π.
    Disk,
    /// No caps, normal outward; u = angle/2π, v runs along the axis from `p0`.
    Cylinder {
        /// Local space.
        p0: DVec3,
        /// Local space, not `p0`.
        p1: DVec3,
        /// Local space, positive.
        radius: f64,
    },
    /// [-1, 1]³, flat outward normals, each face [0, 1]² in uv.
    Cube,
    /// Triangles.
    Mesh {
        /// Shared by all shapes that place the same file.
        mesh: Arc<Mesh>,
        /// Geometric normals are shaded, whatever normals the mesh has.
        face_normals: bool,
    },
}

/// Indexed triangles in local space. Every index is in range; every coordinate is finite.
#[derive(Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions, in local space as all of the mesh.
    pub positions: Vec<Vec3>,
    /// Vertex normals, one a position, not necessarily of unit length; empty if the file has none:
    /// then smooth normals are computed, weighted by the corner's angle.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one a position; empty if the file has none: then the barycentric
    /// coordinates (b1, b2) of each triangle stand in.
    pub uvs: Vec<Vec2>,
    /// Corners, counter-clockwise from the side of the normal.
    pub triangles: Vec<[u32; 3]>,
    /// What textures may be made of; names differ.
    pub attributes: Vec<Attribute>,
}

/// Values on a mesh.
#[derive(Clone, PartialEq)]
pub struct Attribute {
    /// `vertex_…` or `face_…`.
    pub name: String,
    /// What has a value.
    pub per: Per,
    /// As the file has them, without a unit; finite. A single number is grey.
    pub values: Vec<Rgb>,
}

/// What the values of an [`Attribute`] belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// One a position, linear between them.
    Vertex,
    /// One a triangle.
    Face,
}

/// A digest of the values.
impl fmt::Debug for Attribute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, per, values } = self;
        let digest = Digest::default().floats(values.iter().flat_map(Vec3::to_array));
        f.debug_struct("Attribute")
            .field("name", name)
            .field("per", per)
            .field("values", &values.len())
            .field("digest", &digest.value())
            .finish()
    }
}

/// Sizes, and a digest of the numbers, of which there may be millions.
impl fmt::Debug for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { positions, normals, uvs, triangles, attributes } = self;
        let vectors = positions.iter().chain(normals).flat_map(Vec3::to_array);
        let mut digest = Digest::default().floats(vectors).floats(uvs.iter().flat_map(Vec2::to_array));
        triangles.iter().flatten().for_each(|&index| digest.word(index));
        f.debug_struct("Mesh")
            .field("positions", &positions.len())
            .field("normals", &normals.len())
            .field("uvs", &uvs.len())
            .field("triangles", &triangles.len())
            .field("digest", &digest.value())
            .field("attributes", attributes)
            .finish()
    }
}
