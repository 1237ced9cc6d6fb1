//! A sphereflake (Haines 1987): a sphere with nine smaller ones on it, each the same again.

use std::{collections::HashMap, f32::consts::TAU};

use glam::Vec3;

use super::bare;
use crate::scene::Mesh;

const CHILDREN: usize = 9;
/// Triangles that a sphere should at least be worth when another generation is added.
const WORTH: usize = 320;
/// Triangles of an icosahedron.
const FACES: usize = 20;

#[derive(Clone, Copy)]
struct Ball {
    centre: Vec3,
    radius: f32,
    /// Away from the parent.
    axis: Vec3,
}

/// About `n` triangles: generations first, then as fine a tessellation as fits, and what is left goes
/// into finer spheres, biggest first.
pub(super) fn make(n: usize) -> Mesh {
    let balls = flake(n);
    let mut level = 0;
    while balls.len() * FACES * 4usize.pow(level + 1) <= n + n / 8 {
        level += 1;
    }
    let coarse = icosphere(level);
    let fine = divide(&coarse);
    let price = fine.triangles.len() - coarse.triangles.len();
    let finer = n.saturating_sub(balls.len() * coarse.triangles.len()) / price;

    let mut flake = Mesh::default();
    for (place, ball) in balls.iter().enumerate() {
        let model = if place < finer { &fine } else { &coarse };
        let base = flake.positions.len() as u32;
        flake.positions.extend(model.positions.iter().map(|&p| ball.centre + p * ball.radius));
        flake.triangles.extend(model.triangles.iter().map(|corners| corners.map(|i| i + base)));
    }
    flake
}

/// Generations of spheres while a budget of `n` triangles leaves each its worth.
fn flake(n: usize) -> Vec<Ball> {
    let mut all = vec![Ball { centre: Vec3::ZERO, radius: 1.0, axis: Vec3::Y }];
    let mut youngest = 0;
    loop {
        let parents = all.len() - youngest;
        if (all.len() + CHILDREN * parents) * WORTH > n {
            return all;
        }
        let next = all.len();
        for parent in youngest..next {
            let children = all[parent].children();
            all.extend(children);
        }
        youngest = next;
    }
}

impl Ball {
    /// Six around the equator, three nearer to the pole.
    fn children(self) -> [Self; CHILDREN] {
        let (side, other) = self.axis.any_orthonormal_pair();
        std::array::from_fn(|k| {
            let (turn, tilt) = if k < 6 { (k as f32 / 6.0, 0.0) } else { (k as f32 / 3.0 + 0.08, 0.95f32) };
            let (sin, cos) = (turn * TAU).sin_cos();
            let (up, out) = tilt.sin_cos();
            let axis = (side * cos + other * sin) * out + self.axis * up;
            // A third of the size: the centres are 4/3 of the parent's radius apart.
            let centre = self.centre + axis * (self.radius * 4.0 / 3.0);
            Self { centre, radius: self.radius / 3.0, axis }
        })
    }
}

fn icosphere(level: u32) -> Mesh {
    (0..level).fold(icosahedron(), |sphere, _| divide(&sphere))
}

/// Three golden rectangles at right angles.
fn icosahedron() -> Mesh {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let corners =
        |f: fn(f32, f32) -> Vec3| [(-1.0, g), (1.0, g), (-1.0, -g), (1.0, -g)].map(|(a, b)| f(a, b));
    let rectangles = [
        corners(|a, b| Vec3::new(a, b, 0.0)),
        corners(|a, b| Vec3::new(0.0, a, b)),
        corners(|a, b| Vec3::new(b, 0.0, a)),
    ];
    let positions = rectangles.into_iter().flatten().map(Vec3::normalize).collect();
    // About a corner, its five neighbours, the opposite corner likewise.
    let triangles = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    bare(positions, triangles)
}

/// Four triangles for each, the middles of the edges pushed out onto the sphere.
fn divide(sphere: &Mesh) -> Mesh {
    let mut positions = sphere.positions.clone();
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| -> u32 {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            positions.push((positions[a as usize] + positions[b as usize]).normalize());
            positions.len() as u32 - 1
        })
    };
    let mut triangles = Vec::with_capacity(4 * sphere.triangles.len());
    for &[a, b, c] in &sphere.triangles {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    bare(positions, triangles)
}
