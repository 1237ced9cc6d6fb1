//! Strands on a sphere: long thin triangles at all angles, which boxes fit badly.

use glam::Vec3;

use super::{bare, random::Stream};
use crate::scene::Mesh;

/// Bends of a strand.
const SEGMENTS: u32 = 8;
const SEGMENT_LENGTH: f32 = 0.06;
/// Of the sphere that the strands stand on.
const RADIUS: f32 = 0.6;

/// As many strands as `n` triangles need, the last one cut off.
pub(super) fn make(n: usize, seed: u64) -> Mesh {
    let mut random = Stream::seeded(seed);
    let half_width = 0.4 / (n as f32).sqrt();
    let mut positions = Vec::new();
    let mut triangles = Vec::with_capacity(n + 2 * SEGMENTS as usize);
    while triangles.len() < n {
        let first = positions.len() as u32;
        strand(&mut random, half_width, &mut positions);
        for left in (first..).step_by(2).take(SEGMENTS as usize) {
            triangles.extend([[left, left + 1, left + 2], [left + 2, left + 1, left + 3]]);
        }
    }
    triangles.truncate(n);
    bare(positions, triangles)
}

/// Pairs of vertices from root to tip, closer and closer.
fn strand(random: &mut Stream, half_width: f32, positions: &mut Vec<Vec3>) {
    let outward = random.direction();
    let mut point = outward * RADIUS;
    let mut along = (outward + random.direction() * 0.4).normalize();
    let aside = along.cross(random.direction()).normalize_or(Vec3::X) * half_width;
    for joint in 0..=SEGMENTS {
        let reach = aside * (1.0 - joint as f32 / (SEGMENTS + 1) as f32);
        positions.extend([point - reach, point + reach]);
        point += along * SEGMENT_LENGTH;
        // It wavers, and it sags.
        along = (along + random.direction() * 0.2 - Vec3::Y * 0.08).normalize();
    }
}
