//! `--quality`: how much work goes into the tree.

use std::fmt;

use clap::{Args, ValueEnum};

use crate::bvh::Quality;

/// The option, for every command that builds a tree.
#[derive(Clone, Copy, Debug, Args)]
pub(super) struct QualityOption {
    /// Work put into the tree; the picture stays the same to the bit
    #[arg(id = "quality", long = "quality", value_name = "NAME", default_value = "medium")]
    name: QualityName,
}

/// A [`Quality`] as it is typed and printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum QualityName {
    /// Built in half to two thirds of medium's time, for a first look; rays take up to twice as long
    Fast,
    /// For most pictures
    Medium,
    /// Built in four to eight times medium's time, for long renders of buildings and rooms
    High,
}

impl QualityOption {
    pub(super) fn quality(self) -> Quality {
        match self.name {
            QualityName::Fast => Quality::Fast,
            QualityName::Medium => Quality::Medium,
            QualityName::High => Quality::High,
        }
    }
}

impl From<Quality> for QualityName {
    fn from(quality: Quality) -> Self {
        match quality {
            Quality::Fast => Self::Fast,
            Quality::Medium => Self::Medium,
            Quality::High => Self::High,
        }
    }
}

impl QualityName {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Medium => "medium",
            Self::High => "high",
        }
    }
}

impl fmt::Display for QualityName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
