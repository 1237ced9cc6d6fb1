//! Meshes and pictures: each file is read once.

use std::{collections::HashMap, fs, path::PathBuf, sync::Arc};

use super::{properties::Object, texture::Range};
use crate::{
    load::{LoadError, Warning, brdf, obj, ply, serialized},
    picture::{self, Encoding, Picture},
    scene::{MerlTable, Mesh},
};

/// What has been read so far.
#[derive(Default)]
pub(super) struct Files {
    meshes: HashMap<MeshKey, Placed>,
    /// By path and whether the numbers are raw.
    pictures: HashMap<(PathBuf, bool), Arc<Picture>>,
    tables: HashMap<PathBuf, Arc<MerlTable>>,
    /// Are meshes read with what textures may be made of?
    pub(super) attributed: bool,
    /// What the values of a `mesh_attribute` may be, by its place in the document.
    pub(super) ranges: HashMap<usize, Range>,
    pub(super) warnings: Vec<Warning>,
}

/// What makes two shapes one mesh.
#[derive(Clone, PartialEq, Eq, Hash)]
struct MeshKey {
    path: PathBuf,
    /// v is turned round.
    flip: bool,
    /// Which mesh of the file.
    index: u32,
}

/// A mesh, and whether its file asks for it to be shaded flat.
#[derive(Clone)]
pub(super) struct Placed {
    pub(super) mesh: Arc<Mesh>,
    pub(super) face_normals: bool,
}

impl Files {
    /// The mesh that the `filename` of an `obj`, `ply` or `serialized` shape names.
    pub(super) fn mesh(&mut self, shape: Object) -> Result<Placed, LoadError> {
        let path = existing_file(shape)?;
        let key = match shape.plugin() {
            "serialized" => {
                let index = shape.count("shape_index", 0, 0, i32::MAX as u32)?;
                MeshKey { path, flip: false, index }
            }
            plugin => {
                let flip = shape.boolean("flip_tex_coords", plugin == "obj")?;
                MeshKey { path, flip, index: 0 }
            }
        };
        if let Some(placed) = self.meshes.get(&key) {
            return Ok(placed.clone());
        }
        let (mut mesh, face_normals) = match shape.plugin() {
            "obj" => (obj::read_mesh(&key.path, &mut self.warnings)?, false),
            "ply" if self.attributed => (ply::read_attributed_mesh(&key.path, &mut self.warnings)?, false),
            "ply" => (ply::read_mesh(&key.path, &mut self.warnings)?, false),
            _ => {
                let read = serialized::read_mesh(&key.path, key.index)?;
                (read.mesh, read.face_normals)
            }
        };
        if key.flip {
            for uv in &mut mesh.uvs {
                uv.y = 1.0 - uv.y;
            }
        }
        let placed = Placed { mesh: Arc::new(mesh), face_normals };
        self.meshes.insert(key, placed.clone());
        Ok(placed)
    }

    /// The measured table that the `filename` of a `merl` names: MERL's own, or scattered measurements in a
    /// `.brdf`.
    pub(super) fn table(&mut self, bsdf: Object) -> Result<Arc<MerlTable>, LoadError> {
        let path = existing_file(bsdf)?;
        if let Some(table) = self.tables.get(&path) {
            return Ok(Arc::clone(table));
        }
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("brdf")) {
            let table = Arc::new(brdf::read(&path)?);
            self.tables.insert(path, Arc::clone(&table));
            return Ok(table);
        }
        let refusal = |why: String| bsdf.error_at("filename", format!("the table can't be used: {why}"));
        let bytes = fs::read(&path).map_err(|error| refusal(error.to_string()))?;
        let table = Arc::new(MerlTable::decode(&bytes).map_err(|error| refusal(error.to_string()))?);
        self.tables.insert(path, Arc::clone(&table));
        Ok(table)
    }

    /// The picture that the `filename` of a `bitmap` names.
    pub(super) fn picture(&mut self, bitmap: Object, raw: bool) -> Result<Arc<Picture>, LoadError> {
        let key = (existing_file(bitmap)?, raw);
        if let Some(picture) = self.pictures.get(&key) {
            return Ok(Arc::clone(picture));
        }
        let encoding = if raw { Encoding::Raw } else { Encoding::Srgb };
        let picture = picture::decode(&key.0, encoding)
            .map_err(|e| bitmap.error_at("filename", format!("the picture can't be used: {e}")))?;
        let picture = Arc::new(picture);
        self.pictures.insert(key, Arc::clone(&picture));
        Ok(picture)
    }
}

/// The file that the `filename` of an object names.
pub(super) fn existing_file(object: Object) -> Result<PathBuf, LoadError> {
    let name = object
        .string("filename")?
        .ok_or_else(|| object.missing("filename", "<string name=\"filename\" value=\"…\"/>"))?;
    object.folders().file(object.span("filename"), name)
}
