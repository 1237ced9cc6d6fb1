//! Textures made of what meshes say of their vertices and faces.

#![allow(missing_docs)]

use std::{fs, path::Path};

use miette::Diagnostic;
use packlight::{
    compile::compile,
    load::{LoadOptions, load},
    picture::Picture,
    render::{Settings, render},
    scene::{Aov, AovChannel, Geometry, Integrator, Per, Rgb},
};
use tempfile::TempDir;

/// A square of one face, with colours at its corners, one face's colour, and bytes.
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property float r\nproperty float g\nproperty float b\nproperty float heat_0\nproperty uchar paint_r\n\
    property uchar paint_g\nproperty uchar paint_b\nelement face 2\nproperty list uchar int vertex_indices\n\
    property float shade_x\nproperty float shade_y\nproperty float shade_z\nend_header\n\
    -1 -1 0 0 0 0.5 0.1 255 0 51\n1 -1 0 1 0 0.5 0.2 255 0 51\n1 1 0 1 1 0.5 0.4 255 0 51\n\
    -1 1 0 0 1 0.5 0.3 255 0 51\n4 0 1 2 3 0.25 0.5 0.75\n1 0 0 0 0\n";

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("the folder for temporary files can be written");
    fs::write(folder.path().join("square.ply"), PLY).expect("the folder for temporary files can be written");
    folder
}

/// A scene of the square, filling the picture; `bsdf` is what it is made of.
fn scene(folder: &Path, shapes: &str) -> std::path::PathBuf {
    let path = folder.join("scene.xml");
    let text = format!(
        "<scene version='3.0.0'><integrator type='path'/><sensor type='orthographic'>\
         <transform name='to_world'><lookat origin='0,0,4' target='0,0,0' up='0,1,0'/></transform>\
         <sampler type='independent'><integer name='sample_count' value='16'/></sampler>\
         <film type='hdrfilm'><integer name='width' value='20'/><integer name='height' value='20'/>\
         <rfilter type='box'/></film></sensor>\n{shapes}\n<emitter type='constant'/></scene>"
    );
    fs::write(&path, text).expect("the folder for temporary files can be written");
    path
}

fn square(texture: &str) -> String {
    format!(
        "<shape type='ply'><string name='filename' value='square.ply'/><bsdf type='diffuse'>\
         <texture type='mesh_attribute' name='reflectance'>{texture}</texture></bsdf></shape>"
    )
}

fn named(name: &str) -> String {
    format!("<string name='name' value='{name}'/>")
}

fn albedo(shapes: &str) -> Picture {
    let folder = folder();
    let loaded = load(&scene(folder.path(), shapes), &LoadOptions::default()).expect("the scene loads");
    let mut description = loaded.description;
    let channels = vec![AovChannel { name: "a".into(), kind: Aov::DirectionalAlbedo }];
    description.integrator = Integrator::Aov { channels };
    let scene = compile(&description).expect("the scene compiles");
    render(&scene, &Settings::default(), &|_| {}).picture
}

fn at(picture: &Picture, x: usize, y: usize) -> Rgb {
    Rgb::from_array([0, 1, 2].map(|c| picture.channels[c].samples[y * 20 + x]))
}

fn refused(shapes: &str, parts: &[&str]) {
    let folder = folder();
    let error = load(&scene(folder.path(), shapes), &LoadOptions::default()).expect_err(shapes);
    let report = format!("{error} | {}", Diagnostic::help(&error).expect("help"));
    assert!(parts.iter().all(|part| report.contains(part)), "{report}");
    assert!(report.contains("scene.xml:2:"), "{report}");
}

#[test]
fn attributes_are_read_where_a_texture_may_be_made_of_them() {
    let folder = folder();
    let meshes = |shapes: &str| {
        let loaded = load(&scene(folder.path(), shapes), &LoadOptions::default()).expect("the scene loads");
        match &loaded.description.shapes[0].geometry {
            Geometry::Mesh { mesh, .. } => mesh.attributes.clone(),
            _ => panic!("a mesh"),
        }
    };
    let all = meshes(&square(&named("vertex_color")));
    let names: Vec<_> = all.iter().map(|attribute| (attribute.name.as_str(), attribute.per)).collect();
    let expected = ["vertex_color", "vertex_heat", "vertex_paint_color"].map(|name| (name, Per::Vertex));
    assert_eq!(names, [expected.as_slice(), &[("face_shade", Per::Face)]].concat());
    assert_eq!(all[2].values[0], Rgb::new(255.0, 0.0, 51.0));
    // One face of four corners is two triangles; one of a single corner is none.
    assert_eq!(all[3].values, [Rgb::new(0.25, 0.5, 0.75); 2]);
    assert_eq!(meshes("<shape type='ply'><string name='filename' value='square.ply'/></shape>"), []);
}

