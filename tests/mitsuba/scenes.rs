//! Every scene loads and renders as it is; what is refused is refused by name.

use std::{
    fs,
    path::{Path, PathBuf},
};

use packlight::{
    compile::compile,
    load::{LoadOptions, load},
    render::{Settings, render},
    scene::{Film, SceneDescription},
};

use super::shared;

const FOLDERS: [&str; 8] = [
    "references/scenes",
    "scenes/mitsuba/cbox",
    "scenes/mitsuba/living-room",
    "scenes/mitsuba/matpreview",
    "scenes/mitsuba/scans",
    "scenes/mitsuba/reference/tests/scenes/bsdf_spheres",
    "scenes/mitsuba/reference/tests/scenes/floating_sphere",
    "scenes/mitsuba/reference/tests/scenes/instancing",
];

/// Scenes that are refused, and why: where, and what it is that is not there yet.
const REFUSED: &[(&str, &str)] = &[];

/// All `.xml` of a folder, by name.
pub(super) fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder of scenes can be read");
    let paths = entries.map(|entry| entry.expect("a folder of scenes can be read").path());
    let mut files: Vec<_> = paths.filter(|path| path.extension().is_some_and(|e| e == "xml")).collect();
    files.sort();
    files
}

/// Why a scene is refused, if it should be.
pub(super) fn refusal(path: &Path) -> Option<&'static str> {
    let path = path.to_str().expect("paths of scenes are text");
    REFUSED.iter().find(|(name, _)| path.ends_with(name)).map(|&(_, why)| why)
}

/// Small, with four samples a pixel, and otherwise unchanged.
fn glance(mut description: SceneDescription) -> SceneDescription {
    description.sensor.film = Film { width: 32, height: 32, crop: None, ..description.sensor.film };
    description.sensor.sampler.sample_count = 4;
    description
}

fn renders(path: &Path) -> Result<(), String> {
    let loaded = load(path, &LoadOptions::default()).map_err(|error| error.to_string())?;
    let scene = compile(&glance(loaded.description)).map_err(|error| error.to_string())?;
    let rendered = render(&scene, &Settings::default(), &|_| {});
    let invalid = rendered.statistics.invalid_samples;
    if invalid > 0 {
        return Err(format!("{invalid} samples are not finite"));
    }
    let seen = rendered.picture.channels.iter().flat_map(|channel| &channel.samples).any(|&x| x != 0.0);
    if seen { Ok(()) } else { Err("nothing is to be seen".into()) }
}

#[test]
fn every_scene_renders_or_is_refused_by_name() {
    let Some(shared) = shared("") else { return };
    let mut wrong = Vec::new();
    let mut rendered = 0;
    for path in FOLDERS.iter().flat_map(|folder| files(&shared.join(folder))) {
        let place = path.display();
        match (renders(&path), refusal(&path)) {
            (Ok(()), None) => rendered += 1,
            (Err(why), Some(expected)) if why.ends_with(expected) => println!("refused: {why}"),
            (Err(why), _) => wrong.push(format!("{place}: {why}")),
            (Ok(()), Some(_)) => {
                wrong.push(format!("{place} is not refused any more: take it off the list of this test"));
            }
        }
    }
    println!("{rendered} scenes render as they are");
    assert!(wrong.is_empty(), "\n{}\n", wrong.join("\n"));
    assert!(rendered >= 41, "only {rendered} scenes were found");
}
