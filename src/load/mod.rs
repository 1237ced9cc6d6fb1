//! Files to a [`SceneDescription`]: the door at which bad numbers stop.

mod bare;
mod brdf;
mod cie;
mod error;
pub mod generate;
mod mitsuba;
mod mtl;
mod obj;
mod obj_materials;
mod obj_text;
mod origin;
mod ply;
mod serialized;
pub mod sh;
mod spectrum;
mod text;
mod unreadable;

use std::path::Path;

pub use error::{LoadError, Warning};
pub use origin::{Origin, Origins};

use crate::scene::{Material, Mesh, SceneDescription};

/// What the command line may say about a file.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// `-D name=value`: values of `$name`, stronger than `<default>`.
    pub defines: Vec<(String, String)>,
    /// Which of the scene's sensors, counted from 0 in the order in which they stand; the first if not said.
    pub sensor: Option<usize>,
}

/// A loaded scene, and what was legal but probably wrong in its files.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    /// The scene.
    pub description: SceneDescription,
    /// In the order found.
    pub warnings: Vec<Warning>,
    /// Where the scene's shapes are described.
    pub origins: Origins,
}

/// Loads a scene file (`.xml`), a bare mesh (`.obj`, `.ply`) or one made on the spot (`gen:`, see
/// [`generate`]).
///
/// # Errors
/// [`LoadError`] with file, line, column and the way out.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Loaded, LoadError> {
    let mut warnings = Vec::new();
    let kind = Kind::of(path);
    if let (Kind::Mesh | Kind::Generated(_), Some(sensor @ 1..)) = (&kind, options.sensor) {
        return Err(LoadError::new(path, format!("there is no sensor {sensor}: a bare mesh is given one")));
    }
    let description = match kind {
        Kind::Mitsuba => return mitsuba::read_scene(path, options),
        Kind::Mesh => bare::describe(path, &mut warnings)?,
        Kind::Generated(spec) => bare::describe_mesh(spec.into(), generate::mesh(spec)?),
        Kind::Other(extension) => return Err(unknown(path, &extension)),
    };
    let origins = Origins::of_file(path, description.shapes.len());
    Ok(Loaded { description, warnings, origins })
}

/// Reads a material written on a line, `plugin:name=value,…`, as in
/// `roughconductor:alpha=0.3,material=Au`; a colour is three numbers with blanks between them.
///
/// # Errors
/// [`LoadError`] with the column in the line.
pub fn read_material(line: &str) -> Result<(Material, Vec<Warning>), LoadError> {
    mitsuba::read_line(line)
}

/// Loads the material that has an id in a scene file, or that of the shape that has it.
///
/// # Errors
/// [`LoadError`] as for [`load`], and if the id is not there.
pub fn load_material(
    path: &Path,
    id: &str,
    options: &LoadOptions,
) -> Result<(Material, Vec<Warning>), LoadError> {
    match Kind::of(path) {
        Kind::Mitsuba => mitsuba::read_by_id(path, &options.defines, id),
        Kind::Other(extension) => Err(unknown(path, &extension)),
        Kind::Mesh | Kind::Generated(_) => {
            Err(LoadError::new(path, "a bare mesh has no ids").help("name a scene in Mitsuba 3 `.xml`"))
        }
    }
}

/// Loads all triangles of a mesh, `.obj`, `.ply` or `gen:`, as one; materials are ignored.
///
/// # Errors
/// [`LoadError`] as for [`load`].
pub fn load_mesh(path: &Path) -> Result<(Mesh, Vec<Warning>), LoadError> {
    let mut warnings = Vec::new();
    let mesh = match Kind::of(path) {
        Kind::Mesh if is_obj(path) => obj::read_mesh(path, &mut warnings)?,
        Kind::Mesh => ply::read_mesh(path, &mut warnings)?,
        Kind::Generated(spec) => generate::mesh(spec)?,
        Kind::Mitsuba => {
            return Err(
                LoadError::new(path, "a scene is not a mesh").help("meshes are `.obj`, `.ply` or `gen:`")
            );
        }
        Kind::Other(extension) => return Err(unknown(path, &extension)),
    };
    Ok((mesh, warnings))
}

/// What a path names.
enum Kind<'a> {
    Mitsuba,
    Mesh,
    /// What follows `gen:`.
    Generated(&'a str),
    Other(String),
}

impl<'a> Kind<'a> {
    fn of(path: &'a Path) -> Self {
        if let Some(spec) = path.to_str().and_then(|path| path.strip_prefix(generate::PREFIX)) {
            return Self::Generated(spec);
        }
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match extension.as_str() {
            "xml" => Self::Mitsuba,
            "obj" | "ply" => Self::Mesh,
            _ => Self::Other(extension),
        }
    }
}

fn is_obj(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj"))
}

fn unknown(path: &Path, extension: &str) -> LoadError {
    if extension.is_empty() {
        let meant = ["xml", "obj", "ply"].map(|extension| path.with_extension(extension));
        let error = LoadError::new(path, "a name without an extension does not say what the file is");
        return match meant.iter().find(|path| path.is_file()) {
            Some(file) => error.help(format!("did you mean `{}`?", file.display())),
            None => error.help(KINDS),
        };
    }
    LoadError::new(path, format!("files of the kind `.{extension}` are not known")).help(KINDS)
}

/// What can be loaded.
const KINDS: &str =
    "scenes are Mitsuba 3 `.xml`; bare meshes are `.obj`, `.ply` or made on the spot: `gen:soup:100k`";
