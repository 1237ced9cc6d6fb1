//! Wavefront OBJ to triangles. The only file that names `tobj`.

use std::{collections::HashMap, path::Path};

use glam::{Vec2, Vec3};

use super::{
    LoadError, Warning,
    obj_text::{self, Run},
};
use crate::scene::Mesh;

/// The triangles of one material.
#[derive(Debug)]
pub(super) struct Part {
    /// The name after `usemtl`.
    pub(super) material: Option<String>,
    /// With vertices of its own.
    pub(super) mesh: Mesh,
}

/// Reads all faces as one mesh; groups and materials are ignored, uv is as in the file.
pub(super) fn read_mesh(path: &Path, warnings: &mut Vec<Warning>) -> Result<Mesh, LoadError> {
    let text = obj_text::read(path, warnings)?;
    parse(path, &text)
}

/// Reads one mesh a material, in the order of their first faces, and the names of the material
/// libraries.
pub(super) fn read_parts(
    path: &Path,
    warnings: &mut Vec<Warning>,
) -> Result<(Vec<Part>, Vec<String>), LoadError> {
    let text = obj_text::read(path, warnings)?;
    let mesh = parse(path, &text)?;
    Ok((split(&mesh, &text.runs), text.libraries))
}

fn parse(path: &Path, text: &obj_text::ObjText) -> Result<Mesh, LoadError> {
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) =
        tobj::load_obj_buf(&mut text.geometry.as_bytes(), &tobj::GPU_LOAD_OPTIONS, no_materials)
            .map_err(|error| LoadError::new(path, error.to_string()))?;
    let mut mesh = Mesh::default();
    // Without groups in the text there is one model.
    for tobj::Model { mesh: model, .. } in models {
        mesh.positions = model.positions.chunks_exact(3).map(Vec3::from_slice).collect();
        mesh.triangles =
            model.indices.chunks_exact(3).map(|corner| [corner[0], corner[1], corner[2]]).collect();
        if text.normals.is_full() {
            mesh.normals = model.normals.chunks_exact(3).map(Vec3::from_slice).collect();
        }
        if text.uvs.is_any() {
            mesh.uvs = model.texcoords.chunks_exact(2).map(Vec2::from_slice).collect();
        }
    }
    Ok(mesh)
}

fn split(mesh: &Mesh, runs: &[Run]) -> Vec<Part> {
    let mut order: Vec<(Option<String>, Vec<[u32; 3]>)> = Vec::new();
    let mut places: HashMap<&Option<String>, usize> = HashMap::new();
    let mut rest = mesh.triangles.as_slice();
    for run in runs {
        let (these, others) = rest.split_at(run.triangles.min(rest.len()));
        rest = others;
        let place = *places.entry(&run.material).or_insert_with(|| {
            order.push((run.material.clone(), Vec::new()));
            order.len() - 1
        });
        order[place].1.extend_from_slice(these);
    }
    let parts = order.into_iter();
    parts.map(|(material, triangles)| Part { material, mesh: extract(mesh, triangles) }).collect()
}

