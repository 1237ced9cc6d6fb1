//! Rays that find faults: at corners and edges, along axes, in planes, from surfaces and from far away.

use crate::compile::Scene;
use crate::geometry::{PrimitiveId, Ray};
use glam::Vec3;

/// A repeatable sequence.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 32) as u32
    }

    /// A whole number less than n.
    pub fn below(&mut self, n: usize) -> usize {
        ((u64::from(self.bits()) * n as u64) >> 32) as usize
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }

    /// In [−1, 1)³.
    pub fn vector(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

/// Where to aim: triangles' corners, or three points of any other surface.
pub type Targets = Vec<[Vec3; 3]>;

/// What there is to aim at in a scene: the corners of its triangles, and three points where other surfaces
/// touch their boxes.
pub fn targets(scene: &Scene) -> Targets {
    let target = |i: u32| {
        scene.triangle(PrimitiveId(i)).unwrap_or_else(|| {
            let bounds = scene.primitive_bounds(PrimitiveId(i));
            let centre = bounds.centre();
            [
                Vec3 { x: bounds.max.x, ..centre },
                Vec3 { y: bounds.max.y, ..centre },
                Vec3 { z: bounds.max.z, ..centre },
            ]
        })
    };
    (0..scene.primitive_count()).map(target).collect()
}

/// `count` rays of each of some twenty kinds; the first are a camera's.
pub fn rays_at(targets: &Targets, count: usize, random: &mut Random) -> Vec<Ray> {
    let somewhere = [[Vec3::ZERO, Vec3::X, Vec3::Y]];
    let targets: &[[Vec3; 3]] = if targets.is_empty() { &somewhere } else { targets };
    let points = || targets.iter().flatten();
    let min = points().fold(Vec3::INFINITY, |a, &b| a.min(b));
    let max = points().fold(Vec3::NEG_INFINITY, |a, &b| a.max(b));
    let (centre, size) = ((min + max) * 0.5, (max - min).length().max(1e-6));
    let mut rays = Vec::new();
    let corners = |random: &mut Random| targets[random.below(targets.len())];
    let mut add = |org: Vec3, dir: Vec3, t_far: f32| {
        if dir != Vec3::ZERO && dir.is_finite() && org.is_finite() {
            rays.push(Ray::new(org, dir, 0.0, t_far));
        }
    };
    let forever = f32::INFINITY;
    // From the camera, row by row: neighbours are coherent.
    let eye = centre + Vec3::new(0.3, 0.4, 1.0) * size;
    let side = (count as f32).sqrt().ceil() as usize;
    for i in 0..side * side {
        let (x, y) = ((i % side) as f32 / side as f32 - 0.5, (i / side) as f32 / side as f32 - 0.5);
        add(eye, centre + Vec3::new(x, y, 0.0) * size - eye, forever);
    }
    for i in 0..count {
        // Anywhere to anywhere, and to a distance.
        let org = centre + random.vector() * size;
        add(org, centre + random.vector() * size * 0.5 - org, forever);
        add(org, random.vector(), random.unit() * size);
        // At a vertex, an edge, the middle of one, the inside; and only just so far.
        let [a, b, c] = corners(random);
        let (s, t) = (random.unit(), random.unit());
        add(org, a - org, forever);
        add(org, b - org, 1.0);
        add(org, a + (b - a) * s - org, forever);
        add(org, (a + c) * 0.5 - org, 1.0);
        let inside = a + (b - a) * (s * (1.0 - t)) + (c - a) * (s * t);
        add(org, inside - org, forever);
        add(org, inside - org, 1.0 - 1e-3 * random.unit());
        // Along an axis through a vertex or an edge, with zeros of both signs.
        let axis = i % 3;
        let zero = if i % 2 == 0 { 0.0 } else { -0.0 };
        let mut along = Vec3::splat(zero);
        along[axis] = if i % 4 < 2 { 1.0 } else { -1.0 };
        let start = |p: Vec3| p - along * size * 2.0;
        add(start(a), along, forever);
        add(start(inside), along, forever);
        add(start(a + (b - a) * s), along, forever);
        // In a plane of the axes, towards a vertex.
        let mut flat = a - org;
        flat[axis] = zero;
        let mut start = org;
        start[axis] = a[axis];
        add(start, flat, forever);
        // On the surface, and from a vertex: leaving and along an edge.
        add(inside, random.vector(), forever);
        add(a, c - a, forever);
        add(a, b - inside, forever);
        // From far away.
        let far = centre + random.vector().normalize_or(Vec3::X) * 1e6 * size.max(1.0);
        add(far, (inside - far).normalize(), forever);
        // Long and short directions.
        add(org, (inside - org) * 1e-12, forever);
        add(org, (inside - org) * 1e12, forever);
    }
    rays
}
