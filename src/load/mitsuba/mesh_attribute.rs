//! Textures made of what meshes say of their vertices and faces.

use super::{
    files::Files,
    properties::Object,
    texture::Range,
    vocabulary::{Class, did_you_mean},
};
use crate::{
    load::LoadError,
    scene::{Attribute, Geometry, Texture},
};

pub(super) const PLUGIN: &str = "mesh_attribute";

/// The texture. Its values are those of meshes that are not known yet: [`check`] looks at them.
pub(super) fn build(object: Object, range: Range, files: &mut Files) -> Result<Texture, LoadError> {
    let name = object
        .string("name")?
        .ok_or_else(|| object.missing("name", "<string name=\"name\" value=\"vertex_color\"/>"))?;
    if !name.starts_with("vertex_") && !name.starts_with("face_") {
        return Err(object
            .error_at("name", format!("`{name}` is no name of an attribute"))
            .help("attributes are called `vertex_…` or `face_…`"));
    }
    let strictest = files.ranges.entry(object.index).or_insert(range);
    if range == Range::Unit {
        *strictest = range;
    }
    Ok(Texture::MeshAttribute { name: name.to_owned(), scale: scale(object)? })
}

fn scale(object: Object) -> Result<f32, LoadError> {
    Ok(object.float("scale")?.unwrap_or(1.0) as f32)
}

/// Has a shape the attributes that the textures of its BSDF ask for, with values that may stand there?
///
/// # Errors
/// If it has not.
pub(super) fn check(shape: Object, geometry: &Geometry, files: &Files) -> Result<(), LoadError> {
    if files.ranges.is_empty() {
        return Ok(());
    }
    let there: &[Attribute] = match geometry {
        Geometry::Mesh { mesh, .. } => &mesh.attributes,
        _ => &[],
    };
    for texture in textures(shape) {
        let name = texture.string("name")?.unwrap_or_default();
        let Some(attribute) = there.iter().find(|attribute| attribute.name == name) else {
            let what = format!("the {} `{}`", shape.class(), shape.plugin());
            let known = there.iter().map(|attribute| attribute.name.as_str());
            let help = match there.is_empty() {
                true => "the vertices or faces of a `ply` may have some".into(),
                false => did_you_mean(name, known, "its attributes"),
            };
            let error = texture.error_at("name", format!("{what} has no attribute `{name}`"));
            return Err(error.help(help));
        };
        let scale = scale(texture)?;
        let mut values = attribute.values.iter().flat_map(|value| (scale * *value).to_array());
        let range = files.ranges.get(&texture.index).copied().unwrap_or(Range::Coefficient);
        if let Some(worst) = range.outside(&mut values) {
            return Err(texture
                .error_at("name", format!("`{name}` has the value {worst}, which is out of range"))
                .help(format!(
                    "{}; `scale` is a factor on all values, 0.003921569 for bytes",
                    range.help()
                )));
        }
    }
    Ok(())
}

/// The attributes that are named anywhere in the BSDF of a shape.
fn textures(shape: Object) -> Vec<Object> {
    let mut open = shape.children(Class::Bsdf);
    let mut found = Vec::new();
    while let Some(object) = open.pop() {
        open.extend(object.children(Class::Bsdf));
        open.extend(object.children(Class::Texture));
        if object.plugin() == PLUGIN {
            found.push(object);
        }
    }
    found
}
