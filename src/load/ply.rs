//! PLY (ascii, little and big endian) to triangles. The only file that names `ply_rs_bw`.

mod attributes;

use std::{io::BufRead, path::Path};

use glam::{Vec2, Vec3};
use ply_rs_bw::{
    parser::{ParseError, Parser, Reader},
    ply::{
        ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType,
        ScalarType,
    },
};

use super::{LoadError, Warning, text};
use crate::scene::{Mesh, Per};

/// Reads all faces as one mesh; uv is as in the file.
pub(super) fn read_mesh(path: &Path, warnings: &mut Vec<Warning>) -> Result<Mesh, LoadError> {
    read(path, false, warnings)
}

/// [`read_mesh`], with what textures may be made of.
pub(super) fn read_attributed_mesh(path: &Path, warnings: &mut Vec<Warning>) -> Result<Mesh, LoadError> {
    read(path, true, warnings)
}

fn read(path: &Path, attributed: bool, warnings: &mut Vec<Warning>) -> Result<Mesh, LoadError> {
    let bytes = text::read_bytes(path)?;
    let (header, payload) = read_header(path, &bytes)?;
    check_sizes(path, &header, payload)?;

    let mut mesh = Mesh::default();
    let mut polygons = Polygons::default();
    let mut rest = payload;
    for element in header.elements.values() {
        let values = |per, repeat: fn(usize) -> usize| match attributed {
            true => attributes::read(path, &header, element, rest, per, repeat),
            false => Ok(vec![]),
        };
        match element.name.as_str() {
            "vertex" => mesh.attributes.extend(values(Per::Vertex, |_| 1)?),
            "face" => mesh.attributes.extend(values(Per::Face, |corners| corners.saturating_sub(2))?),
            _ => {}
        }
        match element.name.as_str() {
            "vertex" => read_vertices(path, &header, element, &mut rest, &mut mesh)?,
            "face" => {
                let fan = |face: Face, row| polygons.add(path, face, row);
                read_rows(path, &header, element, &mut rest, fan)?;
            }
            _ => read_rows(path, &header, element, &mut rest, |_: Skipped, _| Ok(()))?,
        }
    }
    mesh.triangles = polygons.triangles;
    if polygons.largest_index as usize >= mesh.positions.len() && !mesh.triangles.is_empty() {
        let count = mesh.positions.len();
        let message = format!("a face uses vertex {}, but there are only {count}", polygons.largest_index);
        return Err(LoadError::new(path, message).help("PLY counts vertices from 0."));
    }
    if polygons.dropped > 0 {
        let message = format!("{} faces with fewer than 3 corners were dropped", polygons.dropped);
        warnings.push(Warning::new(path, message));
    }
    if mesh.triangles.is_empty() {
        return Err(LoadError::new(path, "the file has no faces")
            .help("Points alone can't be hit; triangle strips have to be stored as faces."));
    }
    Ok(mesh)
}

/// The header, and all bytes after it.
fn read_header<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Header, &'a [u8]), LoadError> {
    let mut reader = Reader::new(bytes);
    match Parser::<Skipped>::new().read_header(&mut reader) {
        Ok(header) => Ok((header, reader.into_inner())),
        Err(_) if !bytes.starts_with(b"ply") => Err(LoadError::new(path, "this is not a PLY file")),
        Err(error) => Err(LoadError::new(path, format!("damaged PLY header: {}", one_line(&error)))),
    }
}

