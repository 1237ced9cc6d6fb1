//! XML to a [`Document`]: structure, parameters and includes, but no plugin's meaning.

mod elsewhere;

use std::{
    cell::{Cell, RefCell},
    collections::HashSet,
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use roxmltree::Node as XmlNode;

use super::{
    attributes::{Attribute, Attributes},
    document::{Document, Entry, Node, Value},
    folders::Folders,
    parameters::Parameters,
    references,
    source::{Source, Span},
    spectrum::Curve,
    transform,
    vocabulary::{Class, FOREIGN_ELEMENTS, PROPERTIES, did_you_mean},
    xml::{elements, no_children, parse, tag_span},
};
use crate::load::LoadError;

/// Elements within elements; real scenes need about 6.
const MAX_NESTING: usize = 64;

/// Reads a scene file and what it includes.
pub(super) fn read(path: &Path, defines: &[(String, String)]) -> Result<Document, LoadError> {
    let mut reader = Reader {
        document: Document { folders: Folders::of_scene(path), ..Document::default() },
        parameters: Parameters::new(defines),
        open: Vec::new(),
        includes: 0,
    };
    let source = Source::read(path)?;
    let xml = parse(&source)?;
    let root = xml.root_element();
    let tag = tag_span(&source, root);
    if root.tag_name().name() != "scene" {
        return Err(tag
            .error(format!("the root of a scene file is `scene`, not `{}`", root.tag_name().name()))
            .help("write <scene version=\"3.0.0\"> … </scene>"));
    }
    reader.open.push(fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()));
    reader.document.root = reader.read_object(&source, root, Class::Scene, 0)?.0;
    reader.parameters.finish(path)?;
    reader.document.resolve()?;
    references::check(&reader.document)?;
    Ok(reader.document)
}

struct Reader {
    document: Document,
    parameters: Parameters,
    /// The file being read and those that include it.
    open: Vec<PathBuf>,
    includes: usize,
}

impl Reader {
    /// The place of an object in the document, and its attribute `name`.
    fn read_object(
        &mut self,
        source: &Arc<Source>,
        xml: XmlNode,
        class: Class,
        depth: usize,
    ) -> Result<(usize, Option<Attribute>), LoadError> {
        let mut attributes = self.attributes(source, xml)?;
        let tag = attributes.tag.clone();
        if depth > MAX_NESTING {
            return Err(tag.error(format!("elements are nested more than {MAX_NESTING} deep")));
        }
        let (plugin, plugin_span) = match class {
            Class::Scene => {
                check_version(&mut attributes)?;
                (String::new(), tag.clone())
            }
            _ => {
                let plugin = attributes.require("type")?;
                (plugin.value, plugin.span)
            }
        };
        let name = attributes.take("name");
        let id = attributes.take("id");
        attributes.finish()?;

        let mut entries = Vec::new();
        self.read_entries(source, xml, depth, &mut entries)?;
        once_each(&entries)?;

        let place = self.document.nodes.len();
        if let Some(id) = &id {
            self.document.add_id(id, place)?;
        }
        self.document.nodes.push(Node {
            class,
            plugin,
            plugin_span,
            id: id.map(|id| id.value),
            tag,
            entries,
            referenced: Cell::new(false),
            asked: RefCell::default(),
        });
        Ok((place, name))
    }

    /// What stands inside an object element.
    fn read_entries(
        &mut self,
        source: &Arc<Source>,
        parent: XmlNode,
        depth: usize,
        entries: &mut Vec<Entry>,
    ) -> Result<(), LoadError> {
        for xml in elements(source, parent)? {
            self.read_child(source, xml, depth + 1, entries)?;
        }
        Ok(())
    }

    fn read_child(
        &mut self,
        source: &Arc<Source>,
        xml: XmlNode,
        depth: usize,
        entries: &mut Vec<Entry>,
    ) -> Result<(), LoadError> {
        let element = xml.tag_name().name();
        let tag = tag_span(source, xml);
        let entry = match element {
            "default" => return self.read_default(source, xml),
            "include" => return self.include(source, xml, depth, entries),
            "path" => return self.path(source, xml),
            "alias" => return self.alias(source, xml),
            "scene" => return Err(tag.error("a scene can't stand inside an object")),
            "ref" => {
                let mut attributes = self.attributes(source, xml)?;
                let id = attributes.require("id")?;
                let name = attributes.take("name");
                no_children(source, xml)?;
                attributes.finish()?;
                new_entry(name, id.span, Value::Reference(id.value))
            }
            _ if PROPERTIES.contains(&element) => self.read_property(source, xml)?,
            _ => {
                let Some(class) = Class::of_element(element) else {
                    return Err(unknown_element(&tag, element));
                };
                let (place, name) = self.read_object(source, xml, class, depth)?;
                new_entry(name, tag, Value::Object(place))
            }
        };
        entries.push(entry);
        Ok(())
    }

