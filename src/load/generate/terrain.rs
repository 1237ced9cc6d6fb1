//! A height field of fractal value noise over the unit square, y up.

use glam::vec3;

use super::{
    bare,
    random::{fraction, scramble},
};
use crate::scene::Mesh;

const OCTAVES: u64 = 10;
/// Cells of the coarsest octave along a side.
const CELLS: f32 = 4.0;
const HEIGHT: f32 = 0.18;

/// The square grid whose two triangles a cell come nearest to `n`.
pub(super) fn make(n: usize, seed: u64) -> Mesh {
    let cells = ((n as f64 / 2.0).sqrt().round() as usize).max(1);
    let at = |step: usize| step as f32 / cells as f32;
    let rows = (0..=cells).flat_map(|row| (0..=cells).map(move |column| (column, row)));
    let positions =
        rows.map(|(column, row)| vec3(at(column), height(at(column), at(row), seed), at(row))).collect();

    let stride = cells as u32 + 1;
    let mut triangles = Vec::with_capacity(2 * cells * cells);
    for row in 0..cells as u32 {
        for column in 0..cells as u32 {
            let here = row * stride + column;
            let below = here + stride;
            triangles.extend([[here, below, here + 1], [here + 1, below, below + 1]]);
        }
    }
    bare(positions, triangles)
}

/// Each octave has twice the frequency and half the height of the one before: powers of two, exact.
fn height(x: f32, z: f32, seed: u64) -> f32 {
    let (mut frequency, mut amplitude, mut sum) = (CELLS, 1.0, 0.0);
    for octave in 0..OCTAVES {
        sum += noise(x * frequency, z * frequency, seed.wrapping_add(octave)) * amplitude;
        frequency *= 2.0;
        amplitude *= 0.5;
    }
    HEIGHT * sum
}

/// Random values at the integers, joined by a cubic with level ends.
fn noise(x: f32, y: f32, seed: u64) -> f32 {
    let (left, top) = (x.floor(), y.floor());
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (across, down) = (ease(x - left), ease(y - top));
    let (column, row) = (left as i64, top as i64);
    let along = |row: i64| value(column, row, seed) * (1.0 - across) + value(column + 1, row, seed) * across;
    along(row) * (1.0 - down) + along(row + 1) * down
}

fn value(column: i64, row: i64, seed: u64) -> f32 {
    let place = (column as u64) << 32 ^ (row as u64 & u64::from(u32::MAX));
    fraction(scramble(seed ^ scramble(place)))
}
