//! The property bag: builders ask for what they know, and nothing may be left over.

use glam::{DAffine3, DVec3};

use super::{
    document::{Document, Entry, Node, Value},
    folders::Folders,
    source::Span,
    transform,
    vocabulary::{Class, did_you_mean, listed, nearest},
};
use crate::load::{LoadError, Warning};

/// An object of the document, as builders see it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Object<'d> {
    document: &'d Document,
    pub(super) index: usize,
}

impl<'d> Object<'d> {
    pub(super) fn root(document: &'d Document) -> Self {
        Self { document, index: document.root }
    }

    fn node(self) -> &'d Node {
        &self.document.nodes[self.index]
    }

    pub(super) fn class(self) -> Class {
        self.node().class
    }

    pub(super) fn plugin(self) -> &'d str {
        &self.node().plugin
    }

    pub(super) fn id(self) -> Option<&'d str> {
        self.node().id.as_deref()
    }

    pub(super) fn is_referenced(self) -> bool {
        self.node().referenced.get()
    }

    /// Where the files are that the scene names.
    pub(super) fn folders(self) -> &'d Folders {
        &self.document.folders
    }

    /// A warning about the value of a property. What is built twice warns once.
    pub(super) fn warn_at(self, name: &str, message: impl Into<String>) {
        let warning = self.span(name).warning(message);
        let mut warnings = self.document.warnings.borrow_mut();
        if !warnings.contains(&warning) {
            warnings.push(warning);
        }
    }

    /// The element's name.
    pub(super) fn tag(self) -> Span {
        self.node().tag.clone()
    }

    /// An error that underlines the element's name.
    pub(super) fn error(self, message: impl Into<String>) -> LoadError {
        self.node().tag.error(message)
    }

    /// A warning about the element.
    pub(super) fn warning(self, message: impl Into<String>) -> Warning {
        self.node().tag.warning(message)
    }

    /// The error for a `type` that nothing builds.
    pub(super) fn unknown_plugin(self) -> LoadError {
        let (class, plugin) = (self.class(), self.plugin());
        let supported = format!("supported {class}s are {}", listed(class.supported().iter().copied()));
        let span = &self.node().plugin_span;
        if class.foreign().contains(&plugin) {
            return span
                .error(format!("the {class} `{plugin}` is not supported yet"))
                .label("not supported")
                .help(supported);
        }
        let all = class.supported().iter().chain(class.foreign()).copied();
        span.error(format!("there is no {class} `{plugin}`")).label("unknown type").help(
            match nearest(plugin, all) {
                Some(candidate) => format!("did you mean `{candidate}`? {supported}"),
                None => supported,
            },
        )
    }

    fn find(self, name: &'static str) -> Option<&'d Entry> {
        self.node().asked.borrow_mut().push(name);
        let entry = self.node().entries.iter().find(|entry| entry.name.as_deref() == Some(name))?;
        entry.used.set(true);
        Some(entry)
    }

    pub(super) fn has(self, name: &str) -> bool {
        self.node().entries.iter().any(|entry| entry.name.as_deref() == Some(name))
    }

    /// Where the value of a property stands, or the element if it is not given.
    pub(super) fn span(self, name: &str) -> &'d Span {
        let entry = self.node().entries.iter().find(|entry| entry.name.as_deref() == Some(name));
        entry.map_or(&self.node().tag, |entry| &entry.span)
    }

    /// An error that underlines the value of a property.
    pub(super) fn error_at(self, name: &str, message: impl Into<String>) -> LoadError {
        self.span(name).error(message)
    }

    /// Refuses two properties that say the same thing.
    pub(super) fn exclude(self, one: &str, other: &str) -> Result<(), LoadError> {
        match self.has(one) && self.has(other) {
            true => Err(self
                .error_at(other, format!("`{one}` and `{other}` exclude each other"))
                .help("keep one of the two")),
            false => Ok(()),
        }
    }

    /// The error for a required property that is absent.
    pub(super) fn missing(self, name: &str, example: &str) -> LoadError {
        let error = self.error(format!("the {} `{}` needs `{name}`", self.class(), self.plugin()));
        let strangers = self.node().entries.iter().filter(|entry| !entry.used.get());
        match nearest(name, strangers.filter_map(|entry| entry.name.as_deref())) {
            Some(stranger) => error.help(format!("did you mean `{name}` by `{stranger}`?")),
            None => error.help(format!("write {example}")),
        }
    }

    /// A property of any kind.
    pub(super) fn value(self, name: &'static str) -> Option<&'d Value> {
        self.find(name).map(|entry| &entry.value)
    }

    /// The error for a property of the wrong kind.
    pub(super) fn wrong_kind(self, name: &str, expected: &str) -> LoadError {
        let entry = self.node().entries.iter().find(|entry| entry.name.as_deref() == Some(name));
        let found = entry.map_or("nothing", |entry| match entry.value {
            Value::Object(index) => self.at(index).class_name(),
            ref value => value.element(),
        });
        self.error_at(name, format!("`{name}` must be written as {expected}, not as `{found}`"))
    }

    fn class_name(self) -> &'static str {
        match self.class() {
            Class::Texture => "texture",
            Class::Bsdf => "bsdf",
            Class::Emitter => "emitter",
            _ => "object",
        }
    }

    pub(super) fn at(self, index: usize) -> Self {
        Self { index, ..self }
    }

    pub(super) fn float(self, name: &'static str) -> Result<Option<f64>, LoadError> {
        match self.value(name) {
            None => Ok(None),
            Some(&Value::Float(number)) => Ok(Some(number)),
            Some(&Value::Integer(number)) => Ok(Some(number as f64)),
            Some(_) => Err(self.wrong_kind(name, "`float`")),
        }
    }

    /// A number greater than 0.
    pub(super) fn positive(self, name: &'static str, default: f64) -> Result<f64, LoadError> {
        let number = self.float(name)?.unwrap_or(default);
        // In single precision, which is what is rendered with.
        match number as f32 > 0.0 {
            true => Ok(number),
            false => Err(self.error_at(name, format!("`{name}` must be greater than 0, but is {number}"))),
        }
    }

    pub(super) fn integer(self, name: &'static str) -> Result<Option<i64>, LoadError> {
        match self.value(name) {
            None => Ok(None),
            Some(&Value::Integer(number)) => Ok(Some(number)),
            Some(_) => Err(self.wrong_kind(name, "`integer`")),
        }
    }

    /// An integer of at least `least` and at most `most`.
    pub(super) fn count(
        self,
        name: &'static str,
        default: u32,
        least: u32,
        most: u32,
    ) -> Result<u32, LoadError> {
        let number = self.integer(name)?.unwrap_or(default.into());
        match u32::try_from(number) {
            Ok(count) if (least..=most).contains(&count) => Ok(count),
            _ if number < least.into() => {
                Err(self.error_at(name, format!("`{name}` must be at least {least}, but is {number}")))
            }
            _ => Err(self.error_at(name, format!("`{name}` must be at most {most}, but is {number}"))),
        }
    }

    pub(super) fn boolean(self, name: &'static str, default: bool) -> Result<bool, LoadError> {
        match self.value(name) {
            None => Ok(default),
            Some(&Value::Boolean(boolean)) => Ok(boolean),
            Some(_) => Err(self.wrong_kind(name, "`boolean`")),
        }
    }

    pub(super) fn string(self, name: &'static str) -> Result<Option<&'d str>, LoadError> {
        match self.value(name) {
            None => Ok(None),
            Some(Value::String(string)) => Ok(Some(string)),
            Some(_) => Err(self.wrong_kind(name, "`string`")),
        }
    }

    /// A string out of a list; the first one is the default.
    pub(super) fn choice<T: Copy>(
        self,
        name: &'static str,
        choices: &[(&'static str, T)],
        default: T,
    ) -> Result<T, LoadError> {
        let Some(word) = self.string(name)? else { return Ok(default) };
        choices.iter().find(|(choice, _)| *choice == word).map(|&(_, value)| value).ok_or_else(|| {
            let known = choices.iter().map(|&(choice, _)| choice);
            self.error_at(name, format!("`{word}` is no value of `{name}`")).help(did_you_mean(
                word,
                known,
                "the choices",
            ))
        })
    }

    pub(super) fn vector(self, name: &'static str) -> Result<Option<DVec3>, LoadError> {
        match self.value(name) {
            None => Ok(None),
            Some(&Value::Vector(vector)) => Ok(Some(vector)),
            Some(_) => Err(self.wrong_kind(name, "`point` or `vector`")),
        }
    }

    /// A transform of any kind; the identity if it is not given.
    pub(super) fn transform(self, name: &'static str) -> Result<DAffine3, LoadError> {
        match self.value(name) {
            None => Ok(DAffine3::IDENTITY),
            Some(&Value::Transform(transform)) => Ok(transform),
            Some(_) => Err(self.wrong_kind(name, "`transform`")),
        }
    }

    /// `to_world`, which must have an inverse.
    pub(super) fn to_world(self) -> Result<DAffine3, LoadError> {
        let transform = self.transform("to_world")?;
        transform::invertible(transform, self.span("to_world"))
    }

    /// Accepts the nested objects, of whatever class, that a `ref` elsewhere uses.
    pub(super) fn accept_referenced(self) {
        for entry in &self.node().entries {
            if let Value::Object(index) = entry.value
                && self.at(index).is_referenced()
            {
                entry.used.set(true);
            }
        }
    }

    /// The nested objects of a class.
    pub(super) fn children(self, class: Class) -> Vec<Self> {
        let of_class =
            |entry: &&Entry| matches!(entry.value, Value::Object(i) if self.at(i).class() == class);
        let entries = self.node().entries.iter().filter(of_class);
        entries
            .inspect(|entry| entry.used.set(true))
            .filter_map(|entry| match entry.value {
                Value::Object(index) => Some(self.at(index)),
                _ => None,
            })
            .collect()
    }

    /// The nested object of a class, of which there may be one.
    pub(super) fn child(self, class: Class) -> Result<Option<Self>, LoadError> {
        match self.children(class)[..] {
            [] => Ok(None),
            [only] => Ok(Some(only)),
            [_, second, ..] => Err(second
                .error(format!("the {} `{}` takes one {class}, not several", self.class(), self.plugin()))
                .label("the second one")),
        }
    }

    /// # Errors
    /// If a property or a nested object has not been asked for.
    pub(super) fn finish(self) -> Result<(), LoadError> {
        let Some(stranger) = self.node().entries.iter().find(|entry| !entry.used.get()) else {
            return Ok(());
        };
        let owner = match self.class() {
            Class::Scene => "the scene".into(),
            class => format!("the {class} `{}`", self.plugin()),
        };
        let mut known = self.node().asked.borrow().clone();
        known.sort_unstable();
        known.dedup();
        let help = |word| did_you_mean(word, known.iter().copied(), "the properties here");
        Err(match (&stranger.name, &stranger.value) {
            (None, &Value::Object(index)) => {
                let class = self.at(index).class();
                let error = stranger.span.error(format!("{owner} takes no {class}"));
                match class {
                    Class::Texture => error.help(format!(
                        "a texture goes where its `name` says; {}",
                        did_you_mean("", known.iter().copied(), "the properties here")
                    )),
                    _ => error.help("move it to where it belongs, or remove it"),
                }
            }
            (name, _) => {
                let name = name.as_deref().unwrap_or_default();
                let error = stranger.name_span.error(format!("{owner} has no property `{name}`"));
                error.label("never used").help(help(name))
            }
        })
    }
}
