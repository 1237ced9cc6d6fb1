//! The threads that a command runs on.

use clap::builder::RangedU64ValueParser;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::failure::Failure;

/// For clap: a number of threads.
pub(super) fn count() -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(1..=1024)
}

/// As many threads as asked for, or one a core.
pub(super) fn pool(threads: Option<usize>) -> Result<ThreadPool, Failure> {
    let builder = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    builder.build().map_err(|error| Failure::Sentence(format!("can't start threads: {error}")))
}
