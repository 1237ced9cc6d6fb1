use std::fs;

use super::*;

fn load(bytes: impl AsRef<[u8]>) -> (Result<Mesh, String>, Vec<Warning>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.ply");
    fs::write(&path, bytes).unwrap();
    let mut warnings = Vec::new();
    (read_mesh(&path, &mut warnings).map_err(|error| error.to_string()), warnings)
}

fn header(format: &str, vertices: usize, faces: usize) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by hand\nelement vertex {vertices}\nproperty float x\n\
         property double y\nproperty float z\nproperty float s\nproperty float t\nproperty uchar red\n\
         element face {faces}\nproperty list uchar int vertex_indices\nproperty uchar flags\nend_header\n"
    )
}

const POINTS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.25], [1.0, 1.0, 0.0], [0.0, 1.0, -3.0]];

/// A square of one face: the same in all three encodings.
fn square(format: &str) -> Vec<u8> {
    let mut bytes = header(format, 4, 1).into_bytes();
    let big = format == "binary_big_endian";
    let float = |f: f32| if big { f.to_be_bytes() } else { f.to_le_bytes() };
    let double = |f: f64| if big { f.to_be_bytes() } else { f.to_le_bytes() };
    let int = |i: i32| if big { i.to_be_bytes() } else { i.to_le_bytes() };
    if format == "ascii" {
        for [x, y, z] in POINTS {
            bytes.extend(format!("{x} {y} {z} {x} {y} 255\n").bytes());
        }
        bytes.extend(b"4 0 1 2 3 0");
        return bytes;
    }
    for [x, y, z] in POINTS {
        bytes.extend(float(x));
        bytes.extend(double(y.into()));
        bytes.extend([z, x, y].into_iter().flat_map(float));
        bytes.push(255);
    }
    bytes.push(4);
    bytes.extend((0..4).flat_map(int));
    bytes.push(0);
    bytes
}

const FORMATS: [&str; 3] = ["ascii", "binary_little_endian", "binary_big_endian"];

#[test]
fn the_three_encodings_agree() {
    for format in FORMATS {
        let mesh = load(square(format)).0.unwrap();
        assert_eq!(mesh.positions, POINTS.map(Vec3::from), "{format}");
        assert_eq!(mesh.uvs, POINTS.map(|[x, y, _]| Vec2::new(x, y)), "{format}");
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]], "{format}");
        assert!(mesh.normals.is_empty());
    }
}

#[test]
fn every_truncation_is_an_error() {
    for format in FORMATS {
        let bytes = square(format);
        for length in 0..bytes.len() {
            let error = load(&bytes[..length]).0.expect_err("a part is not a whole");
            assert!(error.contains("a.ply: "), "{error}");
        }
    }
    let error = load(&square("binary_little_endian")[..300]).0.unwrap_err();
    assert!(error.contains("the header announces 4 `vertex`, which takes at least 100 bytes"), "{error}");
}

#[test]
fn absurd_counts_are_refused_at_once() {
    for format in FORMATS {
        for (vertices, faces) in [(usize::MAX, 1), (4, usize::MAX), (1 << 40, 1 << 40)] {
            let error = load(header(format, vertices, faces)).0.unwrap_err();
            assert!(error.contains("the file ends too early"), "{error}");
        }
    }
    // Rows without properties take no bytes: any count of them would fit.
    let empty_rows = square("ascii");
    let text = String::from_utf8(empty_rows).unwrap();
    let text = text.replace("end_header", "element nothing 18446744073709551615\nend_header");
    assert!(load(text).0.is_ok());
}

#[test]
fn normals_and_all_names_of_texture_coordinates() {
    for [u, v] in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]] {
        let names = ["x", "y", "z", "nx", "ny", "nz", u, v].map(|name| format!("property float {name}\n"));
        let mesh = load(format!(
            "ply\nformat ascii 1.0\nelement vertex 3\n{}element face 1\n\
             property list uchar uint vertex_index\nend_header\n\
             0 0 0 0 0 1 0.5 1\n1 0 0 0 0 2 0.5 1\n0 1 0 0 0 3 0.5 1\n3 0 1 2\n",
            names.concat()
        ))
        .0
        .unwrap();
        assert_eq!(mesh.normals[2], Vec3::new(0.0, 0.0, 3.0));
        assert_eq!(mesh.uvs, [Vec2::new(0.5, 1.0); 3]);
    }
}

fn ascii(rows: &str, vertices: usize, faces: usize) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty double x\nproperty double y\n\
         property double z\nelement face {faces}\nproperty list int int vertex_indices\nend_header\n{rows}"
    )
}

#[test]
fn wrong_rows_are_named() {
    let points = "0 0 0\n1 0 0\n0 1 0\n";
    for (rows, vertices, faces, expected) in [
        (format!("{points}3 0 1 3\n"), 3, 1, "a face uses vertex 3, but there are only 3"),
        (format!("{points}3 0 1 -1\n"), 3, 1, "face 0 uses vertex -1"),
        (format!("{points}3 0 1\n"), 3, 1, "`face` 0 of 1 can't be read"),
        (format!("{points}-3 0 1 2\n"), 3, 1, "`face` 0 of 1 can't be read"),
        (format!("{points}2000000000 0 1 2\n"), 3, 1, "`face` 0 of 1 can't be read"),
        ("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n".into(), 3, 1, "`vertex` 1 of 3 can't be read"),
        ("0 0 0\n1 1e300 0\n0 1 0\n3 0 1 2\n".into(), 3, 1, "vertex 1 has a number that is not finite"),
        (points.into(), 3, 0, "the file has no faces"),
        ("3 0 1 2\n".into(), 0, 1, "a face uses vertex 2, but there are only 0"),
    ] {
        let error = load(ascii(&rows, vertices, faces)).0.unwrap_err();
        assert!(error.contains(expected), "{rows:?}: {error}");
    }
}

#[test]
fn faces_of_two_corners_are_dropped_and_degenerate_ones_stay() {
    let (mesh, warnings) = load(ascii("0 0 0\n\n1 0 0\n0 1 0\n2 0 1\n3 1 1 1\n0\n", 3, 3));
    assert_eq!(mesh.unwrap().triangles, [[1, 1, 1]]);
    assert_eq!(warnings[0].message(), "2 faces with fewer than 3 corners were dropped");
}

#[test]
fn other_files_are_not_ply() {
    let error = load("solid cube\n").0.unwrap_err();
    assert!(error.ends_with("a.ply: this is not a PLY file"), "{error}");
    let error = load("ply\nformat ascii 1.0\nelement vertex many\nend_header\n").0.unwrap_err();
    assert!(error.contains("damaged PLY header: Line 3: "), "{error}");
}
