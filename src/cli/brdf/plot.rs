//! The file that a drawing goes to.

use std::path::PathBuf;

use crate::{cli::failure::Failure, lobe::Drawing, picture::write_whole};

/// A path whose extension says what to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Plot {
    pub(super) path: PathBuf,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Svg,
    Png,
}

impl Plot {
    /// For clap: a usage error if the extension is unknown.
    pub(super) fn parse(argument: &str) -> Result<Self, String> {
        let path = PathBuf::from(argument);
        let kind = match path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).as_deref() {
            Some("svg") => Kind::Svg,
            Some("png") => Kind::Png,
            _ => return Err("the extension decides what is drawn: .svg or .png".into()),
        };
        Ok(Self { path, kind })
    }

    /// Writes the drawing; under the name there is always a whole file.
    pub(super) fn write(&self, drawing: Drawing) -> Result<(), Failure> {
        let told = |reason: String| Failure::Sentence(format!("{}: {reason}", self.path.display()));
        let bytes = match self.kind {
            Kind::Svg => drawing.svg()?.into_bytes(),
            Kind::Png => drawing.png().map_err(told)?,
        };
        write_whole(&self.path, &bytes).map_err(|error| told(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_decides_in_any_case() {
        assert_eq!(Plot::parse("a.SVG").unwrap().kind, Kind::Svg);
        assert_eq!(Plot::parse("b/a.png").unwrap().kind, Kind::Png);
        for name in ["a", "a.", "a.exr", "svg", ".svg"] {
            assert!(Plot::parse(name).is_err(), "{name}");
        }
    }
}
