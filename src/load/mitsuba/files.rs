//! Meshes and pictures: each file is read once.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::properties::Object;
use crate::{
    load::{LoadError, Warning, brdf, obj, ply},
    picture::{self, Encoding, Picture},
    scene::{MerlTable, Mesh},
};

/// What has been read so far.
#[derive(Default)]
pub(super) struct Files {
    /// By path and whether v is flipped.
    meshes: HashMap<(PathBuf, bool), Arc<Mesh>>,
    /// By path and whether the numbers are raw.
    pictures: HashMap<(PathBuf, bool), Arc<Picture>>,
    tables: HashMap<PathBuf, Arc<MerlTable>>,
    pub(super) warnings: Vec<Warning>,
}

impl Files {
    /// The mesh that the `filename` of an `obj` or `ply` shape names.
    pub(super) fn mesh(&mut self, shape: Object) -> Result<Arc<Mesh>, LoadError> {
        let is_obj = shape.plugin() == "obj";
        let read = if is_obj { obj::read_mesh } else { ply::read_mesh };
        let path = existing_file(shape)?;
        let flip = shape.boolean("flip_tex_coords", is_obj)?;
        let key = (path, flip);
        if let Some(mesh) = self.meshes.get(&key) {
            return Ok(Arc::clone(mesh));
        }
        let mut mesh = read(&key.0, &mut self.warnings)?;
        if flip {
            for uv in &mut mesh.uvs {
                uv.y = 1.0 - uv.y;
            }
        }
        let mesh = Arc::new(mesh);
        self.meshes.insert(key, Arc::clone(&mesh));
        Ok(mesh)
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
    let path = object.span("filename").resolve(name);
    match path.is_file() {
        true => Ok(path),
        false => Err(object
            .error_at("filename", format!("there is no file `{name}`"))
            .label("not found")
            .help(format!(
                "looked for {}; names are relative to the XML file's folder",
                absolute(&path).display()
            ))),
    }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}