    fn read_property(&mut self, source: &Arc<Source>, xml: XmlNode) -> Result<Entry, LoadError> {
        let mut attributes = self.attributes(source, xml)?;
        let element = attributes.element.clone();
        let name = attributes.require("name")?;
        let tag = attributes.tag.clone();
        if element == "transform" {
            let steps = elements(source, xml)?
                .into_iter()
                .map(|step| {
                    no_children(source, step)?;
                    self.attributes(source, step)
                })
                .collect::<Result<_, _>>()?;
            attributes.finish()?;
            return Ok(new_entry(Some(name), tag, Value::Transform(transform::compose(steps)?)));
        }
        no_children(source, xml)?;
        if matches!(element.as_str(), "point" | "vector") {
            let triple = attributes.triple(0.0)?;
            attributes.finish()?;
            let Some(triple) = triple else {
                return Err(tag.error(format!("`{}` has no numbers", name.value)).help("write x, y and z"));
            };
            return Ok(new_entry(Some(name), tag, Value::Vector(triple.into())));
        }
        if element == "spectrum"
            && let Some(file) = attributes.take("filename")
        {
            attributes.finish()?;
            let path = self.document.folders.file(&file.span, &file.value)?;
            return Ok(new_entry(Some(name), file.span, Value::Curve(Curve::read(&path)?)));
        }
        let text = attributes.require("value")?;
        attributes.finish()?;
        let value = match element.as_str() {
            "integer" => Value::Integer(text.integer()?),
            "float" => Value::Float(text.number()?),
            "boolean" => Value::Boolean(text.boolean()?),
            "rgb" => Value::Rgb(read_rgb(&text)?),
            "spectrum" if text.value.contains(':') => Value::Curve(Curve::parse(&text)?),
            "spectrum" => Value::Spectrum(read_spectrum(&text)?),
            _ => Value::String(text.value),
        };
        Ok(new_entry(Some(name), text.span, value))
    }

    fn read_default(&mut self, source: &Arc<Source>, xml: XmlNode) -> Result<(), LoadError> {
        let mut attributes = self.attributes(source, xml)?;
        let name = attributes.require("name")?;
        let value = attributes.require("value")?;
        attributes.finish()?;
        no_children(source, xml)?;
        if name.value.is_empty() {
            return Err(name.error("the name of a parameter is empty"));
        }
        self.parameters.default(&name.value, &value.value, &name.span)
    }

    fn attributes(&mut self, source: &Arc<Source>, xml: XmlNode) -> Result<Attributes, LoadError> {
        let list = xml
            .attributes()
            .map(|attribute| {
                let span = source.span(attribute.range_value());
                Ok(Attribute {
                    name: attribute.name().to_owned(),
                    value: self.parameters.substitute(attribute.value(), &span)?,
                    name_span: source.span(attribute.range_qname()),
                    span,
                })
            })
            .collect::<Result<_, LoadError>>()?;
        Ok(Attributes::new(xml.tag_name().name(), tag_span(source, xml), list))
    }
}

fn check_version(attributes: &mut Attributes) -> Result<(), LoadError> {
    let version = attributes.require("version")?;
    match version.value.split('.').next() {
        Some("2" | "3") => Ok(()),
        _ => Err(version
            .error(format!("scenes of Mitsuba version `{}` are not read", version.value))
            .help("the names of elements and properties are those of Mitsuba 3: version=\"3.0.0\"")),
    }
}

/// Refuses a name that two entries of an object have.
fn once_each(entries: &[Entry]) -> Result<(), LoadError> {
    let mut names = HashSet::new();
    for entry in entries {
        if let Some(name) = &entry.name
            && !names.insert(name)
        {
            return Err(entry
                .name_span
                .error(format!("`{name}` is given twice"))
                .label("the second time")
                .help("keep one of the two"));
        }
    }
    Ok(())
}

fn unknown_element(tag: &Span, element: &str) -> LoadError {
    if FOREIGN_ELEMENTS.contains(&element) {
        return tag
            .error(format!("the element `{element}` is not supported yet"))
            .help("remove it to render the rest");
    }
    let known: Vec<&str> = Class::elements().filter(|name| *name != "scene").collect();
    tag.error(format!("there is no element `{element}`")).label("unknown element").help(did_you_mean(
        element,
        known,
        "the elements",
    ))
}

fn new_entry(name: Option<Attribute>, span: Span, value: Value) -> Entry {
    let name_span = name.as_ref().map_or_else(|| span.clone(), |name| name.span.clone());
    Entry { name: name.map(|name| name.value), name_span, span, value, used: Cell::new(false) }
}

fn read_rgb(text: &Attribute) -> Result<[f64; 3], LoadError> {
    if text.value.trim().starts_with('#') {
        return Err(text
            .error(format!("hexadecimal colours like `{}` are refused", text.value.trim()))
            .help("`rgb` takes linear values: write three numbers, without gamma"));
    }
    match text.numbers()?[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        ref other => Err(text.error(format!("`rgb` takes 1 or 3 numbers, found {}", other.len()))),
    }
}

fn read_spectrum(text: &Attribute) -> Result<f64, LoadError> {
    match text.numbers()?[..] {
        [number] => Ok(number),
        ref other => Err(text
            .error(format!("`spectrum` takes one number or a curve, found {} numbers", other.len()))
            .help("write a colour as <rgb …/>, a curve as value=\"400:0.1, 500:0.2\" in nanometres")),
    }
}