/// The vertices that some triangles use, in the order of their use, and the triangles.
fn extract(mesh: &Mesh, mut triangles: Vec<[u32; 3]>) -> Mesh {
    let mut part = Mesh::default();
    let mut renamed: HashMap<u32, u32> = HashMap::new();
    for index in triangles.iter_mut().flatten() {
        let next = part.positions.len() as u32;
        *index = *renamed.entry(*index).or_insert_with(|| {
            let old = *index as usize;
            part.positions.push(mesh.positions[old]);
            part.normals.extend(mesh.normals.get(old));
            part.uvs.extend(mesh.uvs.get(old));
            next
        });
    }
    part.triangles = triangles;
    part
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn load(text: impl AsRef<[u8]>) -> (Result<Mesh, String>, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        fs::write(&path, text).unwrap();
        let mut warnings = Vec::new();
        let mesh = read_mesh(&path, &mut warnings);
        let relative =
            |text: String| text.rsplit_once("a.obj").map_or(text.clone(), |(_, end)| end.to_owned());
        (
            mesh.map_err(|error| relative(error.to_string())),
            warnings.into_iter().map(|warning| warning.message().to_owned()).collect(),
        )
    }

    fn mesh(text: &str) -> Mesh {
        let (mesh, warnings) = load(text);
        assert!(warnings.is_empty(), "{warnings:?}");
        mesh.unwrap()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn polygons_are_fans_and_corners_stay_shared() {
        let mesh = mesh(&format!("{SQUARE}v -1 .5 0\nf 1 2 3 4 5\n"));
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(mesh.positions.len(), 5);
        assert_eq!(mesh.positions[4], Vec3::new(-1.0, 0.5, 0.0));
        assert!(mesh.normals.is_empty() && mesh.uvs.is_empty());
    }

    #[test]
    fn groups_do_not_cut_the_mesh() {
        let mesh = mesh(&format!("{SQUARE}g a\nf 1 2 3\ng b\nusemtl x\nf 1 3 4\n"));
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn indices_may_be_negative_or_ahead() {
        let expected = mesh(&format!("{SQUARE}f 1 2 3 4\n"));
        assert_eq!(mesh(&format!("{SQUARE}f -4 -3 -2 -1\n")), expected);
        assert_eq!(mesh(&format!("f 1 2 3 4\n{SQUARE}")), expected);
    }

    #[test]
    fn all_forms_of_corners() {
        let attributes = "vt 0.25 0.5\nvt 0.75\nvn 0 0 2\n";
        let full = mesh(&format!("{SQUARE}{attributes}f 1/1/1 2/2/1 3/2/-1\n"));
        assert_eq!(full.uvs, [Vec2::new(0.25, 0.5), Vec2::new(0.75, 0.0), Vec2::new(0.75, 0.0)]);
        assert_eq!(full.normals, [Vec3::new(0.0, 0.0, 2.0); 3]);
        let uvs = mesh(&format!("{SQUARE}{attributes}f 1/1 2/2 3/2\n"));
        assert_eq!((uvs.uvs, uvs.normals.len()), (full.uvs, 0));
        let normals = mesh(&format!("{SQUARE}{attributes}f 1//1 2//1 3//1\n"));
        assert_eq!((normals.uvs.len(), normals.normals), (0, full.normals));
    }

    #[test]
    fn faces_with_and_without_attributes_mix() {
        let (mesh, warnings) = load(format!("{SQUARE}vt .5 .5\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\nf 1 3 4\n"));
        let mesh = mesh.unwrap();
        assert_eq!(mesh.uvs[..4], [Vec2::splat(0.5), Vec2::splat(0.5), Vec2::splat(0.5), Vec2::ZERO]);
        assert_eq!((mesh.positions.len(), mesh.uvs.len(), mesh.normals.len()), (6, 6, 0));
        assert_eq!(warnings.len(), 2, "{warnings:?}");
    }

    #[test]
    fn comments_colours_continuations_and_carriage_returns() {
        let text = "v 0 0 0 1 0.5 nan\r\nv 1 0 0 # east\r\nv \\\r\n1 1 0 1 1 1 1\r\nf 1 2 \\\r\n3 # one\r\n";
        assert_eq!(mesh(text).triangles.len(), 1);
    }

    #[test]
    fn mistakes_have_a_line_and_a_column() {
        for (tail, expected) in [
            ("v 1 nan 0\nf 1 2 3\n", ":5:5: `nan` is not a finite number"),
            ("v 1 2 1e39\nf 1 2 3\n", ":5:7: `1e39` is not a finite number"),
            ("v 1 2,0 3\nf 1 2 3\n", ":5:5: expected a number, found `2,0`"),
            ("v 1 2\nf 1 2 3\n", ":5:1: `v` needs 3 numbers, found 2"),
            ("f 1 2 5\n", ":5:7: index 5, but the file has 4 `v`"),
            ("f 1/1 2/1 3/1\n", ":5:5: index 1, but the file has 0 `vt`"),
            ("f 1 2 -5\n", ":5:7: index -5, but only 4 `v` stand before it"),
            ("f 1 2 0\n", ":5:7: index 0: OBJ counts from 1"),
            ("f 1 2 x\n", ":5:7: expected a corner `v/vt/vn`, found `x`"),
            ("f 1 2 1/2/3/4\n", ":5:7: expected a corner `v/vt/vn`, found `1/2/3/4`"),
            ("f 1 2 //1\n", ":5:7: the corner `//1` has no vertex"),
            ("l 1 2\n", ": the file has no faces; it has only lines or points, which can't be hit"),
            ("", ": the file has no faces"),
            ("f 1 2 9223372036854775807\n", ":5:7: index 9223372036854775807, but the file has 4 `v`"),
            ("f 1 2 \\\n 7\n", ":6:2: index 7, but the file has 4 `v`"),
        ] {
            let error = load(format!("{SQUARE}{tail}")).0.unwrap_err();
            assert!(error.starts_with(expected), "{tail:?}: {error}");
        }
    }

    #[test]
    fn other_encodings() {
        let utf16: Vec<u8> = "\u{feff}v 0 0 0\n".encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!(load(utf16).0.unwrap_err(), ": the file is UTF-16 text");
        let latin1 = [b"# caf\xe9\n".as_slice(), SQUARE.as_bytes(), b"f 1 2 3\n"].concat();
        assert_eq!(load(latin1).0.unwrap().triangles.len(), 1);
    }

    #[test]
    fn faces_without_area_to_speak_of_are_dropped() {
        let (mesh, warnings) = load(format!("{SQUARE}f 1 2\nf 1 2 3\n"));
        assert_eq!(mesh.unwrap().triangles.len(), 1);
        assert_eq!(warnings, ["1 faces with fewer than 3 corners were dropped"]);
    }

    #[test]
    fn parts_follow_the_materials() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.obj");
        let faces = "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\nusemtl red\nf 2 3 4 1\n";
        fs::write(&path, format!("mtllib my colours.mtl\n{SQUARE}{faces}")).unwrap();
        let (parts, libraries) = read_parts(&path, &mut Vec::new()).unwrap();
        assert_eq!(libraries, ["my colours.mtl"]);
        let summary: Vec<_> = parts
            .iter()
            .map(|part| (part.material.as_deref(), part.mesh.triangles.len(), part.mesh.positions.len()))
            .collect();
        assert_eq!(summary, [(Some("red"), 3, 4), (Some("blue"), 1, 3)]);
        assert_eq!(parts[1].mesh.triangles, [[0, 1, 2]]);
        assert_eq!(parts[1].mesh.positions[2], Vec3::new(0.0, 1.0, 0.0));
    }
}