fn one_line(error: &ParseError) -> String {
    let message = error.to_string();
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Counts are believed only as far as the file is long enough for them: nothing is reserved and
/// nothing is looped over before this.
fn check_sizes(path: &Path, header: &Header, payload: &[u8]) -> Result<(), LoadError> {
    let ascii = header.encoding == Encoding::Ascii;
    let mut needed: u128 = 0;
    for element in header.elements.values() {
        // The shortest ascii row is a digit a property and what separates it from the next.
        let row = |property: &PropertyType| match property {
            _ if ascii => 2,
            PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => size_of_scalar(scalar),
        };
        let row: u128 = element.properties.values().map(|property| row(&property.data_type)).sum();
        needed += row * element.count as u128;
        // The last row may lack its line break.
        if needed > payload.len() as u128 + u128::from(ascii) {
            let (count, name, found) = (element.count, &element.name, payload.len());
            let message = format!(
                "the file ends too early: the header announces {count} `{name}`, \
                 which takes at least {needed} bytes, but {found} follow it"
            );
            return Err(LoadError::new(path, message));
        }
    }
    Ok(())
}

fn size_of_scalar(scalar: &ScalarType) -> u128 {
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Hands over the rows of one element, in order.
fn read_rows<E: PropertyAccess>(
    path: &Path,
    header: &Header,
    element: &ElementDef,
    rest: &mut &[u8],
    mut take: impl FnMut(E, usize) -> Result<(), LoadError>,
) -> Result<(), LoadError> {
    // Such rows take no room in the file, so their count is unchecked.
    if element.properties.is_empty() {
        return Ok(());
    }
    let parser = Parser::<E>::new();
    let mut line = String::new();
    for row in 0..element.count {
        let parsed = match header.encoding {
            Encoding::BinaryLittleEndian => parser.read_little_endian_element(rest, element),
            Encoding::BinaryBigEndian => parser.read_big_endian_element(rest, element),
            Encoding::Ascii => next_line(rest, &mut line)
                .map_err(ParseError::from)
                .and_then(|()| parser.read_ascii_element(&line, element)),
        };
        let parsed = parsed.map_err(|error| {
            let (name, count) = (&element.name, element.count);
            let ends = rest.is_empty() && error.kind() == std::io::ErrorKind::UnexpectedEof;
            let what = if ends { "the file ends in the middle of it".into() } else { one_line(&error) };
            LoadError::new(path, format!("`{name}` {row} of {count} can't be read: {what}"))
        })?;
        take(parsed, row)?;
    }
    Ok(())
}

/// The next line that is not blank.
fn next_line(rest: &mut &[u8], line: &mut String) -> std::io::Result<()> {
    loop {
        line.clear();
        if rest.read_line(line)? == 0 {
            return Err(std::io::ErrorKind::UnexpectedEof.into());
        }
        if !line.trim().is_empty() {
            return Ok(());
        }
    }
}

fn read_vertices(
    path: &Path,
    header: &Header,
    element: &ElementDef,
    rest: &mut &[u8],
    mesh: &mut Mesh,
) -> Result<(), LoadError> {
    let has = |names: &[&str]| names.iter().all(|&name| element.properties.contains_key(name));
    if !has(&["x", "y", "z"]) {
        return Err(LoadError::new(path, "the vertices have no `x`, `y`, `z`"));
    }
    let has_normals = has(&["nx", "ny", "nz"]);
    let has_uvs = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]].iter().any(|pair| has(pair));
    read_rows(path, header, element, rest, |vertex: Vertex, row| {
        if !vertex.is_finite() {
            return Err(LoadError::new(path, format!("vertex {row} has a number that is not finite")));
        }
        mesh.positions.push(vertex.position);
        if has_normals {
            mesh.normals.push(vertex.normal);
        }
        if has_uvs {
            mesh.uvs.push(vertex.uv);
        }
        Ok(())
    })
}

#[derive(Default)]
struct Vertex {
    position: Vec3,
    normal: Vec3,
    uv: Vec2,
}

impl Vertex {
    fn is_finite(&self) -> bool {
        self.position.is_finite() && self.normal.is_finite() && self.uv.is_finite()
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let slot = match name {
            "x" => &mut self.position.x,
            "y" => &mut self.position.y,
            "z" => &mut self.position.z,
            "nx" => &mut self.normal.x,
            "ny" => &mut self.normal.y,
            "nz" => &mut self.normal.z,
            "u" | "s" | "texture_u" => &mut self.uv.x,
            "v" | "t" | "texture_v" => &mut self.uv.y,
            _ => return PropertyAccessResult::Ignored,
        };
        match property.to_f32_lossy() {
            Some(value) => {
                *slot = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::UnsupportedType,
        }
    }
}

#[derive(Default)]
struct Face {
    corners: Vec<u32>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        match property {
            Property::ListUInt(corners) => self.corners = corners,
            // What is negative becomes too large, and is refused for it.
            Property::ListInt(corners) => self.corners = corners.into_iter().map(|i| i as u32).collect(),
            other => match other.to_u32_list() {
                Some(corners) => self.corners = corners,
                None => return PropertyAccessResult::UnsupportedType,
            },
        }
        PropertyAccessResult::Set
    }
}

/// An element that is read over.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

/// Faces on their way to triangles.
#[derive(Default)]
struct Polygons {
    triangles: Vec<[u32; 3]>,
    largest_index: u32,
    dropped: usize,
}

impl Polygons {
    fn add(&mut self, path: &Path, face: Face, row: usize) -> Result<(), LoadError> {
        let [first, middle @ .., _] = face.corners.as_slice() else {
            self.dropped += 1;
            return Ok(());
        };
        if middle.is_empty() {
            self.dropped += 1;
            return Ok(());
        }
        for &corner in &face.corners {
            if corner > i32::MAX as u32 {
                return Err(LoadError::new(path, format!("face {row} uses vertex {}", corner as i32)));
            }
            self.largest_index = self.largest_index.max(corner);
        }
        self.triangles.extend(face.corners[1..].windows(2).map(|edge| [*first, edge[0], edge[1]]));
        Ok(())
    }
}

#[cfg(test)]
mod tests;