#[test]
fn colours_at_vertices_are_linear_between_them() {
    let picture = albedo(&square(&named("vertex_color")));
    for (x, y) in [(0, 0), (19, 0), (3, 17), (10, 10)] {
        let expected = Rgb::new((x as f32 + 0.5) / 20.0, 1.0 - (y as f32 + 0.5) / 20.0, 0.5);
        let seen = at(&picture, x, y);
        assert!((seen - expected).abs().max_element() < 0.005, "({x}, {y}): {seen}, not {expected}");
    }
}

#[test]
fn faces_numbers_and_bytes() {
    assert_eq!(at(&albedo(&square(&named("face_shade"))), 4, 5), Rgb::new(0.25, 0.5, 0.75));
    let bytes = named("vertex_paint_color") + "<float name='scale' value='0.003921569'/>";
    let seen = at(&albedo(&square(&bytes)), 9, 2);
    assert!((seen - Rgb::new(1.0, 0.0, 0.2)).abs().max_element() < 1e-5, "{seen}");
    let grey = at(&albedo(&square(&named("vertex_heat"))), 19, 0);
    assert!((grey.x - 0.395).abs() < 0.005 && grey.x == grey.y && grey.y == grey.z, "{grey}");
}

#[test]
fn a_material_that_two_meshes_share_has_the_colours_of_each() {
    let two = format!(
        "<bsdf type='diffuse' id='paint'><texture type='mesh_attribute' name='reflectance'>{}</texture></bsdf>\
         <shape type='ply'><string name='filename' value='square.ply'/><transform name='to_world'>\
         <scale x='0.5'/><translate x='-0.5'/></transform><ref id='paint'/></shape>\
         <shape type='ply'><string name='filename' value='other.ply'/><transform name='to_world'>\
         <scale x='0.5'/><translate x='0.5'/></transform><ref id='paint'/></shape>",
        named("face_shade")
    );
    let folder = folder();
    let other = PLY.replace("0.25 0.5 0.75", "0.75 0.125 0");
    fs::write(folder.path().join("other.ply"), other).expect("the folder for temporary files can be written");
    let mut description =
        load(&scene(folder.path(), &two), &LoadOptions::default()).expect("the scene loads").description;
    let channels = vec![AovChannel { name: "a".into(), kind: Aov::DirectionalAlbedo }];
    description.integrator = Integrator::Aov { channels };
    let scene = compile(&description).expect("the scene compiles");
    let picture = render(&scene, &Settings::default(), &|_| {}).picture;
    assert_eq!(at(&picture, 2, 9), Rgb::new(0.25, 0.5, 0.75));
    assert_eq!(at(&picture, 17, 9), Rgb::new(0.75, 0.125, 0.0));
}

#[test]
fn an_instance_has_the_colours_of_what_it_places() {
    let group = format!(
        "<shape type='shapegroup' id='painted'>{}</shape><shape type='instance'><ref id='painted'/></shape>",
        square(&named("vertex_color"))
    );
    let (placed, alone) = (albedo(&group), albedo(&square(&named("vertex_color"))));
    for (x, y) in [(0, 0), (19, 0), (3, 17), (10, 10)] {
        let (placed, alone) = (at(&placed, x, y), at(&alone, x, y));
        assert!((placed - alone).abs().max_element() < 1e-5, "({x}, {y}): {placed}, not {alone}");
    }
}

#[test]
fn what_a_shape_does_not_have_is_refused_with_its_place() {
    refused(
        &square(&named("vertex_colour")),
        &["no attribute `vertex_colour`", "did you mean `vertex_color`?"],
    );
    refused(&square(&named("color")), &["`color` is no name of an attribute"]);
    refused(&square(""), &["needs `name`"]);
    refused(
        &square(&named("vertex_paint_color")),
        &["`vertex_paint_color` has the value 255", "0.003921569"],
    );
    let ball = square(&named("vertex_color"))
        .replace("<string name='filename' value='square.ply'/>", "")
        .replace("'ply'", "'sphere'");
    refused(&ball, &["the shape `sphere` has no attribute `vertex_color`"]);
}
