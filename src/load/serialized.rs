//! Mitsuba's `.serialized` meshes to triangles. The only file that names `flate2`.
//!
//! ```text
//! for each mesh   u16 0x041C, u16 version (3 or 4), then a zlib stream of
//!                 u32 flags; version 4: name, ended by a 0; u64 vertices, u64 triangles;
//!                 positions, normals, uv, colours, as the flags say; u32 indices
//! at the end      where each mesh begins (version 4: u64, 3: u32), u32 how many there are
//! ```
//!
//! All numbers are little endian.

use std::{io::Read, path::Path};

use flate2::read::ZlibDecoder;
use glam::{Vec2, Vec3};

use super::{LoadError, text};
use crate::scene::Mesh;

const MAGIC: u16 = 0x041C;
const HEADER: usize = 4;

const NORMALS: u32 = 0x0001;
const UVS: u32 = 0x0002;
const COLOURS: u32 = 0x0008;
const FACE_NORMALS: u32 = 0x0010;
const DOUBLE: u32 = 0x2000;

/// No deflate stream grows by more than this.
const MAX_EXPANSION: u128 = 1032;

/// Bytes of a name: more is a stream that is something else.
const MAX_NAME: usize = 4096;

/// A mesh, and whether the file asks for it to be shaded flat.
#[derive(Clone, Debug, Default)]
pub(super) struct Serialized {
    pub(super) mesh: Mesh,
    pub(super) face_normals: bool,
}

/// Reads one mesh of the file; uv is as in the file.
pub(super) fn read_mesh(path: &Path, index: u32) -> Result<Serialized, LoadError> {
    let bytes = text::read_bytes(path)?;
    let refuse = |message: String| LoadError::new(path, message);
    let version = header(&bytes).map_err(refuse)?;
    let start = offset(&bytes, version, index).map_err(refuse)?;
    let own = bytes.get(start..).unwrap_or_default();
    header(own).map_err(|why| refuse(format!("mesh {index} begins at byte {start}, but {why}")))?;
    let packed = &own[HEADER..];
    let mut stream = Stream { inner: ZlibDecoder::new(packed), packed: packed.len(), done: 0 };
    stream.mesh(version).map_err(|why| refuse(format!("mesh {index}: {why}")))
}

/// The version of a mesh.
fn header(bytes: &[u8]) -> Result<u16, String> {
    match *bytes {
        [a, b, c, d, ..] if u16::from_le_bytes([a, b]) == MAGIC => match u16::from_le_bytes([c, d]) {
            version @ (3 | 4) => Ok(version),
            other => Err(format!("version {other} of the format is not known; 3 and 4 are")),
        },
        _ => Err("this is not a mesh as Mitsuba serializes it".into()),
    }
}

/// Where a mesh begins.
fn offset(bytes: &[u8], version: u16, index: u32) -> Result<usize, String> {
    // The first one needs no dictionary, and in some files there is none.
    if index == 0 {
        return Ok(0);
    }
    let (entries, count) = bytes.split_last_chunk::<4>().ok_or("the file ends in its header")?;
    let count = u32::from_le_bytes(*count);
    if index >= count {
        return Err(format!("there is no mesh {index}: the file has {count}, counted from 0"));
    }
    let width = if version == 4 { 8 } else { 4 };
    let from_end = (count - index) as usize * width;
    let start = entries.len().checked_sub(from_end);
    let entry = start.and_then(|start| entries.get(start..start + width));
    let entry =
        entry.ok_or_else(|| format!("the list of {count} meshes at its end does not fit into the file"))?;
    let mut wide = [0; 8];
    wide[..width].copy_from_slice(entry);
    Ok(usize::try_from(u64::from_le_bytes(wide)).unwrap_or(usize::MAX))
}

/// A mesh as it is unpacked.
struct Stream<'a> {
    inner: ZlibDecoder<&'a [u8]>,
    /// Bytes that it was packed into, at most.
    packed: usize,
    /// Bytes unpacked.
    done: usize,
}

