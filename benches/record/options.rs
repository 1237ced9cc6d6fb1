//! What is to be measured, and how much of it.

use std::path::{Path, PathBuf};

use clap::Parser;
use packlight::scene::Film;

use crate::row::Table;

/// Makes the record: benches/record/DATE-CPU.csv and growth.svg. Measurements are merged into the file of
/// the day, so a record can be made in pieces
#[derive(Clone, Debug, Parser)]
#[command(name = "cargo bench --bench record --", bin_name = "cargo bench --bench record --")]
pub(crate) struct Options {
    /// Only this part; repeatable
    #[arg(long, value_enum, value_name = "PART")]
    pub(crate) only: Vec<Table>,

    /// Only scenes with this in their names, as in `gen:soup` or `kitchen`; repeatable
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,

    /// Only this class of rays in `scenes` and `peers`; repeatable
    #[arg(long, value_name = "CLASS")]
    pub(crate) class: Vec<String>,

    /// A quick look: meshes up to 100k, one timed run, and nothing is written into the repository
    #[arg(long)]
    pub(crate) quick: bool,

    /// Threads that trace, for `peers`; repeatable
    #[arg(long, value_name = "N", default_values_t = [1, 2])]
    pub(crate) threads: Vec<usize>,

    /// More options for `packlight bench` in `peers`, kept in the record, as in "--quality high"
    #[arg(long, value_name = "OPTIONS", default_value = "", allow_hyphen_values = true)]
    pub(crate) ours: String,

    /// Name of the processor, where it does not say its own
    #[arg(long, value_name = "NAME")]
    pub(crate) cpu: Option<String>,

    /// Continue this file in place of that of the day
    #[arg(long, value_name = "FILE")]
    pub(crate) into: Option<PathBuf>,

    /// Measure nothing: print the tables of the newest record, or of --into, and draw its picture again
    #[arg(long)]
    pub(crate) tables: bool,

    /// Said by cargo where benches are to be measured.
    #[arg(long, hide = true)]
    bench: bool,

    /// Said by whoever wants to know that it works: tiny, into a folder that is removed.
    #[arg(long, hide = true)]
    test: bool,

    /// Which of all benches cargo is to run.
    #[arg(hide = true)]
    filter: Option<String>,
}

impl Options {
    /// How much is measured.
    pub(crate) fn extent(&self) -> Extent {
        if self.test || !self.bench {
            Extent::Smoke
        } else if self.quick {
            Extent::Quick
        } else {
            Extent::Full
        }
    }

    /// Is this bench meant at all?
    pub(crate) fn is_meant(&self) -> bool {
        self.filter.as_ref().is_none_or(|filter| "record".contains(filter.as_str()))
    }

    /// Is this to be measured?
    pub(crate) fn wants(&self, table: Table, scene: &str) -> bool {
        (self.only.is_empty() || self.only.contains(&table))
            && (self.scene.is_empty() || self.scene.iter().any(|part| scene.contains(part.as_str())))
    }

    /// The same for a class of rays.
    pub(crate) fn wants_class(&self, class: &str) -> bool {
        self.class.is_empty() || self.class.iter().any(|wanted| wanted == class)
    }
}

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    /// For the record.
    Full,
    /// For a look.
    Quick,
    /// To see that it works.
    Smoke,
}

impl Extent {
    /// Sizes of the meshes of `growth`.
    pub(crate) fn sizes(self) -> &'static [&'static str] {
        match self {
            Self::Full => &["1k", "10k", "100k", "1M", "10M"],
            Self::Quick => &["1k", "10k", "100k"],
            Self::Smoke => &["200", "500", "1k"],
        }
    }

    /// A ray of the camera for each pixel.
    pub(crate) fn film(self) -> Film {
        match self {
            Self::Smoke => Film::new(64, 48),
            Self::Full | Self::Quick => Film::new(640, 480),
        }
    }

    /// Timed runs, of which the best counts.
    pub(crate) fn repeat(self) -> u32 {
        match self {
            Self::Full => 5,
            Self::Quick | Self::Smoke => 1,
        }
    }

    /// Where the record is kept: only a full one belongs to the repository.
    pub(crate) fn folder(self, scratch: &Path) -> PathBuf {
        match self {
            Self::Full => Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/record"),
            Self::Quick => Path::new(env!("CARGO_TARGET_TMPDIR")).join("record"),
            Self::Smoke => scratch.to_owned(),
        }
    }
}
