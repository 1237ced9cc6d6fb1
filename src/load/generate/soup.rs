//! Triangles that know nothing of each other: the worst that a tree is given.

use super::{bare, random::Stream};
use crate::scene::Mesh;

/// Corners lie on a sphere about the triangle's centre; with this share of n^(−1/3) as its radius,
/// neighbours overlap a little at any n.
const RADIUS: f32 = 0.577;

/// `n` triangles whose centres are uniform in the unit cube.
pub(super) fn make(n: usize, seed: u64) -> Mesh {
    let mut random = Stream::seeded(seed);
    let spacing = (n as f32).powf(-1.0 / 3.0);
    let mut positions = Vec::with_capacity(3 * n);
    for _ in 0..n {
        let centre = random.point();
        positions.extend((0..3).map(|_| centre + random.direction() * spacing * RADIUS));
    }
    let triangles = (0..3 * n as u32).step_by(3).map(|first| [first, first + 1, first + 2]).collect();
    bare(positions, triangles)
}
