//! What is legal in a scene and probably not meant, shown where it stands.

use super::{
    Builder,
    group::{GROUP, INSTANCE},
    is_definition,
    properties::Object,
    vocabulary::Class,
};
use crate::{
    load::Warning,
    scene::{Doubt, Integrator, SceneDescription},
};

/// What an emitter says of its power, whatever its kind.
const POWER: [&str; 4] = ["radiance", "intensity", "irradiance", "scale"];

impl Builder {
    /// An object that nothing refers to.
    pub(super) fn warn_of_idleness(&mut self, object: Object) {
        let name = object.id().map_or("without an id".into(), |id| format!("`{id}`"));
        let class = object.class();
        let warning = object.warning(format!("the {class} {name} is never used")).label("never used");
        self.files.warnings.push(warning.help(match object.id() {
            Some(id) => format!("refer to it by <ref id=\"{id}\"/>, or remove it"),
            None => "give it an id and refer to that, or remove it".into(),
        }));
    }

    /// A scene in which nothing shines.
    pub(super) fn warn_of_darkness(&mut self, scene: Object) {
        let SceneDescription { integrator, shapes, emitters, .. } = &self.description;
        let dark = emitters.is_empty() && shapes.iter().all(|shape| shape.radiance.is_none());
        if dark && !matches!(integrator, Integrator::Aov { .. } | Integrator::AmbientOcclusion { .. }) {
            let warning = scene.warning("nothing in the scene shines: the picture will be black");
            self.files.warnings.push(warning.help("<emitter type=\"constant\"/> is a white sky"));
        }
    }

    /// What the description as a whole gives away.
    pub(super) fn warn_of_doubts(&mut self, scene: Object) {
        // In the order in which they were built.
        let is_placed = |shape: &Object| !matches!(shape.plugin(), GROUP | INSTANCE);
        let shapes: Vec<Object> = scene.children(Class::Shape).into_iter().filter(is_placed).collect();
        let emitters = scene.children(Class::Emitter).into_iter();
        let emitters: Vec<Object> = emitters.filter(|emitter| !is_definition(emitter)).collect();
        for doubt in self.description.doubts() {
            self.files.warnings.push(match doubt {
                Doubt::DarkShape(index) => {
                    let shape = shapes[index];
                    let emitter = shape.children(Class::Emitter).first().copied().unwrap_or(shape);
                    let name = &self.description.shapes[index].name;
                    powerless(emitter, format!("the light of shape `{name}` has no power"))
                }
                Doubt::DarkEmitter(index) => {
                    let emitter = emitters[index];
                    powerless(emitter, format!("the `{}` emitter has no power", emitter.plugin()))
                }
                Doubt::AroundCamera(index) => {
                    let name = &self.description.shapes[index].name;
                    let message = format!("the camera is inside of shape `{name}`, which no light passes");
                    let warning = shapes[index].warning(message).label("all that the camera sees is dark");
                    warning.help(
                        "move the `origin` of the sensor's `lookat` out of it; the walls of a room look \
                         inwards by <boolean name=\"flip_normals\" value=\"true\"/>, or are `twosided`",
                    )
                }
            });
        }
    }
}

fn powerless(emitter: Object, message: String) -> Warning {
    let said = POWER.into_iter().find(|name| emitter.has(name));
    let span = said.map_or_else(|| emitter.tag(), |name| emitter.span(name).clone());
    let warning = span.warning(message).label("no light comes from here");
    warning.help(match said {
        Some(name) => format!("give `{name}` a value above 0, or remove the light"),
        None => "remove the light".into(),
    })
}
