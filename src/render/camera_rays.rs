//! The first rays, and the order of a tile's pixels.

use super::integrator::Path;
use crate::compile::Scene;
use crate::film::Tile;
use crate::geometry::RayLanes;
use crate::math::Sampler;
use crate::simd::{Bits, Real};

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
    (0..16).fold(0, |bits, b| bits | (code >> (2 * b) & 1) << b)
}

/// The pair of random numbers for the lens. Vertices count their pairs upwards from 1 and never come here.
const LENS: u32 = u32::MAX;

/// Rays through pixels (x, y) of the film, each where its path's first pair of random numbers and the
/// filter say, and what they count in their pixels.
#[inline]
pub(super) fn rays<R: Real>(scene: &Scene, x: R::Bits, y: R::Bits, path: &Path<R>) -> (RayLanes<R>, R) {
    let sampler = Sampler::<R>::new(path.key, path.sample);
    let ((u, v), weight) = scene.filter.sample(sampler.pair(0));
    let at = |pixel: R::Bits, offset: R| R::from_int(pixel) + offset;
    (scene.camera.rays(at(x, u), at(y, v), || sampler.pair(LENS)), weight)
}

/// Keys of the paths through pixels (x, y) of the film.
#[inline]
pub(super) fn keys<R: Real>(scene: &Scene, x: R::Bits, y: R::Bits) -> R::Bits {
    R::Bits::from_fn(|i| crate::math::PathKey::new(x.lane(i), y.lane(i), scene.sampler.seed).0)
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
