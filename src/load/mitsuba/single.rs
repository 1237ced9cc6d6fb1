//! One bsdf alone: written on a line, or picked out of a scene by its id.
//!
//! ```text
//! roughconductor:alpha=0.3,material=Au          plugin:name=value,name=value,…
//! diffuse:reflectance=0.6 0.2 0.1               a colour is three numbers with blanks between them
//! ```
//!
//! The line becomes the same properties that the element would have, so the builders, their ranges and
//! their suggestions are those of files.

use std::{
    cell::{Cell, RefCell},
    ops::Range,
    path::Path,
    sync::Arc,
};

use super::{
    attributes::Attribute,
    bsdf,
    document::{Document, Entry, Node, Value},
    files::Files,
    properties::Object,
    reader,
    source::Source,
    vocabulary::{Class, did_you_mean},
};
use crate::{
    load::{LoadError, Warning},
    scene::Material,
};

/// What messages call the line.
const NAME: &str = "MODEL";

/// Reads `plugin:name=value,…`; file names are relative to the working directory.
pub(in crate::load) fn read_line(line: &str) -> Result<(Material, Vec<Warning>), LoadError> {
    let source = Source::named(Path::new(NAME), line);
    let plugin = line.split(':').next().unwrap_or(line);
    let span = |range| source.span(range);
    let mut entries: Vec<Entry> = Vec::new();
    if plugin.len() < line.len() {
        let mut start = plugin.len() + 1;
        for part in line[start..].split(',') {
            let entry = entry(&source, start..start + part.len())?;
            if entries.iter().any(|other| other.name == entry.name) {
                let name = entry.name.unwrap_or_default();
                return Err(entry.name_span.error(format!("`{name}` is given twice")));
            }
            entries.push(entry);
            start += part.len() + 1;
        }
    }
    let node = Node {
        class: Class::Bsdf,
        plugin: plugin.trim().to_owned(),
        plugin_span: span(0..plugin.len()),
        id: None,
        tag: span(0..plugin.len()),
        entries,
        referenced: Cell::new(false),
        asked: RefCell::default(),
    };
    let document = Document { nodes: vec![node], ..Document::default() };
    let mut files = Files::default();
    let material = bsdf::build(Object::root(&document), &mut files)?;
    Ok((material, files.warnings))
}

/// `name=value`.
fn entry(source: &Arc<Source>, range: Range<usize>) -> Result<Entry, LoadError> {
    let text = &source.text[range.clone()];
    let Some((name, value)) = text.split_once('=').filter(|(name, _)| !name.trim().is_empty()) else {
        return Err(source
            .span(range)
            .error(format!("`{text}` is not name=value"))
            .help("write plugin:name=value,name=value, as in roughconductor:alpha=0.3,material=Au"));
    };
    let name_span = source.span(range.start..range.start + name.len());
    let span = source.span(range.start + name.len() + 1..range.end);
    let attribute = Attribute {
        name: name.trim().to_owned(),
        value: value.trim().to_owned(),
        name_span: name_span.clone(),
        span: span.clone(),
    };
    let value = value_of(&attribute)?;
    Ok(Entry { name: Some(attribute.name), name_span, span, value, used: Cell::new(false) })
}

/// What the text looks like decides its kind, as the element would in a file.
fn value_of(text: &Attribute) -> Result<Value, LoadError> {
    let word = text.value.as_str();
    let is_number = |word: &str| word.parse::<f64>().is_ok();
    Ok(if matches!(word, "true" | "false") {
        Value::Boolean(text.boolean()?)
    } else if word.parse::<i64>().is_ok() {
        Value::Integer(text.integer()?)
    } else if is_number(word) {
        Value::Float(text.number()?)
    } else if !word.is_empty() && word.split_whitespace().all(is_number) {
        Value::Rgb(text.array()?)
    } else {
        Value::String(word.to_owned())
    })
}

/// The bsdf that has an id in a scene, or that of the shape that has it.
pub(in crate::load) fn read_by_id(
    path: &Path,
    defines: &[(String, String)],
    id: &str,
) -> Result<(Material, Vec<Warning>), LoadError> {
    let document = reader::read(path, defines)?;
    let root = Object::root(&document);
    let bsdf_of = |place: usize| -> Option<Object> {
        let object = root.at(place);
        match object.class() {
            Class::Bsdf => Some(object),
            Class::Shape => object.children(Class::Bsdf).first().copied(),
            _ => None,
        }
    };
    let Some(bsdf) = document.ids.get(id).and_then(|&place| bsdf_of(place)) else {
        let mut known: Vec<&str> = document
            .ids
            .iter()
            .filter(|&(_, &place)| bsdf_of(place).is_some())
            .map(|(id, _)| id.as_str())
            .collect();
        known.sort_unstable();
        return Err(LoadError::new(path, format!("no bsdf, and no shape with one, has the id `{id}`"))
            .help(did_you_mean(id, known, "the ids here")));
    };
    let mut files = Files::default();
    let material = bsdf::build(bsdf, &mut files)?;
    Ok((material, files.warnings))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Rgb, Texture};

    fn refusal(line: &str) -> String {
        read_line(line).expect_err(line).to_string()
    }

    #[test]
    fn a_line_is_what_the_element_would_be() {
        let (material, _) = read_line("toon:reflectance=0.5 0.25 1,bands=4").unwrap();
        let Material::Toon { reflectance, .. } = material else { panic!("{material:?}") };
        assert_eq!(reflectance, Texture::Constant(Rgb::new(0.5, 0.25, 1.0)));
        assert!(matches!(
            read_line("plastic: nonlinear = true ").unwrap().0,
            Material::Plastic { nonlinear: true, .. }
        ));
        assert!(matches!(read_line("conductor:material=Au").unwrap().0, Material::Conductor { .. }));
        assert!(matches!(read_line("diffuse").unwrap().0, Material::Diffuse { .. }));
    }

    #[test]
    fn a_bad_line_is_told_with_its_column() {
        for (line, expected) in [
            ("roughconducter:alpha=0.3", "MODEL:1:1: there is no bsdf `roughconducter`"),
            ("roughconductor:alpha=0", "MODEL:1:22: `alpha` must be greater than 0, but is 0"),
            ("roughconductor:alpha=inf", "MODEL:1:22: `inf` is not a finite number"),
            ("roughconductor:alpha", "MODEL:1:16: `alpha` is not name=value"),
            ("diffuse:reflectance=0.5 0.5", "MODEL:1:21: expected 3 numbers, found 2"),
            ("diffuse:reflectence=0.5", "MODEL:1:9: the bsdf `diffuse` has no property `reflectence`"),
            ("phong:exponent=3,exponent=4", "MODEL:1:18: `exponent` is given twice"),
            ("", "MODEL:1:1: there is no bsdf ``"),
        ] {
            let found = refusal(line);
            assert!(found.starts_with(expected), "{line}: {found}");
        }
    }

    #[test]
    fn an_id_names_a_bsdf_or_a_shape() {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/spheres.xml");
        assert!(matches!(read_by_id(&scene, &[], "metal").unwrap().0, Material::Conductor { .. }));
        let error = read_by_id(&scene, &[], "mettal").unwrap_err();
        assert!(
            error.to_string().ends_with("no bsdf, and no shape with one, has the id `mettal`"),
            "{error}"
        );
    }
}
