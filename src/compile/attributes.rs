//! Meshes with attributes, numbered so that a texture finds the values of the one that was hit.

use std::{collections::HashMap, sync::Arc};

use crate::scene::{Geometry, Mesh, Per, Shape};
use crate::texture::{Column, MeshAttribute};

/// The number of a surface that is no mesh with attributes.
pub(super) const NONE: u32 = u32::MAX;

/// A mesh, and its corners for all textures that are made of it.
struct Attributed {
    mesh: Arc<Mesh>,
    corners: Arc<[[u32; 3]]>,
}

/// Each mesh once, however many shapes place it.
#[derive(Default)]
pub(super) struct AttributedMeshes {
    meshes: Vec<Attributed>,
    pub(super) numbers: Numbers,
}

/// Meshes by where they are. A mesh may be given back meanwhile: as none is made, nobody else comes to be where it was.
#[derive(Default)]
pub(super) struct Numbers(HashMap<*const Mesh, u32>);

impl Numbers {
    /// Of a mesh, or [`NONE`].
    pub(super) fn of(&self, mesh: &Arc<Mesh>) -> u32 {
        self.0.get(&Arc::as_ptr(mesh)).copied().unwrap_or(NONE)
    }
}

impl AttributedMeshes {
    /// Those of shapes.
    pub(super) fn new<'a>(shapes: impl Iterator<Item = &'a Shape>) -> Self {
        let mut all = Self::default();
        for shape in shapes {
            if let Geometry::Mesh { mesh, .. } = &shape.geometry
                && !mesh.attributes.is_empty()
                && !all.numbers.0.contains_key(&Arc::as_ptr(mesh))
            {
                all.numbers.0.insert(Arc::as_ptr(mesh), all.meshes.len() as u32);
                let corners = mesh.triangles.as_slice().into();
                all.meshes.push(Attributed { mesh: Arc::clone(mesh), corners });
            }
        }
        all
    }

    /// The attribute of a name, times `scale`, of all meshes.
    pub(super) fn texture(&self, name: &str, scale: f32) -> MeshAttribute {
        let column = |Attributed { mesh, corners }: &Attributed| {
            let attribute = mesh.attributes.iter().find(|attribute| attribute.name == name)?;
            let values = attribute.values.iter().map(|value| scale * *value).collect();
            Some(match attribute.per {
                Per::Vertex => Column::Vertices { corners: Arc::clone(corners), values },
                Per::Face => Column::Faces(values),
            })
        };
        MeshAttribute { columns: self.meshes.iter().map(column).collect() }
    }
}
