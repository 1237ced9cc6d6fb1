//! Parts of one render to its picture.

use std::time::Duration;

use super::{Difference, Part, differ};
use crate::{
    film::{Film, TileFilm, sums::Sums},
    picture::Picture,
    render::{Coverage, Shard, ShardBy, Statistics, frame::tiles},
};

/// A picture that was put together.
#[derive(Clone, Debug)]
pub struct Merged {
    /// What its parts agreed in.
    pub facts: Vec<(String, String)>,
    /// The name of the scene's file.
    pub scene: String,
    /// Samples a pixel that were asked for.
    pub samples: u32,
    /// To the bit what one machine would have rendered, if every part was there.
    pub picture: Picture,
    /// What the parts took together; `time` too.
    pub statistics: Statistics,
    /// Samples of its pixels, all parts together.
    pub coverage: Coverage,
    /// Shards that were left out, counted from 1.
    pub missing: Vec<u32>,
}

/// Why parts don't make a picture. Names are those that came with them.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// There is nothing to merge.
    #[error("there is nothing to merge")]
    Nothing,
    /// Two are of different renders.
    #[error("{name} is no part of the same render as {first}: {difference}")]
    Different {
        /// The one that differs.
        name: String,
        /// From which.
        first: String,
        /// In what; `there` is in `name`.
        difference: Difference,
    },
    /// Two have the same tiles and samples.
    #[error("{first} and {second} are both shard {shard}; leave one out")]
    Doubled {
        /// One of the two.
        first: String,
        /// The other.
        second: String,
        /// What both are.
        shard: String,
    },
    /// A part was stopped before it was done.
    #[error(
        "{name} is not finished; continue it with --resume {name}, or merge what is there with --partial"
    )]
    Unfinished {
        /// Which.
        name: String,
    },
    /// Not all parts are there.
    #[error("{missing}; render what is missing, or merge what is there with --partial")]
    Missing {
        /// Which, in words.
        missing: String,
    },
}

/// Puts parts together; with `partial`, whatever is there of them.
///
/// # Errors
/// [`MergeError`].
pub fn merge(parts: Vec<(String, Part)>, partial: bool) -> Result<Merged, MergeError> {
    let (first, others) = parts.split_first().ok_or(MergeError::Nothing)?;
    for (name, part) in others {
        first.1.same_picture(part).and_then(|()| same_cut(part, &first.1)).map_err(|difference| {
            MergeError::Different { name: name.clone(), first: first.0.clone(), difference }
        })?;
    }
    let Shard { count, .. } = first.1.plan.shard;
    let mut by_index: Vec<Option<&str>> = vec![None; count as usize];
    for (name, part) in &parts {
        let shard = part.plan.shard;
        if let Some(earlier) = by_index[shard.index as usize].replace(name) {
            let (first, second) = (earlier.to_owned(), name.clone());
            return Err(MergeError::Doubled { first, second, shard: shard.to_string() });
        }
        if !partial && !part.is_complete() {
            return Err(MergeError::Unfinished { name: name.clone() });
        }
    }
    let missing: Vec<u32> =
        (0..count).filter(|&index| by_index[index as usize].is_none()).map(|index| index + 1).collect();
    if !partial && !missing.is_empty() {
        return Err(MergeError::Missing { missing: in_words(&missing, count) });
    }
    let (facts, scene, samples) = (first.1.facts.clone(), first.1.scene.clone(), first.1.samples);
    let (picture, statistics, coverage) = join(parts);
    Ok(Merged { facts, scene, samples, picture, statistics, coverage, missing })
}

/// Whether two renders were cut in the same way.
fn same_cut(there: &Part, here: &Part) -> Result<(), Difference> {
    differ("number of samples", there.samples, here.samples)?;
    differ("number of shards", there.plan.shard.count, here.plan.shard.count)?;
    let by = |part: &Part| if part.plan.shard.by == ShardBy::Tiles { "tiles" } else { "samples" };
    differ("way of cutting", by(there), by(here))
}

fn join(mut parts: Vec<(String, Part)>) -> (Picture, Statistics, Coverage) {
    parts.sort_by_key(|(_, part)| part.plan.shard.index);
    let (window, place, samples) = (parts[0].1.window(), parts[0].1.place, parts[0].1.samples);
    let mut film = Film::new(window.width, window.height, &parts[0].1.channels);
    let tiles = tiles(window);
    let mut statistics = Statistics::default();
    let mut time = Duration::ZERO;
    let mut pieces: Vec<Vec<TileFilm>> = vec![Vec::new(); tiles.len()];
    for (_, part) in parts {
        time += part.time;
        for tile in part.tiles {
            statistics.merge(&tile.statistics);
            let pieces = &mut pieces[tile.number as usize];
            match pieces.last_mut() {
                Some(last) if last.samples.end == tile.film.samples.start => last.append(tile.film),
                _ => pieces.push(tile.film),
            }
        }
    }
    let mut coverage = Coverage { least: u32::MAX, most: 0, complete: true };
    for (tile, pieces) in tiles.iter().zip(&pieces) {
        let there = pieces.iter().map(|piece| piece.samples.len() as u32).sum();
        coverage.least = coverage.least.min(there);
        coverage.most = coverage.most.max(there);
        coverage.complete &= there == samples;
        let totals = pieces.iter().map(|piece| piece.total().into_owned());
        let join = |mut total: Sums, piece: Sums| {
            total.absorb(&piece);
            total
        };
        if let Some(total) = totals.reduce(join) {
            film.place(tile, &total);
        }
    }
    statistics.time = time;
    (Picture { place, ..film.develop() }, statistics, coverage)
}

/// `shards 2, 5 and 7 of 9 are not there`; numbers count from 1.
fn in_words(numbers: &[u32], count: u32) -> String {
    // A picture of a thousand shards of which ten are there.
    const MOST: usize = 20;
    let mut shown: Vec<String> = numbers.iter().take(MOST).map(u32::to_string).collect();
    if numbers.len() > MOST {
        shown.push(format!("{} more", numbers.len() - MOST));
    }
    match shown.split_last() {
        Some((only, [])) => format!("shard {only} of {count} is not there"),
        Some((last, others)) => format!("shards {} and {last} of {count} are not there", others.join(", ")),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing_is_named() {
        assert_eq!(in_words(&[3], 4), "shard 3 of 4 is not there");
        assert_eq!(in_words(&[3, 4, 9], 9), "shards 3, 4 and 9 of 9 are not there");
        let many: Vec<u32> = (1..=100).collect();
        let told = in_words(&many, 200);
        assert!(told.ends_with("20 and 80 more of 200 are not there"), "{told}");
    }
}
