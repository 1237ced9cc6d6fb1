//! BSDFs around BSDFs.

use super::{
    super::{
        files::Files,
        properties::Object,
        texture::{self, Range},
        vocabulary::Class,
    },
    build,
};
use crate::{
    load::LoadError,
    scene::{Filter, Material, Relief, Texture},
};

pub(super) fn two_sided(object: Object, files: &mut Files) -> Result<Material, LoadError> {
    let mut side = |nested: Object| {
        if nested.plugin() == "twosided" {
            return Err(nested.error("a `twosided` bsdf can't stand inside another"));
        }
        let material = build(nested, files)?;
        match material.transmits() {
            false => Ok(Box::new(material)),
            true => Err(nested
                .error(format!(
                    "`twosided` is for opaque bsdfs: a `{}` already has two sides",
                    nested.plugin()
                ))
                .help(format!("use the `{}` without `twosided`", nested.plugin()))),
        }
    };
    match object.children(Class::Bsdf)[..] {
        [front] => Ok(Material::TwoSided { front: side(front)?, back: None }),
        [front, back] => Ok(Material::TwoSided { front: side(front)?, back: Some(side(back)?) }),
        ref other => Err(object
            .error(format!("`twosided` takes one bsdf, or a second for the back, but has {}", other.len()))
            .help("write <bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf>")),
    }
}

pub(super) fn mask(object: Object, files: &mut Files) -> Result<Material, LoadError> {
    let opacity = texture::number(object, "opacity", 0.5, Range::Unit, files)?;
    Ok(Material::Mask { opacity, nested: nested(object, files)? })
}

pub(super) fn blend(object: Object, files: &mut Files) -> Result<Material, LoadError> {
    if !object.has("weight") {
        return Err(object.missing("weight", "<float name=\"weight\" value=\"0.5\"/>"));
    }
    let weight = texture::number(object, "weight", 0.5, Range::Unit, files)?;
    match object.children(Class::Bsdf)[..] {
        [first, second] => {
            let nested = Box::new([build(first, files)?, build(second, files)?]);
            Ok(Material::Blend { weight, nested })
        }
        ref other => Err(object
            .error(format!("`blendbsdf` takes two bsdfs, but has {}", other.len()))
            .help("the first is there at weight 0, the second at weight 1")),
    }
}

pub(super) fn bump_map(object: Object, files: &mut Files) -> Result<Material, LoadError> {
    let scale = object.float("scale")?.unwrap_or(1.0) as f32;
    let Some(map) = object.child(Class::Texture)? else {
        return Err(object.missing("a texture", "<texture type=\"bitmap\"> with the heights"));
    };
    let height = texture::build(map, Range::Coefficient, files)?;
    match height {
        Texture::Bitmap { filter: Filter::Bilinear, .. } => {}
        _ => {
            return Err(map
                .error("heights that jump have no slope")
                .help("a `bumpmap` takes a `bitmap` with the filter `bilinear`"));
        }
    }
    Ok(Material::BumpMap { height, scale, relief: relief(object)?, nested: nested(object, files)? })
}

pub(super) fn normal_map(object: Object, files: &mut Files) -> Result<Material, LoadError> {
    if !object.has("normalmap") {
        return Err(object.missing("normalmap", "<texture type=\"bitmap\" name=\"normalmap\">"));
    }
    let normals = texture::colour(object, "normalmap", 0.5, Range::Unit, files)?;
    if let Some(map) = object.children(Class::Texture).first()
        && map.plugin() == "bitmap"
        && !map.boolean("raw", false)?
    {
        let message = "the normals are read as colours: they need <boolean name=\"raw\" value=\"true\"/>";
        files.warnings.push(map.warning(message));
    }
    Ok(Material::NormalMap { normals, relief: relief(object)?, nested: nested(object, files)? })
}

fn relief(object: Object) -> Result<Relief, LoadError> {
    Ok(Relief {
        flips: object.boolean("flip_invalid_normals", true)?,
        shadows: object.boolean("use_shadowing_function", true)?,
    })
}

/// The one BSDF inside.
fn nested(object: Object, files: &mut Files) -> Result<Box<Material>, LoadError> {
    match object.child(Class::Bsdf)? {
        Some(nested) => Ok(Box::new(build(nested, files)?)),
        None => Err(object.missing("a bsdf", "<bsdf type=\"diffuse\"/> inside it")),
    }
}
