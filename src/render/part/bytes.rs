//! Parts as bytes, and back.
//!
//! ```text
//! magic, version · facts · scene · channels · width, height, samples · place · shard, target error · time
//! tiles: number · first and next sample · statistics · nodes: level, index, sums · open block · spread
//! digest of all that was before
//! ```
//!
//! Numbers are little-endian; a list is its length, then its items; floats are their bits. Nothing that is
//! not there is believed: a length is checked against what is left of the file before memory is taken.

use std::time::Duration;

use super::{Part, PartTile};
use crate::{
    film::{
        TileFilm,
        spread::Spread,
        sums::{Node, Sums},
    },
    math::Digest,
    picture::Place,
    render::{LaneUse, Plan, Shard, ShardBy, Statistics},
};

const MAGIC: &[u8] = b"packlight part\n";

/// Grows whenever the meaning of the bytes changes.
const VERSION: u32 = 2;

/// Why bytes are no part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PartFormatError {
    /// They are something else.
    #[error("this is no checkpoint and no shard")]
    Foreign,
    /// Another program wrote them.
    #[error(
        "its format has version {0}, and this program reads version {VERSION}; use the program that wrote it"
    )]
    Version(u32),
    /// The digest at the end is not that of what is before it, or something is missing.
    #[error("it is damaged")]
    Damaged,
    /// It contradicts itself.
    #[error("it is damaged: {0}")]
    Contradiction(&'static str),
}

impl Part {
    /// The part as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer(MAGIC.to_vec());
        out.u32(VERSION);
        out.u32(self.facts.len() as u32);
        for (name, value) in &self.facts {
            out.text(name);
            out.text(value);
        }
        out.text(&self.scene);
        out.u32(self.channels.len() as u32);
        self.channels.iter().for_each(|channel| out.text(channel));
        [self.width, self.height, self.samples].into_iter().for_each(|number| out.u32(number));
        let place = self.place.map(|Place { x, y, width, height }| [x, y, width, height]);
        out.words(place.as_slice().as_flattened());
        let Plan { shard, target_error } = self.plan;
        let by = u32::from(shard.by == ShardBy::Samples);
        [shard.index, shard.count, by].into_iter().for_each(|number| out.u32(number));
        out.floats(target_error.as_slice());
        out.u64(self.time.as_nanos() as u64);
        out.u32(self.tiles.len() as u32);
        self.tiles.iter().for_each(|tile| out.tile(tile));
        let digest = digest(&out.0);
        out.u64(digest);
        out.0
    }

    /// The part that bytes are.
    ///
    /// # Errors
    /// [`PartFormatError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PartFormatError> {
        let rest = bytes.strip_prefix(MAGIC).ok_or(PartFormatError::Foreign)?;
        let version = Reader(rest).u32().ok_or(PartFormatError::Damaged)?;
        if version != VERSION {
            return Err(PartFormatError::Version(version));
        }
        let (body, end) = bytes.split_last_chunk::<8>().ok_or(PartFormatError::Damaged)?;
        if digest(body) != u64::from_le_bytes(*end) {
            return Err(PartFormatError::Damaged);
        }
        let part = body.get(MAGIC.len() + 4..).and_then(|body| Reader(body).part());
        let part = part.ok_or(PartFormatError::Damaged)?;
        part.defect().map_or(Ok(part), |defect| Err(PartFormatError::Contradiction(defect)))
    }
}

/// Of words, and of the bytes that are left over.
fn digest(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<4>();
    let mut digest = Digest::default();
    words.iter().for_each(|word| digest.word(u32::from_le_bytes(*word)));
    digest.bytes(rest).value()
}

struct Writer(Vec<u8>);

impl Writer {
    fn u32(&mut self, number: u32) {
        self.0.extend(number.to_le_bytes());
    }

    fn u64(&mut self, number: u64) {
        self.0.extend(number.to_le_bytes());
    }

    fn text(&mut self, text: &str) {
        self.u32(text.len() as u32);
        self.0.extend(text.as_bytes());
    }

    fn words(&mut self, words: &[u32]) {
        self.u32(words.len() as u32);
        self.0.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    }

    fn floats(&mut self, floats: &[f32]) {
        self.u32(floats.len() as u32);
        self.bare(floats.iter().copied());
    }

    /// Without their number.
    fn bare(&mut self, floats: impl Iterator<Item = f32>) {
        self.0.extend(floats.flat_map(|x| x.to_bits().to_le_bytes()));
    }

