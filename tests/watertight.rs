//! No ray passes between triangles that share an edge or a vertex.

#![allow(missing_docs)]

use std::f64::consts::TAU;
use std::path::Path;

use glam::{DAffine3, DVec3, Vec3};
use packlight::bvh::Traversal;
use packlight::compile::{Asked, Scene, compile};
use packlight::geometry::{PrimitiveId, Ray, offset_origin};
use packlight::load::{LoadOptions, load};
use packlight::scene::{Geometry, Material, MaterialIndex, SceneDescription, Shape};
use packlight::verify::{
    aim::Random,
    cracks::{Seams, cracks},
    scene_of,
};

type Triangles = Vec<[Vec3; 3]>;

/// A sphere of 20·4ⁿ triangles.
fn icosphere(subdivisions: u32) -> Triangles {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let corners = |i: usize| {
        let (a, b) = ([1.0, -1.0][i & 1], [g, -g][i >> 1 & 1]);
        [DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)][i >> 2]
    };
    let all: Vec<DVec3> = (0..12).map(|i| corners(i).normalize()).collect();
    let edge = all.iter().skip(1).map(|p| p.distance(all[0])).fold(f64::INFINITY, f64::min) * 1.001;
    let mut faces = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for (j, b) in all.iter().enumerate().skip(i + 1) {
            for c in &all[j + 1..] {
                if a.distance(*b) < edge && b.distance(*c) < edge && c.distance(*a) < edge {
                    let outward = (*b - *a).cross(*c - *a).dot(*a) > 0.0;
                    faces.push(if outward { [*a, *b, *c] } else { [*a, *c, *b] });
                }
            }
        }
    }
    for _ in 0..subdivisions {
        let split = |[a, b, c]: [DVec3; 3]| {
            // Symmetric in its ends, so that neighbours have the same point.
            let middle = |p: DVec3, q: DVec3| ((p + q) * 0.5).normalize();
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(split).collect();
    }
    faces.into_iter().map(|face| face.map(DVec3::as_vec3)).collect()
}

/// A ring around z.
fn torus(around: usize, across: usize) -> Triangles {
    let point = |i: usize, j: usize| {
        let (a, b) = ((i % around) as f64 / around as f64 * TAU, (j % across) as f64 / across as f64 * TAU);
        let r = 1.0 + 0.4 * b.cos();
        DVec3::new(r * a.cos(), r * a.sin(), 0.4 * b.sin()).as_vec3()
    };
    let quad = |i: usize, j: usize| {
        let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..around).flat_map(|i| (0..across).flat_map(move |j| quad(i, j))).collect()
}

/// A square of 2·n² triangles in z = 0, with hills if so wished.
fn grid(n: usize, height: f32) -> Triangles {
    let point = |i: usize, j: usize| {
        let hill = height * ((i * 7 + j * 13) % 11) as f32;
        Vec3::new(i as f32 / n as f32 - 0.5, j as f32 / n as f32 - 0.5, hill)
    };
    let quad = |i: usize, j: usize| {
        let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..n).flat_map(|i| (0..n).flat_map(move |j| quad(i, j))).collect()
}

fn moved(triangles: &Triangles, scale: f32, by: Vec3) -> Triangles {
    triangles.iter().map(|t| t.map(|p| p * scale + by)).collect()
}

/// `PACKLIGHT_LEAK_RAYS` for a run of a bench's size.
fn rays(ci: u64) -> u64 {
    std::env::var("PACKLIGHT_LEAK_RAYS").ok().and_then(|n| n.parse().ok()).unwrap_or(ci)
}

fn leaks(name: &str, scene: &Scene, rays: u64) -> u64 {
    let found = cracks(scene, &Seams::of(scene), rays);
    println!(
        "{name}: {} edges, {} vertices, {} rays, {} leaks {:?}",
        found.edges, found.vertices, found.rays, found.leaks, found.exhibit
    );
    assert!(found.rays * 20 > rays, "{name}: only {} of {rays} rays could be aimed", found.rays);
    found.leaks
}

#[test]
fn closed_meshes_are_tight() {
    let mut sum = 0;
    for (name, triangles) in [
        ("icosahedron", icosphere(0)),
        ("icosphere 320", icosphere(2)),
        ("icosphere 20k", icosphere(5)),
        ("torus", torus(60, 40)),
        ("grid", grid(40, 0.0)),
        ("hills", grid(40, 0.01)),
        ("slivers", torus(400, 5)),
    ] {
        sum += leaks(name, &scene_of(&triangles).unwrap(), rays(200_000));
    }
    assert_eq!(sum, 0);
}

