//! `--shard`: which part of a render this is.

use clap::{Args, ValueEnum};

use crate::{
    cli::failure::Failure,
    film::sums::BLOCK,
    render::{Shard, ShardBy},
};

const MACHINES: &str = "Several machines (`packlight merge` joins what they make)";

/// The options.
#[derive(Clone, Debug, Args)]
pub(super) struct ShardOptions {
    /// Render one of so many parts, counted from 1
    #[arg(long, value_name = "I/N", help_heading = MACHINES, value_parser = shard)]
    shard: Option<[u32; 2]>,

    /// Take the part's number, counted from 0, from an environment variable, as SLURM_ARRAY_TASK_ID or
    /// JOB_COMPLETION_INDEX
    #[arg(long, value_name = "VAR", help_heading = MACHINES, conflicts_with = "shard", requires = "shards")]
    shard_from: Option<String>,

    /// How many parts there are, for --shard-from
    #[arg(long, value_name = "N", help_heading = MACHINES, requires = "shard_from",
          value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST)))]
    shards: Option<u32>,

    /// What is shared out: tiles of the picture, or samples of all of it
    #[arg(long, value_name = "WHAT", help_heading = MACHINES, default_value = "tiles")]
    shard_by: By,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum By {
    Tiles,
    Samples,
}

/// Parts of one render.
const MOST: u32 = 1 << 20;

impl ShardOptions {
    /// The part that is asked for, if one is.
    pub(super) fn get(&self) -> Result<Option<Shard>, Failure> {
        let by = match self.shard_by {
            By::Tiles => ShardBy::Tiles,
            By::Samples => ShardBy::Samples,
        };
        if let Some([number, count]) = self.shard {
            return Ok(Some(Shard { index: number - 1, count, by }));
        }
        let (Some(variable), Some(count)) = (&self.shard_from, self.shards) else { return Ok(None) };
        let value = std::env::var(variable).map_err(|_| {
            Failure::Sentence(format!("--shard-from: the environment has no variable {variable}"))
        })?;
        match value.trim().parse() {
            Ok(index) if index < count => Ok(Some(Shard { index, count, by })),
            _ => Err(Failure::Sentence(format!(
                "--shard-from: {variable} is `{value}`; expected a number from 0 to {}, as from `--array=0-{0}`",
                count - 1
            ))),
        }
    }
}

/// Why a part would be empty, if it would.
pub(super) fn too_many(shard: Shard, samples: u32, tiles: usize) -> Option<String> {
    let (what, there) = match shard.by {
        ShardBy::Samples => (
            format!("{samples} samples are shared out in blocks of {BLOCK}"),
            samples.div_ceil(BLOCK) as usize,
        ),
        ShardBy::Tiles => ("the picture has few tiles".into(), tiles),
    };
    (shard.count as usize > there).then(|| {
        let count = shard.count;
        format!("{what}: there are {there} for {count} shards; use fewer, or the other --shard-by")
    })
}

fn shard(argument: &str) -> Result<[u32; 2], String> {
    let numbers = argument.split_once('/').map(|(number, count)| (number.parse(), count.parse()));
    match numbers {
        Some((Ok(number), Ok(count))) if 1 <= number && number <= count && count <= MOST => {
            Ok([number, count])
        }
        _ => Err("expected a number from 1 up and how many there are, as in --shard 3/16".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_counted_from_one() {
        assert_eq!(shard("3/16"), Ok([3, 16]));
        for wrong in ["", "3", "0/4", "5/4", "1/0", "-1/4", "a/b", "1/99999999"] {
            assert!(shard(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn no_shard_is_empty() {
        let by = |by| Shard { index: 0, count: 5, by };
        assert_eq!(too_many(by(ShardBy::Samples), 65, 1), None);
        assert!(too_many(by(ShardBy::Samples), 64, 9).is_some_and(|why| why.contains("there are 4 for 5")));
        assert!(too_many(by(ShardBy::Tiles), 640, 4).is_some());
    }
}
