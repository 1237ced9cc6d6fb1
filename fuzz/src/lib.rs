//! What the fuzz targets have in common: bytes become a file, and whatever the file holds, it is used or
//! refused by name.

use std::{cell::RefCell, fs, path::Path};

use packlight::{
    compile::compile,
    load::{LoadOptions, load},
    render::{Settings, render},
    scene::{Film, Integrator, SceneDescription},
};
use tempfile::TempDir;

thread_local! {
    static FOLDER: RefCell<Option<TempDir>> = const { RefCell::new(None) };
}

/// Hands out the path of a file with this content, in a folder with nothing else in it.
///
/// # Panics
/// If the file can't be written.
pub fn with_file(name: &str, bytes: &[u8], read: impl FnOnce(&Path)) {
    FOLDER.with_borrow_mut(|folder| {
        let folder = folder.get_or_insert_with(|| TempDir::new().expect("a folder"));
        let path = folder.path().join(name);
        fs::write(&path, bytes).expect("writable");
        read(&path);
    });
}

/// Loads, compiles and renders: four pixels by four, one sample of each.
///
/// # Panics
/// If the file is refused without its name.
pub fn show(path: &Path) {
    let mut description = match load(path, &LoadOptions::default()) {
        Ok(loaded) => loaded.description,
        Err(error) => {
            let (words, name) = (error.to_string(), path.file_name().expect("a name").to_string_lossy());
            assert!(words.contains(&*name), "refused without its name: {words}");
            return;
        }
    };
    if is_long_work(&description) {
        return;
    }
    let film = Film::new(4, 4);
    description.sensor.film = Film { filter: description.sensor.film.filter, ..film };
    description.sensor.sampler.sample_count = 1;
    match &mut description.integrator {
        Integrator::Path { max_depth, .. } | Integrator::Irradiance { max_depth, .. } => {
            *max_depth = Some(max_depth.unwrap_or(8).min(8));
        }
        Integrator::Whitted { max_depth } => *max_depth = (*max_depth).min(5),
        Integrator::Direct { .. } | Integrator::AmbientOcclusion { .. } | Integrator::Aov { .. } => {}
    }
    if let Ok(scene) = compile(&description) {
        let picture = render(&scene, &Settings::default(), &|_| {}).picture;
        let samples = picture.channels.iter().flat_map(|channel| &channel.samples);
        assert!(samples.copied().all(f32::is_finite), "a film holds what is not finite");
    }
}

/// What a file may ask for, and nobody wants to wait for a million times.
fn is_long_work(description: &SceneDescription) -> bool {
    description.aovs.len() > 100 || description.shapes.len() > 1000 || description.instances.len() > 1000
}
