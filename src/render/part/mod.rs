//! A part of a render, to be kept: a checkpoint, a shard, or what is left of a render that was stopped.
//!
//! These are one thing. A part says what it is a part of, holds the sums of some tiles over some samples to
//! the bit, and can be continued or joined with others. A picture knows only means, from which neither is
//! possible.

mod bytes;
mod merge;

use std::{fmt, time::Duration};

pub use bytes::PartFormatError;
pub use merge::{MergeError, Merged, merge};

use super::{Plan, frame::tiles, statistics::Statistics};
use crate::{
    film::{Film, TileFilm},
    picture::{Picture, Place},
    scene::Crop,
};

/// Pixels a side, and shards, beyond which a part is not believed.
const MAX_SIDE: u32 = 1 << 16;
const MAX_SHARDS: u32 = 1 << 20;

/// Some of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What the picture is decided by, by name, but for the number of samples: parts of one render agree in
    /// all of them.
    pub facts: Vec<(String, String)>,
    /// The name of the scene's file, for people.
    pub scene: String,
    /// Of the picture.
    pub channels: Vec<String>,
    /// Columns of the picture.
    pub width: u32,
    /// Rows of the picture.
    pub height: u32,
    /// Where it is in the film, if it is not all of it.
    pub place: Option<Place>,
    /// Samples a pixel that are asked for.
    pub samples: u32,
    /// What of it was to be rendered.
    pub plan: Plan,
    /// Wall time spent on it so far.
    pub time: Duration,
    /// What is there, by rising number.
    pub tiles: Vec<PartTile>,
}

/// A tile of a [`Part`].
#[derive(Clone, Debug, PartialEq)]
pub struct PartTile {
    /// Among all tiles of the picture, row by row.
    pub number: u32,
    /// Its samples.
    pub film: TileFilm,
    /// What they took.
    pub statistics: Statistics,
}

/// Two things that should be parts of one render and are not.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct Difference {
    /// What differs.
    pub name: String,
    /// What it is there.
    pub there: String,
    /// What it is here.
    pub here: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the {} is {} there and {} here", self.name, self.there, self.here)
    }
}

/// The first difference, if there is one.
pub(super) fn differ(name: &str, there: impl ToString, here: impl ToString) -> Result<(), Difference> {
    let (there, here) = (there.to_string(), here.to_string());
    if there == here { Ok(()) } else { Err(Difference { name: name.into(), there, here }) }
}

impl Part {
    /// Whether the other is a part of the same picture. The number of samples may differ.
    ///
    /// # Errors
    /// The first [`Difference`]: what is `here`, and in the other, `there`.
    pub fn same_picture(&self, other: &Self) -> Result<(), Difference> {
        for (name, here) in &self.facts {
            let there = other.facts.iter().find(|(theirs, _)| theirs == name);
            differ(name, there.map_or("not said", |(_, value)| value), here)?;
        }
        differ("number of facts", other.facts.len(), self.facts.len())?;
        let size = |part: &Self| format!("{} x {}", part.width, part.height);
        differ("size", size(other), size(self))?;
        differ("list of channels", other.channels.join(", "), self.channels.join(", "))?;
        let error = |part: &Self| part.plan.target_error.map_or("none".into(), |error| error.to_string());
        differ("target error", error(other), error(self))
    }

    /// The picture so far; black where nothing is.
    pub fn picture(&self) -> Picture {
        let tiles = tiles(self.window());
        let mut film = Film::new(self.width, self.height, &self.channels);
        for tile in &self.tiles {
            film.place(&tiles[tile.number as usize], &tile.film.total());
        }
        Picture { place: self.place, ..film.develop() }
    }

    /// Are all its samples there?
    pub fn is_complete(&self) -> bool {
        let range = self.plan.shard.samples(self.samples);
        self.tiles.iter().all(|tile| tile.film.is_done(range.end, self.plan.target_error))
    }

    fn window(&self) -> Crop {
        Crop { x: 0, y: 0, width: self.width, height: self.height }
    }

    /// What contradicts itself in a part that was read, if anything does.
    fn defect(&self) -> Option<&'static str> {
        let Plan { shard, target_error } = self.plan;
        if self.width.max(self.height) > MAX_SIDE || shard.count > MAX_SHARDS {
            return Some("it is larger than anything that is rendered");
        }
        let fits =
            |first: u32, length: u32, whole: u32| whole <= MAX_SIDE && whole >= first.saturating_add(length);
        let inside =
            |place: Place| fits(place.x, self.width, place.width) && fits(place.y, self.height, place.height);
        if !self.place.is_none_or(inside) {
            return Some("it is outside of its film");
        }
        if shard.index >= shard.count {
            return Some("there is no such shard");
        }
        let tiles = tiles(self.window());
        let range = shard.samples(self.samples);
        let wanted = (0..tiles.len() as u32).filter(|&number| shard.has_tile(number));
        if !wanted.eq(self.tiles.iter().map(|tile| tile.number)) {
            return Some("its tiles are not those of the shard");
        }
        self.tiles.iter().find_map(|PartTile { number, film, .. }| {
            if let Some(defect) = film.defect() {
                return Some(defect);
            }
            if film.pixels() != tiles[*number as usize].len() || film.channels() != self.channels.len() {
                return Some("a tile has another size");
            }
            if film.samples.start != range.start || film.samples.end > range.end {
                return Some("a tile has samples that it should not have");
            }
            let spread = film.spread.as_ref().map(|spread| (spread.sums.len(), spread.squares.len()));
            (spread != target_error.map(|_| (film.pixels(), film.pixels())))
                .then_some("a tile says nothing of its error")
        })
    }
}