#[test]
fn meshes_of_others_are_tight() {
    let mut sum = 0;
    for name in [
        "meshes/stanford-bunny.obj",
        "meshes/armadillo.ply",
        "meshes/spot.obj",
        "meshes/suzanne.obj",
        "awkward/cheese.ply",
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes").join(name);
        if !path.exists() {
            println!("skipped: {} is not there", path.display());
            continue;
        }
        let loaded = load(&path, &LoadOptions::default()).unwrap();
        sum += leaks(name, &compile(&loaded.description).unwrap(), rays(200_000));
    }
    assert_eq!(sum, 0);
}

/// Scales and places at which a mesh with edges of a tenth of the scale still has its shape.
fn scales_and_places() -> Vec<(f32, Vec3)> {
    let places =
        [Vec3::ZERO, Vec3::new(1.0, -0.7, 0.3), Vec3::new(1e3, 1e2, -3e2), Vec3::new(-1e6, 3e5, 7e5)];
    let all = (-4..=6).flat_map(|exponent| places.map(|by| (10f32.powi(exponent), by)));
    all.filter(|(scale, by)| 1e-4 * by.length() < *scale).collect()
}

#[test]
fn no_scale_or_place_leaks() {
    let mut sum = 0;
    assert_eq!(scales_and_places().len(), 32);
    for (scale, by) in scales_and_places() {
        for (name, triangles) in [("sphere", icosphere(2)), ("floor", grid(1, 0.0)), ("grid", grid(8, 0.0))] {
            let name = format!("{name} × {scale} at {by}");
            sum += leaks(&name, &scene_of(&moved(&triangles, scale, by)).unwrap(), rays(20_000));
        }
    }
    assert_eq!(sum, 0);
}

/// Rays that leave a convex thing outward: how many there were, and how many were blocked.
fn false_shadows(scene: &Scene, scale: f32, by: Vec3) -> (u32, u32) {
    let (mut random, mut traversal) = (Random::new(7), Traversal::new(()));
    let (mut left, mut blocked) = (0, 0);
    for i in 0..4000 {
        let org = by + random.vector().normalize_or(Vec3::X) * scale * 3.0;
        let ray = Ray::new(org, by + random.vector() * scale * 0.5 - org, 0.0, f32::INFINITY);
        let hit = scene.closest_hit(&ray, &mut traversal);
        if hit.primitive == PrimitiveId::NONE {
            continue;
        }
        let from = (ray.org.into(), ray.dir.into());
        let surface = scene.surface::<f32>(from, (hit.t, hit.u, hit.v), hit.primitive.0, Asked::default());
        let n = Vec3::from(surface.n_g) * -Vec3::from(surface.n_g).dot(ray.dir).signum();
        let any = random.vector();
        let steep = [1.0, 1e-1, 1e-3][i % 3] * (0.1 + random.unit());
        let away = (any - n * any.dot(n) + n * steep).normalize_or(n);
        let start = offset_origin(surface.position, surface.extent, surface.n_g, away.into());
        left += 1;
        let leaving = Ray::new(start.into(), away, 0.0, f32::INFINITY);
        blocked += u32::from(scene.occluded(&leaving, &mut traversal));
    }
    (left, blocked)
}

fn ball(scale: f32, by: Vec3) -> Scene {
    let shape = Shape {
        name: String::new(),
        geometry: Geometry::Sphere { center: by.as_dvec3(), radius: scale.into() },
        to_world: DAffine3::IDENTITY,
        flip_normals: false,
        material: MaterialIndex(0),
        radiance: None,
    };
    let materials = vec![Material::default()];
    compile(&SceneDescription { shapes: vec![shape], materials, ..Default::default() })
        .expect("a ball compiles")
}

#[test]
fn nothing_shadows_itself_at_any_scale_or_place() {
    let mut sum = 0;
    for (scale, by) in scales_and_places() {
        for (name, scene) in [
            ("sphere", ball(scale, by)),
            ("icosphere", scene_of(&moved(&icosphere(2), scale, by)).unwrap()),
            ("grid", scene_of(&moved(&grid(8, 0.0), scale, by)).unwrap()),
        ] {
            let (left, blocked) = false_shadows(&scene, scale, by);
            assert!(left > 200, "{name} × {scale} at {by}: only {left} rays");
            if blocked > 0 {
                println!("{name} × {scale} at {by}: {blocked} of {left} are blocked");
            }
            sum += blocked;
        }
    }
    assert_eq!(sum, 0);
}
