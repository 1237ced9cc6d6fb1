use std::{fs, io::Write};

use flate2::{Compression, write::ZlibEncoder};

use super::*;

/// One mesh before it is packed.
struct Source {
    flags: u32,
    name: &'static str,
    counts: [u64; 2],
    numbers: Vec<f64>,
    indices: Vec<u32>,
}

impl Default for Source {
    fn default() -> Self {
        Self {
            flags: NORMALS | UVS | COLOURS | 0x1000,
            name: "a triangle",
            counts: [3, 1],
            numbers: (0..33).map(f64::from).collect(),
            indices: vec![2, 1, 0],
        }
    }
}

impl Source {
    fn encode(&self, version: u16) -> Vec<u8> {
        let mut stream = ZlibEncoder::new(Vec::new(), Compression::fast());
        stream.write_all(&self.flags.to_le_bytes()).unwrap();
        if version == 4 {
            stream.write_all(self.name.as_bytes()).unwrap();
            stream.write_all(&[0]).unwrap();
        }
        for count in self.counts {
            stream.write_all(&count.to_le_bytes()).unwrap();
        }
        for &number in &self.numbers {
            match self.flags & DOUBLE != 0 {
                true => stream.write_all(&number.to_le_bytes()).unwrap(),
                false => stream.write_all(&(number as f32).to_le_bytes()).unwrap(),
            }
        }
        for index in &self.indices {
            stream.write_all(&index.to_le_bytes()).unwrap();
        }
        let mut bytes = [MAGIC.to_le_bytes(), version.to_le_bytes()].concat();
        bytes.extend(stream.finish().unwrap());
        bytes
    }
}

fn file(meshes: &[Vec<u8>], version: u16) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut dictionary = Vec::new();
    for mesh in meshes {
        match version {
            4 => dictionary.extend((bytes.len() as u64).to_le_bytes()),
            _ => dictionary.extend((bytes.len() as u32).to_le_bytes()),
        }
        bytes.extend_from_slice(mesh);
    }
    bytes.extend(dictionary);
    bytes.extend((meshes.len() as u32).to_le_bytes());
    bytes
}

fn read(bytes: &[u8], index: u32) -> Result<Serialized, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.serialized");
    fs::write(&path, bytes).unwrap();
    read_mesh(&path, index).map_err(|error| {
        let line = error.to_string();
        line.split_once("m.serialized: ").expect(&line).1.to_owned()
    })
}

#[track_caller]
fn assert_refused(bytes: &[u8], index: u32, expected: &str) {
    let found = read(bytes, index).expect_err(expected);
    assert!(found.starts_with(expected), "   found {found}\nexpected {expected}");
}

#[test]
fn both_versions_and_both_precisions_read_alike() {
    for version in [3, 4] {
        for precision in [0x1000, DOUBLE] {
            let source = Source { flags: NORMALS | UVS | COLOURS | precision, ..Source::default() };
            let Serialized { mesh, face_normals } =
                read(&file(&[source.encode(version)], version), 0).unwrap();
            assert_eq!(
                mesh.positions,
                [Vec3::new(0.0, 1.0, 2.0), Vec3::new(3.0, 4.0, 5.0), Vec3::new(6.0, 7.0, 8.0)]
            );
            assert_eq!(mesh.normals[2], Vec3::new(15.0, 16.0, 17.0));
            assert_eq!(mesh.uvs, [Vec2::new(18.0, 19.0), Vec2::new(20.0, 21.0), Vec2::new(22.0, 23.0)]);
            assert_eq!(mesh.triangles, [[2, 1, 0]]);
            assert!(!face_normals);
        }
    }
}

#[test]
fn each_mesh_is_found_by_its_index() {
    for version in [3, 4] {
        let mesh = |flags, x: f64| {
            let numbers = (0..9).map(|i| x + f64::from(i)).collect();
            Source { flags, numbers, ..Source::default() }.encode(version)
        };
        let bytes = file(&[mesh(0, 0.0), mesh(FACE_NORMALS, 100.0), mesh(0, 200.0)], version);
        for (index, x) in [(0, 0.0), (1, 100.0), (2, 200.0)] {
            let found = read(&bytes, index).unwrap();
            assert_eq!(found.mesh.positions[0].x, x);
            assert_eq!(found.face_normals, index == 1);
            assert!(found.mesh.normals.is_empty() && found.mesh.uvs.is_empty());
        }
        assert_refused(&bytes, 3, "there is no mesh 3: the file has 3, counted from 0");
    }
}

#[test]
fn counts_are_checked_before_memory_is_taken() {
    for counts in [[1 << 40, 1], [3, u64::MAX], [u64::MAX, u64::MAX], [100_000, 1]] {
        let source = Source { counts, ..Source::default() };
        let [vertices, triangles] = counts;
        assert_refused(
            &source.encode(4),
            0,
            &format!("mesh 0: it announces {vertices} vertices and {triangles} triangles, more than the "),
        );
    }
}

#[test]
fn damaged_files_are_refused() {
    let good = file(&[Source::default().encode(4)], 4);
    assert_refused(b"ply", 0, "this is not a mesh as Mitsuba serializes it");
    assert_refused(b"", 0, "this is not a mesh as Mitsuba serializes it");
    assert_refused(&[0x1C, 4, 9, 0], 0, "version 9 of the format is not known; 3 and 4 are");
    assert_refused(
        &good[..HEADER],
        0,
        "mesh 0: the flags can't be unpacked after 0 bytes: incomplete deflate stream",
    );
    assert_refused(&good[..40], 0, "mesh 0: ");
    let mut astray = file(&[Source::default().encode(4), Source::default().encode(4)], 4);
    let entry = astray.len() - 12;
    astray[entry..entry + 8].copy_from_slice(&u64::MAX.to_le_bytes());
    assert_refused(&astray, 1, &format!("mesh 1 begins at byte {}, but this is not a mesh", u64::MAX));
    let mut many = good.clone();
    let count = many.len() - 4;
    many[count..].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_refused(&many, 1, "the list of 4294967295 meshes at its end does not fit into the file");

    let refused = |source: Source, expected: &str| assert_refused(&source.encode(4), 0, expected);
    let short = Source { numbers: vec![1.0; 20], indices: Vec::new(), ..Source::default() };
    refused(short, "mesh 0: it ends in texture coordinates, after 111 bytes");
    let stray = Source { indices: vec![0, 1, 3], ..Source::default() };
    refused(stray, "mesh 0: a triangle uses vertex 3, but there are only 3");
    let empty = Source { counts: [3, 0], indices: Vec::new(), ..Source::default() };
    refused(empty, "mesh 0: it has no triangles");
    let endless = Source { name: "x".repeat(5000).leak(), ..Source::default() };
    refused(endless, "mesh 0: its name has more than 4096 bytes");
    let mut infinite = Source::default();
    infinite.numbers[4] = f64::INFINITY;
    refused(infinite, "mesh 0: number 4 of its positions is not finite");
}

#[test]
fn no_cut_of_a_file_panics() {
    let bytes = file(&[Source::default().encode(4), Source::default().encode(4)], 4);
    for end in 0..bytes.len() {
        for index in 0..3 {
            let _ = read(&bytes[..end], index);
        }
    }
}
