//! Where things of a scene are described, for what is found out about them later.

use std::path::{Path, PathBuf};

use super::{Warning, mitsuba::Span};

/// Where the shapes of a description come from, in its order.
#[derive(Clone, Debug, Default)]
pub struct Origins {
    /// Of the shapes that stand in the world.
    pub shapes: Vec<Origin>,
    /// Of those in groups.
    pub groups: Vec<Vec<Origin>>,
}

impl Origins {
    /// Shapes that are parts of one file.
    pub(super) fn of_file(path: &Path, shapes: usize) -> Self {
        Self { shapes: vec![Origin(Source::File(path.to_owned())); shapes], groups: vec![] }
    }
}

/// Where a shape comes from.
#[derive(Clone, Debug)]
pub struct Origin(Source);

#[derive(Clone, Debug)]
enum Source {
    File(PathBuf),
    Element(Span),
}

impl Origin {
    pub(super) fn element(span: Span) -> Self {
        Self(Source::Element(span))
    }

    /// A warning that shows the place.
    pub fn warning(&self, message: impl Into<String>) -> Warning {
        match &self.0 {
            Source::File(path) => Warning::new(path, message),
            Source::Element(span) => span.warning(message),
        }
    }
}
