//! A scene file as a graph of objects with properties, not yet interpreted.

use std::{
    cell::{Cell, RefCell},
    collections::HashMap,
};

use glam::{DAffine3, DVec3};

use super::{
    attributes::Attribute,
    folders::Folders,
    source::Span,
    spectrum::Curve,
    vocabulary::{Class, nearest},
};
use crate::load::{LoadError, Warning};

/// Every object of a scene; the scene itself is [`Document::root`].
#[derive(Debug, Default)]
pub(super) struct Document {
    pub(super) nodes: Vec<Node>,
    pub(super) root: usize,
    /// Places of the objects that have an `id`.
    pub(super) ids: HashMap<String, usize>,
    pub(super) folders: Folders,
    /// What builders had to say of values that can't be taken as they are.
    pub(super) warnings: RefCell<Vec<Warning>>,
}

/// An object element.
#[derive(Debug)]
pub(super) struct Node {
    pub(super) class: Class,
    /// The attribute `type`; empty for the scene.
    pub(super) plugin: String,
    /// Of the type's name.
    pub(super) plugin_span: Span,
    pub(super) id: Option<String>,
    /// Of the element's name.
    pub(super) tag: Span,
    pub(super) entries: Vec<Entry>,
    /// A `ref` names it.
    pub(super) referenced: Cell<bool>,
    /// What the builder has asked for, to suggest in place of a misspelt name.
    pub(super) asked: RefCell<Vec<&'static str>>,
}

/// A property or a nested object.
#[derive(Debug)]
pub(super) struct Entry {
    /// `None` for nested objects that only their class places.
    pub(super) name: Option<String>,
    /// Of the name, or of the element if there is none.
    pub(super) name_span: Span,
    /// Of the value, or of the element.
    pub(super) span: Span,
    pub(super) value: Value,
    pub(super) used: Cell<bool>,
}

/// What a property holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Integer(i64),
    Float(f64),
    Boolean(bool),
    String(String),
    Vector(DVec3),
    Rgb([f64; 3]),
    /// A constant one.
    Spectrum(f64),
    /// A spectrum over wavelengths.
    Curve(Curve),
    Transform(DAffine3),
    /// Place in [`Document::nodes`].
    Object(usize),
    /// An `id`, until [`Document::resolve`].
    Reference(String),
}

impl Value {
    /// The element that writes such a value.
    pub(super) fn element(&self) -> &'static str {
        match self {
            Self::Integer(_) => "integer",
            Self::Float(_) => "float",
            Self::Boolean(_) => "boolean",
            Self::String(_) => "string",
            Self::Vector(_) => "vector",
            Self::Rgb(_) => "rgb",
            Self::Spectrum(_) | Self::Curve(_) => "spectrum",
            Self::Transform(_) => "transform",
            Self::Object(_) => "object",
            Self::Reference(_) => "ref",
        }
    }
}

impl Document {
    /// Gives an object a name.
    pub(super) fn add_id(&mut self, id: &Attribute, place: usize) -> Result<(), LoadError> {
        match self.ids.insert(id.value.clone(), place) {
            None => Ok(()),
            Some(_) => Err(id
                .error(format!("two objects have the id `{}`", id.value))
                .label("the second one")
                .help("ids name one object each: rename one of the two")),
        }
    }

    /// Puts objects in the place of references to them; an `id` may stand after its `ref`.
    pub(super) fn resolve(&mut self) -> Result<(), LoadError> {
        let Self { nodes, ids, .. } = self;
        let mut targets = Vec::new();
        for entry in nodes.iter_mut().flat_map(|node| &mut node.entries) {
            let Value::Reference(id) = &entry.value else { continue };
            let Some(&target) = ids.get(id) else {
                let error = entry.span.error(format!("no object has the id `{id}`")).label("unknown id");
                // Sorted, so that the same file is always refused with the same words.
                let mut known: Vec<&str> = ids.keys().map(String::as_str).collect();
                known.sort_unstable();
                return Err(match nearest(id, known) {
                    Some(known) => error.help(format!("did you mean `{known}`?")),
                    None => error.help(format!("give the object that is meant the attribute id=\"{id}\"")),
                });
            };
            entry.value = Value::Object(target);
            targets.push(target);
        }
        for target in targets {
            nodes[target].referenced.set(true);
        }
        Ok(())
    }
}