    fn sums(&mut self, sums: &Sums) {
        let (pixels, channels) = (sums.pixels(), sums.channels());
        self.u32((pixels * channels) as u32);
        (0..channels).for_each(|channel| self.bare(sums.plane(channel)));
        self.u32(pixels as u32);
        self.bare(sums.plane(channels));
        self.words(sums.counts());
    }

    fn tile(&mut self, PartTile { number, film, statistics }: &PartTile) {
        [*number, film.samples.start, film.samples.end].into_iter().for_each(|number| self.u32(number));
        counters(statistics).into_iter().for_each(|count| self.u64(count));
        self.u32(film.first_invalid.is_some().into());
        let (pixel, sample) = film.first_invalid.unwrap_or_default();
        let (x, y, _) = statistics.first_invalid.unwrap_or_default();
        [pixel, sample, x, y].into_iter().for_each(|number| self.u32(number));
        self.u32(film.nodes.len() as u32);
        for Node { level, index, sums } in &film.nodes {
            self.u32(*level);
            self.u32(*index);
            self.sums(sums);
        }
        match &film.open {
            Some(open) => self.sums(open),
            None => self.sums(&Sums::new(film.pixels(), film.channels())),
        }
        self.u32(film.spread.is_some().into());
        if let Some(spread) = &film.spread {
            self.u32(spread.blocks);
            self.floats(&spread.sums);
            self.floats(&spread.squares);
        }
    }
}

/// Everything that is counted.
fn counters(statistics: &Statistics) -> [u64; 9] {
    let Statistics { trace_lanes, shade_lanes, .. } = statistics;
    [
        statistics.samples,
        statistics.camera_rays,
        statistics.bounce_rays,
        statistics.shadow_rays,
        trace_lanes.active,
        trace_lanes.total,
        shade_lanes.active,
        shade_lanes.total,
        statistics.invalid_samples,
    ]
}

