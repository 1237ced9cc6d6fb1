//! The first rays, and the order of a tile's pixels.

use super::integrator::Path;
use crate::compile::Scene;
use crate::film::Tile;
use crate::geometry::RayLanes;
use crate::math::{PathKey, Sampler};
use crate::simd::{Bits, LANES, Real, u32x8};

/// A tile's pixels, in the order of its first paths.
pub(super) struct Pixels {
    /// The places of the tile's pixels in the order of paths, row by row.
    pub(super) paths: Vec<u32>,
    /// Column and row in the film, and the [`PathKey`]s, in the order of paths; the last is repeated to fill a packet.
    columns: [Vec<u32>; 3],
}

impl Pixels {
    pub(super) fn new(scene: &Scene, tile: &Tile) -> Self {
        let order = morton(tile);
        let mut paths = vec![0; order.len()];
        let mut columns = [0; 3].map(|_: u32| Vec::with_capacity(order.len() + LANES));
        for (path, &(x, y)) in (0..).zip(&order) {
            paths[(y * tile.width + x) as usize] = path;
            let (x, y) = (tile.x + x, tile.y + y);
            columns
                .iter_mut()
                .zip([x, y, keys::<f32>(scene, x, y)])
                .for_each(|(column, value)| column.push(value));
        }
        for column in &mut columns {
            let last = column.last().copied().unwrap_or_default();
            column.resize(order.len() + LANES, last);
        }
        Self { paths, columns }
    }

    /// Pixels.
    pub(super) fn len(&self) -> usize {
        self.paths.len()
    }

    /// (column, row, key) of the pixels from one on, eight in all, each as often as it says.
    #[inline]
    pub(super) fn packet(&self, first: usize, times: usize) -> [u32x8; 3] {
        let lanes = u32x8::from_fn(|i| (i / times) as u32);
        self.columns.each_ref().map(|column| {
            let eight = column[first..].first_chunk().copied().unwrap_or_default();
            u32x8::new(eight).shuffle(lanes)
        })
    }
}

/// A tile's pixels as (column, row) within it, in Morton order: eight in a row are a block of 4 × 2.
pub(super) fn morton(tile: &Tile) -> Vec<(u32, u32)> {
    let side = tile.width.max(tile.height).next_power_of_two();
    let codes = 0..side * side;
    codes
        .map(|code| (even_bits(code), even_bits(code >> 1)))
        .filter(|&(x, y)| x < tile.width && y < tile.height)
        .collect()
}

fn even_bits(code: u32) -> u32 {
    let bits = code & 0x5555_5555;
    let bits = (bits | bits >> 1) & 0x3333_3333;
    let bits = (bits | bits >> 2) & 0x0f0f_0f0f;
    let bits = (bits | bits >> 4) & 0x00ff_00ff;
    (bits | bits >> 8) & 0x0000_ffff
}

/// The pair of random numbers for the lens. Vertices count their pairs upwards from 1 and never come here.
const LENS: u32 = u32::MAX;

/// Rays through pixels (x, y) of the film, each where its path's first pair of random numbers and the
/// filter say, and what they count in their pixels.
#[inline]
pub(super) fn rays<R: Real>(scene: &Scene, x: R::Bits, y: R::Bits, path: &Path<R>) -> (RayLanes<R>, R) {
    let (point, weight) = points(scene, x, y, path);
    (through(scene, point, path), weight)
}

/// Where on the film those rays are, in pixels, and what they count.
#[inline]
pub(super) fn points<R: Real>(scene: &Scene, x: R::Bits, y: R::Bits, path: &Path<R>) -> ((R, R), R) {
    let ((u, v), weight) = scene.filter.sample(path.on_film());
    ((R::from_int(x) + u, R::from_int(y) + v), weight)
}

/// Rays through points of the film.
#[inline]
pub(super) fn through<R: Real>(scene: &Scene, (x, y): (R, R), path: &Path<R>) -> RayLanes<R> {
    scene.camera.rays(x, y, || Sampler::<R>::new(path.key, path.sample).pair(LENS))
}

/// Keys of the paths through pixels (x, y) of the film.
#[inline]
pub(super) fn keys<R: Real>(scene: &Scene, x: R::Bits, y: R::Bits) -> R::Bits {
    PathKey::of_pixels(x, y, scene.sampler.seed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_pixels_in_a_row_are_a_block_of_4x2() {
        let tile = Tile { x: 0, y: 0, width: 32, height: 20 };
        let pixels = morton(&tile);
        assert_eq!(pixels.len(), tile.len());
        let (xs, ys): (Vec<_>, Vec<_>) = pixels[8..16].iter().copied().unzip();
        assert!(xs.iter().all(|&x| x < 4) && ys.iter().all(|&y| (2..4).contains(&y)), "{xs:?} {ys:?}");
        let mut sorted = pixels.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!(sorted.len(), tile.len());
    }
}
