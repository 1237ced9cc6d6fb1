//! The threads that a command runs on.

use clap::{Args, builder::RangedU64ValueParser};
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::failure::Failure;

/// The option, for every command that has much to do.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct ThreadsOption {
    /// Threads; one a core if not given
    #[arg(short, long, visible_alias = "nthreads", value_name = "N", value_parser = RangedU64ValueParser::<usize>::new().range(1..=1024))]
    threads: Option<usize>,
}

impl ThreadsOption {
    /// As many threads as asked for, or one a core.
    pub(super) fn pool(self) -> Result<ThreadPool, Failure> {
        let builder = ThreadPoolBuilder::new().num_threads(self.threads.unwrap_or(0));
        builder.build().map_err(|error| Failure::Sentence(format!("can't start threads: {error}")))
    }
}
