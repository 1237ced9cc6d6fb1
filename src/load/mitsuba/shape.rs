//! Things that can be hit.

use std::path::Path;

use glam::{DAffine3, DVec3};

use super::{
    colour,
    files::{Files, Placed},
    properties::Object,
    transform,
    vocabulary::Class,
};
use crate::{
    load::LoadError,
    scene::{Geometry, MaterialIndex, Rgb, Shape},
};

/// A shape; `material` gives the place of its BSDF, or of the default one for emitters or others.
pub(super) fn build(
    object: Object,
    files: &mut Files,
    material: impl FnOnce(&mut Files, Option<Object>, bool) -> Result<MaterialIndex, LoadError>,
) -> Result<Shape, LoadError> {
    let to_world = object.to_world()?;
    let geometry = geometry(object, to_world, files)?;
    let radiance = object.child(Class::Emitter)?.map(area_radiance).transpose()?;
    let bsdf = object.child(Class::Bsdf)?;
    let flip_normals = object.boolean("flip_normals", false)?;
    object.finish()?;
    let material = material(files, bsdf, radiance.is_some())?;
    Ok(Shape { name: name(object)?, geometry, to_world, flip_normals, material, radiance })
}

fn name(object: Object) -> Result<String, LoadError> {
    let file = object.string("filename")?.and_then(|file| Path::new(file).file_name()?.to_str());
    Ok(object.id().or(file).unwrap_or(object.plugin()).to_owned())
}

fn geometry(object: Object, to_world: DAffine3, files: &mut Files) -> Result<Geometry, LoadError> {
    Ok(match object.plugin() {
        "sphere" => {
            if transform::similarity(to_world).is_none() {
                return Err(object
                    .error_at("to_world", "a `sphere` can't be sheared or scaled unevenly")
                    .help("scale it by one number, or use a mesh of an ellipsoid"));
            }
            Geometry::Sphere {
                center: object.vector("center")?.unwrap_or(DVec3::ZERO),
                radius: object.positive("radius", 1.0)?,
            }
        }
        "rectangle" => Geometry::Rectangle,
        "disk" => Geometry::Disk,
        "cube" => Geometry::Cube,
        "cylinder" => {
            let p0 = object.vector("p0")?.unwrap_or(DVec3::ZERO);
            let p1 = object.vector("p1")?.unwrap_or(DVec3::Z);
            if (p1 - p0).as_vec3().length() == 0.0 {
                return Err(object.error_at("p1", "`p0` and `p1` of a `cylinder` are the same point"));
            }
            Geometry::Cylinder { p0, p1, radius: object.positive("radius", 1.0)? }
        }
        "obj" | "ply" | "serialized" => {
            if to_world.matrix3.determinant() < 0.0 {
                files.warnings.push(object.span("to_world").warning(
                    "a mirroring transform turns the winding of the mesh, and its geometric normals, round",
                ));
            }
            let Placed { mesh, face_normals } = files.mesh(object)?;
            Geometry::Mesh { mesh, face_normals: object.boolean("face_normals", false)? || face_normals }
        }
        _ => return Err(object.unknown_plugin()),
    })
}

fn area_radiance(emitter: Object) -> Result<Rgb, LoadError> {
    match emitter.plugin() {
        "area" => {
            let radiance = colour::emission(emitter, "radiance")?;
            emitter.finish()?;
            Ok(radiance)
        }
        plugin if emitter.class().supported().contains(&plugin) => Err(emitter
            .error(format!("the emitter `{plugin}` can't stand inside a shape"))
            .help("shapes shine by `area` emitters; others stand in the scene")),
        _ => Err(emitter.unknown_plugin()),
    }
}
