//! The scenes that are traced.

use std::{
    f64::consts::PI,
    path::{Path, PathBuf},
    sync::Arc,
};

use glam::{DAffine3, DVec3, Vec3};
use packlight::load::{LoadOptions, load};
use packlight::scene::{Geometry, Material, MaterialIndex, Mesh, SceneDescription, Shape};
use packlight::verify::aim::{Random, Targets};

fn shape(geometry: Geometry, to_world: DAffine3) -> Shape {
    Shape {
        name: String::new(),
        geometry,
        to_world,
        flip_normals: false,
        material: MaterialIndex(0),
        radiance: None,
    }
}

fn scene(shapes: Vec<Shape>) -> SceneDescription {
    SceneDescription { shapes, materials: vec![Material::default()], ..SceneDescription::default() }
}

fn mesh(triangles: &[[Vec3; 3]]) -> Geometry {
    let mesh = Mesh {
        positions: triangles.iter().flatten().copied().collect(),
        triangles: (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..Mesh::default()
    };
    Geometry::Mesh { mesh: Arc::new(mesh), face_normals: true }
}

/// Triangles of all sizes at random.
pub(crate) fn soup(count: usize) -> SceneDescription {
    let mut random = Random::new(1);
    let mut next = |i: usize| {
        let (v0, size) = (random.vector(), [0.05, 0.2, 1.0][i % 3]);
        let size = if count < 3 { 1.0 } else { size };
        [v0, v0 + random.vector() * size, v0 + random.vector() * size]
    };
    let triangles: Vec<_> = (0..count).map(&mut next).collect();
    scene(vec![shape(mesh(&triangles), DAffine3::IDENTITY)])
}

/// Axis-aligned quads on a grid, in three directions and common planes; the whole lot three times over.
pub(crate) fn quads() -> SceneDescription {
    let mut shapes = Vec::new();
    for _ in 0..3 {
        for i in 0..36 {
            let (x, y) = (f64::from(i % 6) / 6.0, f64::from(i / 6) / 6.0);
            let place = DAffine3::from_translation(DVec3::new(x, y, 0.0))
                * DAffine3::from_scale(DVec3::splat(1.0 / 12.0));
            let turn = match i % 3 {
                0 => DAffine3::IDENTITY,
                1 => DAffine3::from_rotation_x(PI / 2.0),
                _ => DAffine3::from_rotation_y(PI / 2.0),
            };
            shapes.push(shape(Geometry::Rectangle, place));
            shapes.push(shape(Geometry::Rectangle, place * turn));
        }
    }
    scene(shapes)
}

/// Shapes of every kind, overlapping.
pub(crate) fn mixed(count: usize) -> SceneDescription {
    let mut random = Random::new(2);
    let mut shapes = Vec::new();
    for i in 0..count {
        let at = DAffine3::from_translation(random.vector().as_dvec3());
        let turn = DAffine3::from_rotation_x(f64::from(random.unit()) * 6.0)
            * DAffine3::from_rotation_z(f64::from(random.unit()) * 6.0);
        let size = 0.02 + 0.1 * f64::from(random.unit());
        let stretch = DAffine3::from_scale(DVec3::new(size, size * 0.7, size * 1.9));
        shapes.push(match i % 5 {
            0 => shape(Geometry::Sphere { center: DVec3::ZERO, radius: size }, at),
            1 => shape(Geometry::Disk, at * turn * stretch),
            2 => {
                shape(Geometry::Cylinder { p0: DVec3::ZERO, p1: DVec3::Z, radius: 1.0 }, at * turn * stretch)
            }
            3 => shape(Geometry::Cube, at * turn * stretch),
            // The same sphere again, and a disk in a plane of the axes.
            _ if i % 2 == 0 => {
                shape(Geometry::Sphere { center: DVec3::ZERO, radius: 0.25 }, DAffine3::IDENTITY)
            }
            _ => shape(Geometry::Disk, DAffine3::from_scale(DVec3::splat(0.5))),
        });
    }
    scene(shapes)
}

/// Slanting triangles that fill the unit cubes at (±1.5, ±1.5, ±1.5), and no more.
pub(crate) fn fence() -> SceneDescription {
    let mut triangles = Vec::new();
    for i in 0..8 {
        let corner = Vec3::new(
            if i & 1 == 0 { 1.0 } else { -2.0 },
            if i & 2 == 0 { 1.0 } else { -2.0 },
            if i & 4 == 0 { 1.0 } else { -2.0 },
        );
        for turn in 0..3 {
            let axes = [Vec3::X, Vec3::Y, Vec3::Z];
            let (a, b, c) = (axes[turn], axes[(turn + 1) % 3], axes[(turn + 2) % 3]);
            triangles.push([corner, corner + a + b, corner + c + b * 0.5]);
            triangles.push([corner + a, corner + b, corner + c]);
            triangles.push([corner + a + b, corner + c + b, corner + c + a]);
        }
    }
    scene(vec![shape(mesh(&triangles), DAffine3::IDENTITY)])
}

pub(crate) fn one_sphere() -> SceneDescription {
    scene(vec![shape(
        Geometry::Sphere { center: DVec3::new(0.1, 0.2, 0.3), radius: 0.5 },
        DAffine3::IDENTITY,
    )])
}

/// The same triangle again and again.
pub(crate) fn equal(count: usize) -> SceneDescription {
    let triangle = [Vec3::new(0.1, 0.0, 0.2), Vec3::new(0.9, 0.1, -0.3), Vec3::new(0.2, 0.8, 0.4)];
    scene(vec![shape(mesh(&vec![triangle; count]), DAffine3::IDENTITY)])
}

/// Points and lines.
pub(crate) fn degenerate() -> SceneDescription {
    let triangles: Vec<_> = (0..50)
        .flat_map(|i| {
            let (a, d) = (Vec3::splat(i as f32), Vec3::new(1.0, 2.0, -3.0));
            [[a; 3], [a, a, a + d], [a, a + d, a + d * 2.0], [a, a + d, a]]
        })
        .collect();
    scene(vec![shape(mesh(&triangles), DAffine3::IDENTITY)])
}

/// Points on the shapes to aim at.
pub(crate) fn targets(description: &SceneDescription) -> Targets {
    let mut targets = Targets::new();
    let own = description.shapes.iter().map(|shape| (DAffine3::IDENTITY, shape));
    let placed = description.instances.iter().flat_map(|instance| {
        description.groups[instance.group.0 as usize].shapes.iter().map(|shape| (instance.to_world, shape))
    });
    for (to_world, shape) in own.chain(placed) {
        let to_world = to_world * shape.to_world;
        let place = |p: Vec3| to_world.transform_point3(p.as_dvec3()).as_vec3();
        match &shape.geometry {
            Geometry::Mesh { mesh, .. } => {
                let corner = |i: u32| place(mesh.positions[i as usize]);
                targets.extend(mesh.triangles.iter().map(|t| t.map(corner)));
            }
            Geometry::Sphere { center, radius } => {
                let on = |d: Vec3| place(center.as_vec3() + d * *radius as f32);
                targets.push([on(Vec3::X), on(Vec3::Y), on(Vec3::Z)]);
            }
            _ => targets.push([Vec3::X, Vec3::Y, Vec3::new(-1.0, -1.0, 0.0)].map(place)),
        }
    }
    targets
}

pub(crate) fn triangles(description: &SceneDescription) -> usize {
    let count = |shape: &Shape| match &shape.geometry {
        Geometry::Mesh { mesh, .. } => mesh.triangles.len(),
        _ => 1,
    };
    description.shapes.iter().map(count).sum()
}

pub(crate) fn read(path: &Path) -> SceneDescription {
    load(path, &LoadOptions::default())
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        .description
}

/// A scene that does not belong to the repository, if it is there.
pub(crate) fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes").join(name);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    Some(path)
}
