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
        let samples = || vec![0.0; width as usize * height as usize];
        let channel = |name: &String| Channel { name: name.clone(), samples: samples() };
        Self {
            picture: Picture { width, height, channels: channels.iter().map(channel).collect(), place: None },
        }
    }

    /// Puts the means of a tile in its place.
    pub fn place(&mut self, tile: &Tile, total: &Sums) {
        let (width, columns) = (self.picture.width as usize, tile.width as usize);
        let first = tile.y as usize * width + tile.x as usize;
        for (c, channel) in self.picture.channels.iter_mut().enumerate() {
            let below = channel.samples[first..].chunks_mut(width);
            for (y, row) in below.take(tile.height as usize).enumerate() {
                total.means(c, y * columns, &mut row[..columns]);
            }
        }
    }

    /// The picture.
    pub fn develop(self) -> Picture {
        self.picture
    }
}
