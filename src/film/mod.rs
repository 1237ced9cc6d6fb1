//! Samples to pictures: planes of sums.
//!
//! A pixel is the weighted mean of its own samples, drawn and weighted by a [`Filter`] and added in an
//! order that [`sums`] fixes; a sample with a value that is not finite, or too great for a sum, is
//! counted and kept out.

mod filter;
pub mod spread;
pub mod sums;
mod tile;

pub use filter::Filter;
pub use tile::{GREATEST, Tile, TileFilm, tiles};

use crate::picture::{Channel, Picture};
use sums::Sums;

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

    /// Puts the means of a tile in its place.
    pub fn place(&mut self, tile: &Tile, total: &Sums) {
        let width = self.picture.width as usize;
        for (c, channel) in self.picture.channels.iter_mut().enumerate() {
            for pixel in 0..tile.len() {
                let (x, y) = (pixel % tile.width as usize, pixel / tile.width as usize);
                let at = (tile.y as usize + y) * width + tile.x as usize + x;
                channel.samples[at] = total.mean(pixel, c);
            }
        }
    }

    /// The picture.
    pub fn develop(self) -> Picture {
        self.picture
    }
}
