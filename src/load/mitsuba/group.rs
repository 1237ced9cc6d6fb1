//! Groups of shapes and where they are placed.

use std::collections::HashMap;

use super::{Builder, properties::Object, vocabulary::Class};
use crate::{
    load::{LoadError, Origin},
    scene::{GroupIndex, Instance, ShapeGroup},
};

pub(super) const GROUP: &str = "shapegroup";
pub(super) const INSTANCE: &str = "instance";

/// The groups so far, by their places in the document: each is built once, however often it is placed.
pub(super) type Groups = HashMap<usize, GroupIndex>;

impl Builder {
    /// An `instance`, and the group that it places.
    pub(super) fn instance(&mut self, object: Object) -> Result<(), LoadError> {
        let to_world = object.to_world()?;
        let group = match object.children(Class::Shape)[..] {
            [group] if group.plugin() == GROUP => group,
            [other] => {
                let error =
                    other.error(format!("an `{INSTANCE}` places a `{GROUP}`, not a `{}`", other.plugin()));
                return Err(error.help(format!("put the shape into a <shape type=\"{GROUP}\" id=\"…\">")));
            }
            [] => {
                return Err(object
                    .error(format!("this `{INSTANCE}` places nothing"))
                    .help(format!("write <ref id=\"…\"/> with the id of a `{GROUP}`")));
            }
            [_, second, ..] => {
                return Err(second
                    .error(format!("an `{INSTANCE}` places one `{GROUP}`, not several"))
                    .label("the second one"));
            }
        };
        object.finish()?;
        let group = self.group(group)?;
        self.description.instances.push(Instance { group, to_world });
        Ok(())
    }

    /// A `shapegroup` that nothing has to place: it is checked even if nothing does.
    pub(super) fn group(&mut self, object: Object) -> Result<GroupIndex, LoadError> {
        if let Some(&index) = self.groups.get(&object.index) {
            return Ok(index);
        }
        let mut group = ShapeGroup { name: object.id().unwrap_or(GROUP).to_owned(), shapes: vec![] };
        let mut origins = Vec::new();
        for shape in object.children(Class::Shape) {
            if let plugin @ (GROUP | INSTANCE) = shape.plugin() {
                let article = if plugin == GROUP { "a" } else { "an" };
                return Err(shape
                    .error(format!("{article} `{plugin}` can't stand in a `{GROUP}`"))
                    .label("groups don't nest")
                    .help("place its shapes in this group themselves"));
            }
            if let Some(emitter) = shape.children(Class::Emitter).first() {
                return Err(emitter
                    .error(format!("a shape in a `{GROUP}` can't shine"))
                    .help("let the shape that shines stand in the scene itself, once for each place"));
            }
            if let Some(sensor) = shape.children(Class::Sensor).first() {
                return Err(sensor
                    .error(format!("a shape in a `{GROUP}` can't be measured"))
                    .help("let the shape that is measured stand in the scene itself"));
            }
            group.shapes.push(self.shape(shape)?);
            origins.push(Origin::element(shape.tag()));
        }
        object.finish()?;
        let index = GroupIndex(self.description.groups.len() as u32);
        self.description.groups.push(group);
        self.origins.groups.push(origins);
        self.groups.insert(object.index, index);
        Ok(index)
    }
}