impl Stream<'_> {
    fn mesh(&mut self, version: u16) -> Result<Serialized, String> {
        let flags = u32::from_le_bytes(self.array("the flags")?);
        if version == 4 {
            self.skip_name()?;
        }
        let vertices = u64::from_le_bytes(self.array("the number of vertices")?);
        let triangles = u64::from_le_bytes(self.array("the number of triangles")?);
        let has = |flag| flags & flag != 0;
        let double = has(DOUBLE);
        let scalar: u128 = if double { 8 } else { 4 };
        let columns =
            3 + 3 * u128::from(has(NORMALS)) + 2 * u128::from(has(UVS)) + 3 * u128::from(has(COLOURS));
        let needed = u128::from(vertices) * columns * scalar + u128::from(triangles) * 12;
        // Before any memory is taken for it.
        if needed > self.packed as u128 * MAX_EXPANSION || vertices > u64::from(u32::MAX) {
            return Err(format!(
                "it announces {vertices} vertices and {triangles} triangles, \
                 more than the {} bytes that follow can hold",
                self.packed
            ));
        }
        let vertices = vertices as usize;
        let mut mesh = Mesh { positions: self.vectors(vertices, double, "positions")?, ..Mesh::default() };
        if has(NORMALS) {
            mesh.normals = self.vectors(vertices, double, "normals")?;
        }
        if has(UVS) {
            let uvs = self.floats(vertices * 2, double, "texture coordinates")?;
            mesh.uvs = uvs.chunks_exact(2).map(Vec2::from_slice).collect();
        }
        if has(COLOURS) {
            self.floats(vertices * 3, double, "colours")?;
        }
        let indices = self.bytes(triangles as usize * 12, "triangles")?;
        let indices: Vec<u32> =
            indices.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        if let Some(wrong) = indices.iter().find(|&&index| index as usize >= vertices) {
            return Err(format!("a triangle uses vertex {wrong}, but there are only {vertices}"));
        }
        if indices.is_empty() {
            return Err("it has no triangles".into());
        }
        mesh.triangles = indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
        Ok(Serialized { mesh, face_normals: has(FACE_NORMALS) })
    }

    fn skip_name(&mut self) -> Result<(), String> {
        for _ in 0..=MAX_NAME {
            if self.array::<1>("the name")? == [0] {
                return Ok(());
            }
        }
        Err(format!("its name has more than {MAX_NAME} bytes"))
    }

    fn vectors(&mut self, count: usize, double: bool, what: &str) -> Result<Vec<Vec3>, String> {
        Ok(self.floats(count * 3, double, what)?.chunks_exact(3).map(Vec3::from_slice).collect())
    }

    fn floats(&mut self, count: usize, double: bool, what: &str) -> Result<Vec<f32>, String> {
        let bytes = self.bytes(count * if double { 8 } else { 4 }, what)?;
        let floats: Vec<f32> = if double {
            let wide = bytes
                .chunks_exact(8)
                .map(|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]));
            wide.map(|x| x as f32).collect()
        } else {
            bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
        };
        match floats.iter().position(|x| !x.is_finite()) {
            Some(place) => Err(format!("number {place} of its {what} is not finite")),
            None => Ok(floats),
        }
    }

    fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N], String> {
        let bytes = self.bytes(N, what)?;
        bytes.try_into().map_err(|_| format!("it ends in {what}"))
    }

    /// As many bytes, in memory that grows only as they come.
    fn bytes(&mut self, count: usize, what: &str) -> Result<Vec<u8>, String> {
        let mut bytes = Vec::new();
        let read = self.inner.by_ref().take(count as u64).read_to_end(&mut bytes);
        self.done += bytes.len();
        match read {
            Ok(_) if bytes.len() == count => Ok(bytes),
            Ok(_) => Err(format!("it ends in {what}, after {} bytes", self.done)),
            Err(error) => Err(format!("{what} can't be unpacked after {} bytes: {error}", self.done)),
        }
    }
}

#[cfg(test)]
mod tests;
