//! A run of the record: who measures what, and where it goes.

use std::path::PathBuf;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::{
    book::Book,
    date,
    machine::Machine,
    options::{Extent, Options},
    row::{Row, Table},
};

/// What every part of the record needs.
pub(crate) struct Run {
    pub(crate) options: Options,
    pub(crate) extent: Extent,
    pub(crate) book: Book,
    machine: Machine,
    date: String,
}

impl Run {
    /// Opens the file of the day, or the one that is to be continued.
    pub(crate) fn open(options: Options, extent: Extent, folder: PathBuf) -> Result<Self, String> {
        let machine = Machine::of_this_run(options.cpu.as_deref());
        let date = date::today();
        let of_the_day = || folder.join(format!("{date}-{}.csv", machine.slug()));
        let book = Book::open(&options.into.clone().unwrap_or_else(of_the_day))?;
        Ok(Self { options, extent, book, machine, date })
    }

    /// A row that says when, where and with what.
    pub(crate) fn row(&self, threads: usize, table: Table, scene: &str, class: &str) -> Row {
        Row::new(&self.date, &self.machine, threads, table, scene, class)
    }
}

/// Threads to run on; 0 is one a core.
pub(crate) fn pool(threads: usize) -> Result<ThreadPool, String> {
    ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| error.to_string())
}
