//! Samples to pictures: planes of sums.
//!
//! A pixel is the weighted mean of its own samples, drawn and weighted by a [`Filter`] and added in an
//! order that [`sums`] fixes; a sample with a value that is not finite, or too great for a sum, is
//! counted and kept out.

mod filter;
mod samples;
pub mod spread;
pub mod sums;
mod tile;

pub use filter::Filter;
pub use samples::{GREATEST, Samples};
pub use tile::{Tile, TileFilm, tiles};

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
        let rows = self.picture.height;
        self.bands(rows).into_iter().for_each(|mut band| band.place(tile, total));
    }

    /// The film in bands of so many rows, from top to bottom, which may be filled at the same time.
    pub fn bands(&mut self, rows: u32) -> Vec<Band<'_>> {
        let Picture { width, height, channels, .. } = &mut self.picture;
        let band = |first| Band { first, width: *width as usize, planes: Vec::with_capacity(channels.len()) };
        let mut bands: Vec<_> = (0..*height).step_by(rows as usize).map(band).collect();
        let pixels = *width as usize * rows as usize;
        for channel in channels {
            for (band, plane) in bands.iter_mut().zip(channel.samples.chunks_mut(pixels)) {
                band.planes.push(plane);
            }
        }
        bands
    }

    /// The picture.
    pub fn develop(self) -> Picture {
        self.picture
    }
}

/// Some rows of a film.
#[derive(Debug)]
pub struct Band<'a> {
    /// The first of them.
    first: u32,
    /// Columns.
    width: usize,
    /// Channel after channel.
    planes: Vec<&'a mut [f32]>,
}

impl Band<'_> {
    /// Puts the means of a tile in its place, which is in the band.
    pub fn place(&mut self, tile: &Tile, total: &Sums) {
        let columns = tile.width as usize;
        let first = (tile.y - self.first) as usize * self.width + tile.x as usize;
        // A row of the tile stays near until all channels have taken theirs.
        for y in 0..tile.height as usize {
            for (c, plane) in self.planes.iter_mut().enumerate() {
                total.means(c, y * columns, &mut plane[first + y * self.width..][..columns]);
            }
        }
    }
}
