//! Scenes of one mesh.

use std::path::Path;

use packlight::{
    compile::{Scene, compile},
    load::{LoadOptions, load},
    scene::{Film, SceneDescription},
};

/// A mesh file or `gen:`, framed; `None` if the file is not there.
pub(crate) fn describe(path: &str) -> Option<SceneDescription> {
    if !path.starts_with("gen:") && !Path::new(path).exists() {
        return None;
    }
    let mut description = load(path.as_ref(), &LoadOptions::default()).ok()?.description;
    description.sensor.film = Film::new(256, 192);
    Some(description)
}

/// The same, compiled.
#[allow(dead_code)] // Not every bench compiles outside of its measurement.
pub(crate) fn scene(path: &str) -> Option<Scene> {
    compile(&describe(path)?).ok()
}
