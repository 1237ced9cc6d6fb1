//! Every scene of `scenes/`: each class of its rays, eight at a time and one.

use std::{
    fs,
    path::{Path, PathBuf},
};

use packlight::{
    compile::compile,
    load::{LoadOptions, load},
    render::ray_classes,
};

use crate::{
    options::Extent,
    row::Table,
    run::{Run, pool},
    traced::trace,
};

/// Measures every scene that is wanted.
pub(crate) fn measure(run: &mut Run) -> Result<(), String> {
    for path in files()? {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if run.options.wants(Table::Scenes, &name) {
            println!("scenes  {name}");
            scene(run, &name, &path)?;
        }
    }
    Ok(())
}

fn files() -> Result<Vec<PathBuf>, String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let entries = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "xml"));
    files.sort();
    Ok(files)
}

fn scene(run: &mut Run, name: &str, path: &Path) -> Result<(), String> {
    let mut description = load(path, &LoadOptions::default()).map_err(|error| error.to_string())?.description;
    if run.extent == Extent::Smoke {
        description.sensor.film = run.extent.film();
    }
    let scene = compile(&description).map_err(|error| format!("{name}: {error}"))?;
    let classes = pool(0)?.install(|| ray_classes(&scene));
    for class in classes.iter().filter(|class| run.options.wants_class(class.name)) {
        let mut row = run.row(1, Table::Scenes, name, class.name);
        trace(&scene, class, run.extent.repeat(), &mut row)?;
        run.book.take(row)?;
    }
    Ok(())
}
