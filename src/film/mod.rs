//! Samples to pictures: planes of sums.
//!
//! A pixel is the weighted mean of its own samples, drawn and weighted by a [`Filter`] and added in sample
//! order; a sample with a value that is not finite, or that their sum can't hold, is counted and kept out.

mod filter;

pub use filter::Filter;

use crate::picture::{Channel, Picture};

/// A rectangle of pixels that one thread fills.
#[derive(Clone, Debug)]
pub struct Tile {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Tile {
    /// Pixels.
    pub fn len(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Does it have none?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Covers a film with tiles of at most `size` × `size` pixels, row by row.
pub fn tiles(width: u32, height: u32, size: u32) -> Vec<Tile> {
    let starts = |length: u32| (0..length).step_by(size as usize);
    let tile = |x, y| Tile { x, y, width: size.min(width - x), height: size.min(height - y) };
    starts(height).flat_map(|y| starts(width).map(move |x| tile(x, y))).collect()
}

/// Means of samples over a tile; planes in the order of the channels.
#[derive(Clone, Debug)]
pub struct TileFilm {
    sums: Vec<f32>,
    /// Of the samples of each pixel.
    weights: Vec<f32>,
    counts: Vec<u32>,
    /// Samples kept out.
    pub invalid: u64,
    /// Pixel of the tile and sample number of the first one kept out, by pixel, then sample.
    pub first_invalid: Option<(u32, u32)>,
}

impl TileFilm {
    /// An empty film of this many pixels and channels.
    pub fn new(pixels: usize, channels: usize) -> Self {
        Self {
            sums: vec![0.0; pixels * channels],
            weights: vec![0.0; pixels],
            counts: vec![0; pixels],
            invalid: 0,
            first_invalid: None,
        }
    }

    /// Adds a sample of a weight to a pixel: `value(c)` for each channel c.
    #[inline]
    pub fn add(&mut self, pixel: usize, sample: u32, weight: f32, value: impl Fn(usize) -> f32) {
        let pixels = self.counts.len();
        let channels = self.sums.len() / pixels;
        // What is finite may not be so together with the samples before it.
        let fits = |c: usize| (self.sums[c * pixels + pixel] + value(c) * weight).is_finite();
        if !(0..channels).all(|c| value(c).is_finite() && fits(c)) {
            self.invalid += 1;
            let place = (pixel as u32, sample);
            self.first_invalid = Some(self.first_invalid.map_or(place, |first| first.min(place)));
            return;
        }
        for c in 0..channels {
            self.sums[c * pixels + pixel] += value(c) * weight;
        }
        self.weights[pixel] += weight;
        self.counts[pixel] += 1;
    }

    /// The mean of a pixel's samples, 0 where it has none.
    ///
    /// Divided by their weights, so that what is the same everywhere stays the same; but a few samples of
    /// both signs may weigh nothing together, and are then divided by their number.
    pub fn mean(&self, pixel: usize, channel: usize) -> f32 {
        let sum = self.sums[channel * self.counts.len() + pixel];
        match (self.counts[pixel], self.weights[pixel]) {
            (0, _) => 0.0,
            (_, weight) if weight > 0.0 => sum / weight,
            (count, _) => sum / count as f32,
        }
    }
}

/// A picture put together from tiles.
#[derive(Clone, Debug)]
pub struct Film {
    picture: Picture,
}

impl Film {
    /// A black film.
    pub fn new(width: u32, height: u32, channels: &[String]) -> Self {
        let samples = vec![0.0; width as usize * height as usize];
        let channel = |name: &String| Channel { name: name.clone(), samples: samples.clone() };
        Self { picture: Picture { width, height, channels: channels.iter().map(channel).collect() } }
    }

    /// Puts a finished tile in its place.
    pub fn place(&mut self, tile: &Tile, film: &TileFilm) {
        let width = self.picture.width as usize;
        for (c, channel) in self.picture.channels.iter_mut().enumerate() {
            for pixel in 0..tile.len() {
                let (x, y) = (pixel % tile.width as usize, pixel / tile.width as usize);
                let at = (tile.y as usize + y) * width + tile.x as usize + x;
                channel.samples[at] = film.mean(pixel, c);
            }
        }
    }

    /// The picture.
    pub fn develop(self) -> Picture {
        self.picture
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_each_pixel_once() {
        for (width, height, size) in [(1, 1, 8), (17, 5, 8), (64, 64, 32), (33, 7, 5)] {
            let mut seen = vec![0; (width * height) as usize];
            for tile in tiles(width, height, size) {
                for y in tile.y..tile.y + tile.height {
                    for x in tile.x..tile.x + tile.width {
                        seen[(y * width + x) as usize] += 1;
                    }
                }
            }
            assert!(seen.iter().all(|&n| n == 1));
        }
    }

    #[test]
    fn invalid_samples_are_counted_and_kept_out() {
        let mut film = TileFilm::new(2, 1);
        film.add(1, 0, 1.0, |_| 2.0);
        film.add(1, 1, 1.0, |_| f32::NAN);
        film.add(1, 2, 1.0, |_| 4.0);
        film.add(0, 7, 1.0, |_| f32::INFINITY);
        assert_eq!((film.mean(1, 0), film.mean(0, 0)), (3.0, 0.0));
        assert_eq!((film.invalid, film.first_invalid), (2, Some((0, 7))));
    }

    #[test]
    fn what_overflows_the_sum_is_kept_out() {
        let mut film = TileFilm::new(1, 1);
        for sample in 0..3 {
            film.add(0, sample, 1.0, |_| 3e38);
        }
        assert_eq!(film.mean(0, 0), 3e38);
        assert_eq!((film.invalid, film.first_invalid), (2, Some((0, 1))));
    }

    #[test]
    fn weights_of_both_signs_keep_what_is_the_same_everywhere() {
        let mut film = TileFilm::new(1, 1);
        for (sample, weight) in [1.0, -1.0, 1.0, 1.0].into_iter().enumerate() {
            film.add(0, sample as u32, weight, |_| 0.75);
        }
        assert_eq!(film.mean(0, 0), 0.75);
        let mut none = TileFilm::new(1, 1);
        none.add(0, 0, 1.0, |_| 3.0);
        none.add(0, 1, -1.0, |_| 1.0);
        assert_eq!(none.mean(0, 0), 1.0);
    }
}
