//! Scenes in the XML format of Mitsuba 3.
//!
//! ```text
//! file ──reader──▶ Document: objects with properties ──builders──▶ SceneDescription
//! ```
//!
//! The reader knows the structure (elements, `$parameters`, `include`, `ref`) and no plugin; there is
//! one builder a class of plugins. A builder asks an [`Object`] for each property that it knows, then
//! finishes it: whatever nobody asked for is an error, so that a misspelt name can't pass silently.

mod attributes;
mod bsdf;
mod colour;
mod document;
mod doubts;
mod emitter;
mod files;
mod film;
mod folders;
mod group;
mod integrator;
mod mesh_attribute;
mod meter;
mod parameters;
mod presets;
mod properties;
mod reader;
mod references;
mod sensor;
mod shape;
mod single;
mod source;
mod spectrum;
mod texture;
mod transform;
mod vocabulary;
mod xml;

use std::{collections::HashMap, path::Path};

use files::Files;
use properties::Object;
pub(super) use single::{read_by_id, read_line};
pub(super) use source::Span;
use vocabulary::Class;
pub(super) use vocabulary::nearest;

use super::{LoadError, LoadOptions, Loaded, Origin, Origins};
use crate::scene::{Emitter, Material, MaterialIndex, Rgb, SceneDescription, Shape, Texture};

/// Reads a scene.
pub(super) fn read_scene(path: &Path, options: &LoadOptions) -> Result<Loaded, LoadError> {
    let document = reader::read(path, &options.defines)?;
    let mut builder = Builder::default();
    builder.files.attributed = document.nodes.iter().any(|node| node.plugin == mesh_attribute::PLUGIN);
    builder.scene(Object::root(&document), options.sensor)?;
    let mut warnings = builder.files.warnings;
    warnings.extend(document.warnings.take());
    Ok(Loaded { description: builder.description, warnings, origins: builder.origins })
}

#[derive(Default)]
struct Builder {
    description: SceneDescription,
    files: Files,
    origins: Origins,
    materials: Materials,
    groups: group::Groups,
    /// Is there a sensor yet?
    sees: bool,
}

impl Builder {
    fn scene(&mut self, scene: Object, sensor: Option<usize>) -> Result<(), LoadError> {
        self.sensor(scene, sensor)?;
        match scene.child(Class::Integrator)? {
            Some(integrator) => self.description.integrator = integrator::build(integrator, &mut self.files)?,
            None => {
                let warning = scene
                    .warning("no integrator is given: `path` without a limit of depth is used")
                    .help("write <integrator type=\"path\"/>");
                self.files.warnings.push(warning);
            }
        }
        for shape in scene.children(Class::Shape) {
            match shape.plugin() {
                group::INSTANCE => self.instance(shape)?,
                group::GROUP => {
                    self.group(shape)?;
                    if !shape.is_referenced() {
                        self.warn_of_idleness(shape);
                    }
                }
                _ => {
                    self.meter(shape)?;
                    self.origins.shapes.push(Origin::element(shape.tag()));
                    let shape = self.shape(shape)?;
                    self.description.shapes.push(shape);
                }
            }
        }
        if !self.sees {
            return Err(scene.error("the scene has no sensor").label("nothing to look through").help(
                "write <sensor type=\"perspective\"> with a `fov`, a `to_world` with a `lookat`, a `sampler` \
                 and a `film`",
            ));
        }
        for object in scene.children(Class::Emitter).into_iter().filter(|emitter| !is_definition(emitter)) {
            let emitter = emitter::build(object, &mut self.files)?;
            let is_environment = |emitter: &Emitter| {
                matches!(emitter, Emitter::Constant { .. } | Emitter::Envmap { .. } | Emitter::Sh { .. })
            };
            if is_environment(&emitter) && self.description.emitters.iter().any(is_environment) {
                return Err(object.error("a scene has one environment, not several").label("the second one"));
            }
            self.description.emitters.push(emitter);
        }
        self.definitions(scene)?;
        scene.accept_referenced();
        scene.finish()?;
        self.description.materials = std::mem::take(&mut self.materials.list);
        self.warn_of_darkness(scene);
        self.warn_of_doubts(scene);
        Ok(())
    }

    fn shape(&mut self, object: Object) -> Result<Shape, LoadError> {
        let shape = shape::build(object, &mut self.files, |files, bsdf, shines| match bsdf {
            Some(bsdf) => self.materials.index_of(bsdf, files),
            None => Ok(self.materials.default(shines)),
        })?;
        mesh_attribute::check(object, &shape.geometry, &self.files)?;
        Ok(shape)
    }

    fn sensor(&mut self, scene: Object, chosen: Option<usize>) -> Result<(), LoadError> {
        let sensors = scene.children(Class::Sensor);
        let Some(&used) = sensors.get(chosen.unwrap_or(0)) else {
            return match chosen {
                Some(index) => Err(scene
                    .error(format!("there is no sensor {index}: the scene has {}", sensors.len()))
                    .help("sensors are counted from 0, in the order in which they stand")),
                // Or a shape has one.
                None => Ok(()),
            };
        };
        self.sees = true;
        self.description.sensor = sensor::build(used, &mut self.files)?;
        if chosen.is_none() {
            for (index, other) in sensors.iter().enumerate().skip(1) {
                let warning = other.warning("the first sensor is used, this one is not").label("not used");
                let help = format!("remove it, or choose it by --sensor {index}");
                self.files.warnings.push(warning.help(help));
            }
        }
        Ok(())
    }

    /// Objects that stand in the scene for others to refer to; they are checked even if none does.
    fn definitions(&mut self, scene: Object) -> Result<(), LoadError> {
        let bsdfs = scene.children(Class::Bsdf);
        let textures = scene.children(Class::Texture);
        for &bsdf in &bsdfs {
            bsdf::build(bsdf, &mut self.files)?;
        }
        for &texture in &textures {
            texture::build(texture, texture::Range::Coefficient, &mut self.files)?;
        }
        for object in bsdfs.iter().chain(&textures).filter(|object| !object.is_referenced()) {
            self.warn_of_idleness(*object);
        }
        Ok(())
    }
}

/// An `area` emitter that shapes refer to may be defined in the scene without shining there.
fn is_definition(emitter: &Object) -> bool {
    emitter.plugin() == "area" && emitter.is_referenced()
}

/// The materials so far; objects that several shapes refer to are built once.
#[derive(Default)]
struct Materials {
    list: Vec<Material>,
    places: HashMap<Source, MaterialIndex>,
}

#[derive(PartialEq, Eq, Hash)]
enum Source {
    /// Place in the document.
    Object(usize),
    /// No BSDF was given; on a shape that shines, or on one that does not.
    Default { shines: bool },
}

impl Materials {
    fn index_of(&mut self, bsdf: Object, files: &mut Files) -> Result<MaterialIndex, LoadError> {
        let source = Source::Object(bsdf.index);
        match self.places.get(&source) {
            Some(&place) => Ok(place),
            None => Ok(self.add(source, bsdf::build(bsdf, files)?)),
        }
    }

    fn default(&mut self, shines: bool) -> MaterialIndex {
        let source = Source::Default { shines };
        match self.places.get(&source) {
            Some(&place) => place,
            None => {
                let reflectance = Texture::Constant(Rgb::splat(if shines { 0.0 } else { 0.5 }));
                self.add(source, Material::Diffuse { reflectance })
            }
        }
    }

    fn add(&mut self, source: Source, material: Material) -> MaterialIndex {
        let place = MaterialIndex(self.list.len() as u32);
        self.list.push(material);
        self.places.insert(source, place);
        place
    }
}
