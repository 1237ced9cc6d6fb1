//! Properties of vertices and faces that textures can be made of, named as Mitsuba names them.
//!
//! ```text
//! r g b, red green blue        vertex_color           NAME_r NAME_g NAME_b    vertex_NAME_color
//! NAME_x NAME_y NAME_z         vertex_NAME            NAME_0, NAME_1          vertex_NAME (grey)
//! ```
//!
//! and `face_…` likewise. An attribute has one field or three; fields of one stand together, in the order of
//! `xyz`, `rgb`, `012` or `123`. What is called otherwise is read over.

use std::path::Path;

use super::{ElementDef, Header, Property, PropertyAccess, PropertyAccessResult, read_rows};
use crate::{
    load::LoadError,
    scene::{Attribute, Per, Rgb},
};

/// What the last letters of a name's fields may be.
const SUFFIXES: [[char; 4]; 4] = [['x', 'y', 'z', 'w'], COLOURS, ['0', '1', '2', '3'], ['1', '2', '3', '4']];
const COLOURS: [char; 4] = ['r', 'g', 'b', 'a'];

/// Names of whole colours.
const COLOUR_FIELDS: [[&str; 3]; 2] = [["r", "g", "b"], ["red", "green", "blue"]];

/// An attribute and where its fields stand among an element's properties.
#[derive(Debug, PartialEq)]
struct Fields {
    name: String,
    /// One, or three.
    places: Vec<usize>,
}

/// The attributes among properties of these names.
fn find(per: Per, properties: &[&str]) -> Vec<Fields> {
    let prefix = if per == Per::Vertex { "vertex_" } else { "face_" };
    let place = |name: &str| properties.iter().position(|property| *property == name);
    let colour = COLOUR_FIELDS.iter().find_map(|names| names.iter().map(|name| place(name)).collect());
    let mut found: Vec<Fields> =
        colour.map(|places| Fields { name: format!("{prefix}color"), places }).into_iter().collect();
    let split: Vec<Option<(&str, char)>> = properties.iter().map(|name| stem(name)).collect();
    let mut next = 0;
    for run in split.chunk_by(|a, b| a.map(|(stem, _)| stem) == b.map(|(stem, _)| stem)) {
        let begin = next;
        next += run.len();
        let Some((stem, first)) = run[0] else { continue };
        let again = split[..begin].iter().flatten().any(|(other, _)| *other == stem);
        let Some(suffixes) = SUFFIXES.iter().find(|suffixes| suffixes[0] == first) else { continue };
        let follows = run.iter().flatten().map(|(_, suffix)| suffix).eq(suffixes.iter().take(run.len()));
        if !again && follows && matches!(run.len(), 1 | 3) {
            let kind = if *suffixes == COLOURS { "_color" } else { "" };
            let places = (begin..begin + run.len()).collect();
            found.push(Fields { name: format!("{prefix}{stem}{kind}"), places });
        }
    }
    found
}

/// A name before its last letter and the underscore before that.
fn stem(name: &str) -> Option<(&str, char)> {
    let (stem, suffix) = name.rsplit_once('_')?;
    let mut letters = suffix.chars();
    let reserved = ["texture_u", "texture_v"].contains(&name) || stem.is_empty();
    letters.next().filter(|_| !reserved && letters.next().is_none()).map(|letter| (stem, letter))
}

/// The attributes of an element whose rows begin at `rest`. `repeat` says how often a row's values stand in
/// the mesh, by the length of its list, or 0 if it has none.
pub(super) fn read(
    path: &Path,
    header: &Header,
    element: &ElementDef,
    mut rest: &[u8],
    per: Per,
    repeat: impl Fn(usize) -> usize,
) -> Result<Vec<Attribute>, LoadError> {
    let names: Vec<&str> = element.properties.keys().map(String::as_str).collect();
    let found = find(per, &names);
    let mut values = vec![Vec::new(); found.len()];
    if found.is_empty() {
        return Ok(vec![]);
    }
    read_rows(path, header, element, &mut rest, |row: Row, number| {
        for (fields, values) in found.iter().zip(&mut values) {
            let field = |k: usize| row.scalars[fields.places[k.min(fields.places.len() - 1)]];
            let value = Rgb::new(field(0), field(1), field(2));
            if !value.is_finite() {
                let (name, what) = (&fields.name, &element.name);
                let message = format!("`{name}` of {what} {number} has a number that is not finite");
                return Err(LoadError::new(path, message));
            }
            values.extend(std::iter::repeat_n(value, repeat(row.list)));
        }
        Ok(())
    })?;
    let attribute = |(fields, values): (Fields, Vec<Rgb>)| Attribute { name: fields.name, per, values };
    Ok(found.into_iter().zip(values).map(attribute).collect())
}

/// All numbers of a row.
#[derive(Default)]
struct Row {
    /// By property; 0 in the place of a list.
    scalars: Vec<f32>,
    /// How long the list is.
    list: usize,
}

impl PropertyAccess for Row {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, _: &str, property: Property) -> PropertyAccessResult {
        match property.to_f32_lossy() {
            Some(scalar) => self.scalars.push(scalar),
            None => {
                self.list = property.to_u32_list().map_or(0, |list| list.len());
                self.scalars.push(0.0);
            }
        }
        PropertyAccessResult::Set
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names and places, as Mitsuba 3.9.1 finds them.
    #[test]
    fn names_are_those_of_mitsuba() {
        let names = |properties: &[&str]| -> Vec<(String, Vec<usize>)> {
            find(Per::Vertex, properties).into_iter().map(|fields| (fields.name, fields.places)).collect()
        };
        let one = |name: &str, places: &[usize]| vec![(name.to_owned(), places.to_vec())];
        assert_eq!(names(&["x", "y", "z", "r", "g", "b"]), one("vertex_color", &[3, 4, 5]));
        assert_eq!(names(&["g", "b", "r"]), one("vertex_color", &[2, 0, 1]));
        assert_eq!(names(&["red", "green", "blue", "alpha"]), one("vertex_color", &[0, 1, 2]));
        assert_eq!(names(&["heat_0"]), one("vertex_heat", &[0]));
        assert_eq!(names(&["heat_r"]), one("vertex_heat_color", &[0]));
        assert_eq!(names(&["a_b_x", "a_b_y", "a_b_z"]), one("vertex_a_b", &[0, 1, 2]));
        assert_eq!(names(&["h_1", "h_2", "h_3"]), one("vertex_h", &[0, 1, 2]));
        assert_eq!(names(&["d_r", "d_g", "d_b"]), one("vertex_d_color", &[0, 1, 2]));
        let both = find(Per::Face, &["vertex_indices", "a_x", "b_x"]);
        assert_eq!(both.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["face_a", "face_b"]);
        for nothing in [
            &["heat"] as &[&str],
            &["heat_x", "heat_y"],
            &["c_r", "c_g", "c_b", "c_a"],
            &["c_x", "c_z", "c_y"],
            &["quality", "confidence"],
            &["r", "g"],
            &["texture_u", "texture_v"],
            &["c_y"],
        ] {
            assert_eq!(names(nothing), [], "{nothing:?}");
        }
        assert_eq!(names(&["t_x", "s", "t_x2", "t_y"]), one("vertex_t", &[0]));
    }
}