/// What is left to read; `None` from any of its functions is the end of the bytes.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn u32(&mut self) -> Option<u32> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(u32::from_le_bytes(*bytes))
    }

    fn u64(&mut self) -> Option<u64> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(u64::from_le_bytes(*bytes))
    }

    /// So many items, each of them at least one word.
    fn list<T>(&mut self, item: impl Fn(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let length = self.u32()? as usize;
        if length > self.0.len() / 4 {
            return None;
        }
        (0..length).map(|_| item(self)).collect()
    }

    fn text(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        let (bytes, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        String::from_utf8(bytes.to_vec()).ok()
    }

    fn words(&mut self) -> Option<Vec<u32>> {
        let length = self.u32()? as usize;
        let (bytes, rest) = self.0.split_at_checked(length.checked_mul(4)?)?;
        self.0 = rest;
        Some(bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect())
    }

    fn floats(&mut self) -> Option<Vec<f32>> {
        Some(self.words()?.into_iter().map(f32::from_bits).collect())
    }

    fn sums(&mut self) -> Option<Sums> {
        Sums::from_planes(&self.floats()?, &self.floats()?, self.words()?)
    }

    fn part(&mut self) -> Option<Part> {
        let facts = self.list(|reader| Some((reader.text()?, reader.text()?)))?;
        let (scene, channels) = (self.text()?, self.list(Self::text)?);
        let (width, height, samples) = (self.u32()?, self.u32()?, self.u32()?);
        let place = match *self.words()? {
            [] => None,
            [x, y, width, height] => Some(Place { x, y, width, height }),
            _ => return None,
        };
        let (index, count) = (self.u32()?, self.u32()?);
        let by = if self.u32()? == 0 { ShardBy::Tiles } else { ShardBy::Samples };
        let target_error = self.floats()?.first().copied();
        let plan = Plan { shard: Shard { index, count, by }, target_error };
        let time = Duration::from_nanos(self.u64()?);
        let tiles = self.list(Self::tile)?;
        self.0.is_empty().then_some(Part {
            facts,
            scene,
            channels,
            width,
            height,
            place,
            samples,
            plan,
            time,
            tiles,
        })
    }

    fn tile(&mut self) -> Option<PartTile> {
        let (number, start, end) = (self.u32()?, self.u32()?, self.u32()?);
        let mut counters = [0; 9];
        for counter in &mut counters {
            *counter = self.u64()?;
        }
        let [samples, camera_rays, bounce_rays, shadow_rays, a, b, c, d, invalid] = counters;
        let some_invalid = self.u32()? != 0;
        let (pixel, sample, x, y) = (self.u32()?, self.u32()?, self.u32()?, self.u32()?);
        let nodes = self
            .list(|reader| Some(Node { level: reader.u32()?, index: reader.u32()?, sums: reader.sums()? }))?;
        let open = self.sums()?;
        let spread = match self.u32()? {
            0 => None,
            _ => Some(Spread { blocks: self.u32()?, sums: self.floats()?, squares: self.floats()? }),
        };
        let mut film = TileFilm::new(open.pixels(), open.channels(), start);
        film.samples.end = end;
        film.reopen(open);
        (film.nodes, film.spread, film.invalid) = (nodes, spread, invalid);
        film.first_invalid = some_invalid.then_some((pixel, sample));
        let statistics = Statistics {
            samples,
            camera_rays,
            bounce_rays,
            shadow_rays,
            trace_lanes: LaneUse { active: a, total: b },
            shade_lanes: LaneUse { active: c, total: d },
            invalid_samples: invalid,
            first_invalid: some_invalid.then_some((x, y, sample)),
            ..Statistics::default()
        };
        Some(PartTile { number, film, statistics })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part() -> Part {
        let mut film = TileFilm::new(6, 3, 0);
        film.spread = Some(Spread::new(6));
        for sample in 0..21 {
            film.add_samples(1, &mut Vec::new(), |samples| {
                for pixel in 0..6 {
                    let invalid = sample == 5 && pixel == 4;
                    samples.add(pixel, 0, 1.0, |c| if invalid { f32::NAN } else { (sample + c) as f32 });
                }
            });
        }
        let statistics = Statistics {
            samples: 126,
            camera_rays: 7,
            invalid_samples: 1,
            first_invalid: Some((1, 1, 5)),
            ..Statistics::default()
        };
        Part {
            facts: vec![("seed".into(), "7".into()), ("scene".into(), "ä".into())],
            scene: "cornell.xml".into(),
            channels: ["R", "G", "B"].map(String::from).into(),
            width: 3,
            height: 2,
            place: Some(Place { x: 1, y: 0, width: 4, height: 2 }),
            samples: 32,
            plan: Plan { shard: Shard::WHOLE, target_error: Some(0.01) },
            time: Duration::from_millis(1234),
            tiles: vec![PartTile { number: 0, film, statistics }],
        }
    }

    /// The bytes with the digest that belongs to them.
    fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
        bytes.truncate(bytes.len() - 8);
        let digest = digest(&bytes).to_le_bytes();
        bytes.extend(digest);
        bytes
    }

    #[test]
    fn a_part_survives() {
        assert_eq!(Part::from_bytes(&part().to_bytes()), Ok(part()));
    }

    #[test]
    fn every_truncation_and_every_flipped_byte_is_refused() {
        let bytes = part().to_bytes();
        for length in 0..bytes.len() {
            assert!(Part::from_bytes(&bytes[..length]).is_err(), "{length}");
        }
        for at in 0..bytes.len() {
            let mut flipped = bytes.clone();
            flipped[at] ^= 0x41;
            assert!(Part::from_bytes(&flipped).is_err(), "{at}");
        }
    }

    #[test]
    fn lengths_are_not_believed_even_under_a_good_digest() {
        let bytes = part().to_bytes();
        for at in MAGIC.len() + 4..bytes.len() - 8 {
            let mut wrong = bytes.clone();
            wrong[at] = 0xff;
            // Whatever it says, it neither panics nor takes memory that is not there.
            let _ = Part::from_bytes(&sealed(wrong));
        }
    }

    #[test]
    fn what_it_is_not_is_told() {
        assert_eq!(Part::from_bytes(b"\x89PNG"), Err(PartFormatError::Foreign));
        let mut newer = part().to_bytes();
        newer[MAGIC.len()] = 9;
        assert_eq!(Part::from_bytes(&newer), Err(PartFormatError::Version(9)));
        let contradicted = |change: &dyn Fn(&mut Part)| {
            let mut part = part();
            change(&mut part);
            let error = Part::from_bytes(&part.to_bytes()).unwrap_err();
            assert!(matches!(error, PartFormatError::Contradiction(_)), "{error}");
        };
        contradicted(&|part| part.tiles[0].number = 1);
        contradicted(&|part| part.place = Some(Place { x: 2, y: 0, width: 4, height: 2 }));
        contradicted(&|part| part.place = Some(Place { x: 0, y: u32::MAX, width: 4, height: 2 }));
    }
}
