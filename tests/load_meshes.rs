//! Meshes from the wild: each loads with the triangles it is known to have, or is refused in words.

use std::{
    fs,
    path::{Path, PathBuf},
};

use packlight::{
    load::{LoadOptions, Loaded, load},
    picture::{Encoding, decode},
    scene::{Geometry, Material, Mesh, Texture},
};

fn scenes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    if !folder.is_dir() {
        println!("skipped: {} is missing", folder.display());
        return None;
    }
    Some(folder)
}

fn load_bare(path: &Path) -> Loaded {
    load(path, &LoadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn meshes(loaded: &Loaded) -> impl Iterator<Item = &Mesh> {
    loaded.description.shapes.iter().map(|shape| match &shape.geometry {
        Geometry::Mesh { mesh, .. } => mesh.as_ref(),
        other => panic!("a bare mesh became {other:?}"),
    })
}

fn triangles(loaded: &Loaded) -> usize {
    meshes(loaded).map(|mesh| mesh.triangles.len()).sum()
}

/// What `scene` promises to everything behind the door.
fn check(loaded: &Loaded) {
    assert!(triangles(loaded) > 0);
    for mesh in meshes(loaded) {
        let vertices = mesh.positions.len();
        assert!(mesh.normals.is_empty() || mesh.normals.len() == vertices);
        assert!(mesh.uvs.is_empty() || mesh.uvs.len() == vertices);
        assert!(mesh.triangles.iter().flatten().all(|&index| (index as usize) < vertices));
        assert!(mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite()));
        assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
    }
    let sensor = &loaded.description.sensor;
    assert!(sensor.to_world.is_finite() && 0.0 < sensor.near_clip && sensor.near_clip < sensor.far_clip);
}

#[test]
fn known_meshes_have_their_triangles() {
    let Some(scenes) = scenes() else { return };
    for (file, expected) in [
        ("meshes/stanford-bunny.obj", 69_451),
        ("meshes/dragon.ply", 871_414),
        ("meshes/dragon_res2.ply", 202_520),
        ("meshes/armadillo.ply", 52_000),
        ("meshes/spot.obj", 5_856),
        ("meshes/spot_quadrangulated.obj", 5_856),
        ("meshes/suzanne.obj", 968),
        ("meshes/teapot.obj", 6_320),
        ("meshes/kitchen.ply", 56_939),
        ("meshes/sponza.ply", 66_445),
        ("awkward/furball_ribbons.ply", 113_880),
        ("awkward/anchor_dense.ply", 7_598),
        ("awkward/oblong.ply", 840),
        ("awkward/boeing.ply", 2_564),
        ("awkward/cheese.ply", 17_786),
        ("awkward/cylinder_locally_refined.ply", 16_442),
        ("awkward/mech_holes_shark.ply", 10_192),
        ("awkward/degtri_sliding.ply", 8),
        ("awkward/tetra_intersected_by_triangle.ply", 5),
    ] {
        let started = std::time::Instant::now();
        let loaded = load_bare(&scenes.join(file));
        println!("{file}: {:.3} s", started.elapsed().as_secs_f64());
        assert_eq!(triangles(&loaded), expected, "{file}");
        check(&loaded);
    }
}

#[test]
fn sponza_keeps_its_materials_and_textures() {
    let Some(scenes) = scenes() else { return };
    let loaded = load_bare(&scenes.join("sponza/sponza.obj"));
    check(&loaded);
    assert_eq!(triangles(&loaded), 66_445);
    assert_eq!(loaded.description.shapes.len(), 19);
    let textured = loaded.description.materials.iter().filter(|material| {
        let Material::TwoSided { front, .. } = material else { panic!("{material:?} is one-sided") };
        matches!(
            &**front,
            Material::Diffuse { reflectance: Texture::Bitmap { .. } }
                | Material::Phong { diffuse_reflectance: Texture::Bitmap { .. }, .. }
        )
    });
    assert_eq!(textured.count(), 17, "{:?}", loaded.warnings);
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
}

fn files_below(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(files_below(&path, extensions));
        } else if path.extension().is_some_and(|e| extensions.iter().any(|wanted| e == *wanted)) {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn malformed_files_load_or_are_refused_in_words() {
    let Some(scenes) = scenes() else { return };
    let files = files_below(&scenes.join("malformed"), &["obj", "ply"]);
    assert!(files.len() > 15, "only {} files", files.len());
    for path in files {
        match load(&path, &LoadOptions::default()) {
            Ok(loaded) => {
                check(&loaded);
                println!("{}: {} triangles", path.display(), triangles(&loaded));
            }
            Err(error) => {
                assert!(error.to_string().contains(&path.display().to_string()), "{error}");
                println!("{error}");
            }
        }
    }
}

#[test]
fn what_is_malformed_is_said() {
    let Some(scenes) = scenes() else { return };
    for (file, expected) in [
        ("box_UTF16BE.obj", "box_UTF16BE.obj: the file is UTF-16 text"),
        ("malformed.obj", "malformed.obj:28:3: index 0: OBJ counts from 1"),
        ("number_formats.obj", "number_formats.obj:11:14: expected a number, found `3.1+e2`"),
        ("points.ply", "points.ply: the file has no faces"),
        ("testline.obj", "testline.obj: the file has no faces; it has only lines or points"),
        ("trimesh/empty.obj", "empty.obj: the file has no faces"),
    ] {
        let error = load(&scenes.join("malformed").join(file), &LoadOptions::default());
        let error = error.expect_err(file).to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn environment_maps_are_read() {
    let Some(scenes) = scenes() else { return };
    for (file, width, height) in
        [("env/workshop_512.exr", 512, 256), ("env/spiaggia_di_mondello_1k.hdr", 1024, 512)]
    {
        let picture = decode(&scenes.join(file), Encoding::Srgb).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((picture.width, picture.height), (width, height), "{file}");
        let brightest = picture.channels.iter().flat_map(|c| &c.samples).fold(0.0, |max: f32, &s| max.max(s));
        assert!(brightest.is_finite() && brightest > 1.0, "{file}: {brightest}");
    }
    match decode(&scenes.join("env/dwab/sky_dwab.exr"), Encoding::Srgb) {
        Ok(picture) => assert!(picture.channels.iter().flat_map(|c| &c.samples).all(|s| s.is_finite())),
        Err(error) => assert!(error.to_string().contains("not supported"), "{error}"),
    }
}

#[test]
fn other_files_are_refused_with_the_way_out() {
    let error = load(Path::new("scene.blend"), &LoadOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), "scene.blend: files of the kind `.blend` are not known");
    let help = miette::Diagnostic::help(&error).map(|help| help.to_string());
    let way_out =
        "scenes are Mitsuba 3 `.xml`; bare meshes are `.obj`, `.ply` or made on the spot: `gen:soup:100k`";
    assert_eq!(help.as_deref(), Some(way_out));
    let error = load(Path::new("no/such.obj"), &LoadOptions::default()).unwrap_err();
    assert!(error.to_string().starts_with("no/such.obj: can't be read: "), "{error}");
}
