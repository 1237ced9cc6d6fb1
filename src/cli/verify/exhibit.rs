//! A fault on disk: a mesh, rays, and the command that shows it again.

use std::{fmt::Write, fs, path::Path};

use glam::Vec3;
use serde::Serialize;

use crate::{
    cli::failure::Failure,
    geometry::ray_file::encode,
    verify::{Exhibit, Expected},
};

/// What was written.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Written {
    pub(super) what: String,
    pub(super) triangles: usize,
    pub(super) rays: usize,
    pub(super) command: String,
}

/// Writes `failure.obj`, if the fault shows on triangles alone, and `failure.rays`.
pub(super) fn write(
    exhibit: &Exhibit,
    folder: &Path,
    (scene, options): (&Path, String),
) -> Result<Written, Failure> {
    let told = |error| Failure::Sentence(format!("can't write into {}: {error}", folder.display()));
    fs::create_dir_all(folder).map_err(told)?;
    let (mesh, rays) = (folder.join("failure.obj"), folder.join("failure.rays"));
    fs::write(&rays, encode(&exhibit.rays)).map_err(told)?;
    let (scene, options) = if exhibit.triangles.is_empty() {
        (scene.to_owned(), options)
    } else {
        fs::write(&mesh, obj(&exhibit.triangles)).map_err(told)?;
        (mesh, String::new())
    };
    let expect = match exhibit.expected {
        Some(Expected::Hit) => " --expect hit",
        Some(Expected::Miss) => " --expect miss",
        None => "",
    };
    let command = format!("packlight verify {}{options} --rays {}{expect}", scene.display(), rays.display());
    let (triangles, rays) = (exhibit.triangles.len(), exhibit.rays.len());
    Ok(Written { what: exhibit.what.clone(), triangles, rays, command })
}

/// Numbers are written so that they are read to the same bits.
fn obj(triangles: &[[Vec3; 3]]) -> String {
    let mut text = String::new();
    for Vec3 { x, y, z } in triangles.iter().flatten() {
        // Writing into a string can't fail.
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    for i in 0..triangles.len() {
        let _ = writeln!(text, "f {} {} {}", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Ray32, ray_file::RayFile};
    use crate::load::load_mesh;

    #[test]
    fn what_is_written_is_read_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let triangles = vec![[
            Vec3::new(0.1, -1.5e-38, 1e30),
            Vec3::splat(1.0 / 3.0),
            Vec3::new(-0.0, 16_777_217.0, 7.0),
        ]];
        let rays = vec![Ray32::new(Vec3::splat(0.7), Vec3::splat(1e-30), 0.0, f32::INFINITY)];
        let exhibit = Exhibit {
            what: "so".into(),
            triangles: triangles.clone(),
            rays: rays.clone(),
            expected: Some(Expected::Hit),
        };
        let written = write(&exhibit, folder.path(), (Path::new("a.xml"), String::new())).unwrap();
        assert!(written.command.ends_with("failure.rays --expect hit"), "{}", written.command);
        let (mesh, _) = load_mesh(&folder.path().join("failure.obj")).unwrap();
        let bits = |v: &[Vec3]| v.iter().map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(&mesh.positions), bits(&triangles[0]));
        let bytes = fs::read(folder.path().join("failure.rays")).unwrap();
        assert_eq!(RayFile::decode(&bytes).unwrap().rays, rays);

        let whole = Exhibit { triangles: vec![], expected: None, ..exhibit };
        let written = write(&whole, folder.path(), (Path::new("a.xml"), " -D a=1".into())).unwrap();
        assert!(written.command.starts_with("packlight verify a.xml -D a=1 --rays"), "{}", written.command);
    }
}
