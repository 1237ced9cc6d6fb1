//! The first rays, and the order of a tile's pixels.

use super::integrator::Path;
use crate::compile::Scene;
use crate::film::Tile;
use crate::geometry::RayLanes;
use crate::math::{PathKey, Sampler};
use crate::simd::{Bits, LANES, Real, f32x8, u32x8};

/// A tile's pixels, in the order of its first paths.
pub(super) struct Pixels {
    /// Of the tile.
    size: (u32, u32),
    /// The places of the tile's pixels in the order of paths, row by row.
    pub(super) paths: Vec<u32>,
    /// Column and row in the tile, in the order of paths; the last is repeated to fill a packet that begins anywhere.
    places: [Vec<u32>; 2],
    /// Column and row in the film, and the [`PathKey`]s, likewise.
    columns: [Vec<u32>; 3],
}

impl Pixels {
    pub(super) fn new(scene: &Scene, tile: &Tile) -> Self {
        let mut places = morton(tile);
        let mut paths = vec![0; places.len()];
        for (path, &(x, y)) in (0..).zip(&places) {
            paths[(y * tile.width + x) as usize] = path;
        }
        let last = places.last().copied().unwrap_or_default();
        places.resize((places.len() + LANES).next_multiple_of(LANES), last);
        let columns = std::array::from_fn(|_| vec![0; places.len()]);
        let mut pixels = Self {
            size: (tile.width, tile.height),
            paths,
            places: <(Vec<_>, Vec<_>)>::from_iter(places).into(),
            columns,
        };
        pixels.go(scene, tile);
        pixels
    }

    /// Those of another tile: most are of one size, and have one order.
    pub(super) fn moved(mut self, scene: &Scene, tile: &Tile) -> Self {
        if self.size != (tile.width, tile.height) {
            return Self::new(scene, tile);
        }
        self.go(scene, tile);
        self
    }

    /// To a tile of the same size.
    fn go(&mut self, scene: &Scene, tile: &Tile) {
        let [xs, ys] = self.places.each_ref().map(|places| places.as_chunks::<LANES>().0);
        let columns = self.columns.each_mut().map(|column| column.as_chunks_mut::<LANES>().0);
        let [columns, rows, keys] = columns.map(|eights| eights.iter_mut());
        for ((((x, y), column), row), key) in xs.iter().zip(ys).zip(columns).zip(rows).zip(keys) {
            let x = u32x8::new(*x).wrapping_add(u32x8::splat(tile.x));
            let y = u32x8::new(*y).wrapping_add(u32x8::splat(tile.y));
            *column = x.to_array();
            *row = y.to_array();
            *key = self::keys::<f32x8>(scene, x, y).to_array();
        }
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
    use crate::{compile::compile, scene::SceneDescription};

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

    #[test]
    fn another_tile_has_its_own_pixels() {
        let scene = compile(&SceneDescription::default()).expect("it has nothing in it");
        let tile = |x, y, width, height| Tile { x, y, width, height };
        let mut pixels = Pixels::new(&scene, &tile(5, 7, 16, 3));
        for tile in [tile(21, 7, 16, 3), tile(37, 7, 9, 3), tile(5, 10, 9, 3), tile(5, 10, 3, 9)] {
            pixels = pixels.moved(&scene, &tile);
            assert_eq!(pixels.len(), tile.len());
            let order = morton(&tile);
            for (path, &(x, y)) in order.iter().enumerate() {
                assert_eq!(pixels.paths[(y * tile.width + x) as usize] as usize, path);
                for (lane, times) in [(0, 1), (path.min(7), 1), (3, 4)] {
                    let first = path - if times == 1 { lane } else { 0 };
                    let [columns, rows, keys] = pixels.packet(first, times).map(|lanes| lanes.lane(lane));
                    let (x, y) = (tile.x + x, tile.y + y);
                    assert_eq!((columns, rows, keys), (x, y, self::keys::<f32>(&scene, x, y)), "{path}");
                }
            }
        }
    }
}
