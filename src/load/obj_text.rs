//! The text of an OBJ file: checked line by line, so that whatever is wrong has a line and a column,
//! and rewritten into the narrow dialect that every parser of the format agrees on.

use std::{fmt::Write, ops::Range, path::Path};

use super::{LoadError, Warning, text};

/// An OBJ file that has passed the checks.
pub(super) struct ObjText {
    /// `v`, `vt`, `vn` and `f` only; every corner of a face is `v/vt/vn` with positive indices.
    /// A corner without `vt` or `vn` refers to the first, which is zero and stands for "none".
    pub(super) geometry: String,
    /// Which material the triangles of [`geometry`](Self::geometry) have, in order.
    pub(super) runs: Vec<Run>,
    /// The names after `mtllib`.
    pub(super) libraries: Vec<String>,
    /// Do the corners have normals?
    pub(super) normals: Coverage,
    /// Do the corners have texture coordinates?
    pub(super) uvs: Coverage,
}

/// Consecutive triangles of one material.
#[derive(Debug, PartialEq)]
pub(super) struct Run {
    /// The name after `usemtl`.
    pub(super) material: Option<String>,
    /// How many, with polygons as fans.
    pub(super) triangles: usize,
}

/// How many corners of the faces have something.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Coverage {
    with: usize,
    without: usize,
}

impl Coverage {
    /// All corners.
    pub(super) fn is_full(self) -> bool {
        self.with > 0 && self.without == 0
    }

    /// Some corners, but not all.
    pub(super) fn is_partial(self) -> bool {
        self.with > 0 && self.without > 0
    }

    /// At least one corner.
    pub(super) fn is_any(self) -> bool {
        self.with > 0
    }
}

/// Reads and checks a file.
pub(super) fn read(path: &Path, warnings: &mut Vec<Warning>) -> Result<ObjText, LoadError> {
    let source = text::read(path)?;
    // Blanks in place of a continuation keep every offset.
    let joined = source.replace("\\\r\n", "   ").replace("\\\n", "  ");
    let mut reader = Reader::new(path, &source, &joined);
    for line in joined.split(['\n', '\r']) {
        reader.line(line)?;
    }
    reader.finish(warnings)
}

/// Positions, texture coordinates, normals: the order of the indices of a corner.
const KINDS: [&str; 3] = ["v", "vt", "vn"];

struct Reader<'a> {
    path: &'a Path,
    /// For messages: with its line breaks.
    source: &'a str,
    joined: &'a str,
    counts: [usize; 3],
    /// The largest positive index and where it stands: vertices may follow the faces that use them.
    furthest: [(usize, Range<usize>); 3],
    material: Option<String>,
    dropped: usize,
    wires: usize,
    text: ObjText,
}

impl<'a> Reader<'a> {
    fn new(path: &'a Path, source: &'a str, joined: &'a str) -> Self {
        let text = ObjText {
            geometry: String::with_capacity(joined.len() + 32),
            runs: Vec::new(),
            libraries: Vec::new(),
            normals: Coverage::default(),
            uvs: Coverage::default(),
        };
        let mut reader = Self {
            path,
            source,
            joined,
            counts: [0; 3],
            furthest: [(0, 0..0), (0, 0..0), (0, 0..0)],
            material: None,
            dropped: 0,
            wires: 0,
            text,
        };
        reader.text.geometry.push_str("vt 0 0\nvn 0 0 0\n");
        reader
    }

    fn error(&self, part: &str, message: impl Into<String>) -> LoadError {
        LoadError::at(self.path, self.source, text::range_of(self.joined, part), message)
    }

    fn line(&mut self, line: &'a str) -> Result<(), LoadError> {
        let line = line.split('#').next().unwrap_or_default().trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "v" => self.numbers(0, line, 3),
            "vt" => self.numbers(1, line, 2),
            "vn" => self.numbers(2, line, 3),
            "f" => self.face(line),
            "l" | "p" => {
                self.wires += 1;
                Ok(())
            }
            "usemtl" => {
                self.material = Some(rest.trim().to_owned()).filter(|name| !name.is_empty());
                Ok(())
            }
            "mtllib" => {
                self.text.libraries.push(rest.trim().to_owned());
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The first numbers of a line; what may follow (weights, colours) is left out.
    fn numbers(&mut self, kind: usize, line: &str, wanted: usize) -> Result<(), LoadError> {
        self.text.geometry.push_str(KINDS[kind]);
        let mut found = 0;
        for word in line.split_whitespace().skip(1).take(wanted) {
            match word.parse::<f32>() {
                Ok(number) if number.is_finite() => {}
                Ok(_) => return Err(self.error(word, format!("`{word}` is not a finite number"))),
                Err(_) => return Err(self.error(word, format!("expected a number, found `{word}`"))),
            }
            self.text.geometry.push(' ');
            self.text.geometry.push_str(word);
            found += 1;
        }
        // `vt u` is legal.
        if kind == 1 && found == 1 {
            self.text.geometry.push_str(" 0");
        } else if found < wanted {
            let message = format!("`{}` needs {wanted} numbers, found {found}", KINDS[kind]);
            return Err(self.error(line, message));
        }
        self.text.geometry.push('\n');
        self.counts[kind] += 1;
        Ok(())
    }

    fn face(&mut self, line: &str) -> Result<(), LoadError> {
        let start = self.text.geometry.len();
        let mut corners = 0;
        self.text.geometry.push('f');
        for word in line.split_whitespace().skip(1) {
            let [v, vt, vn] = self.corner(word)?;
            let Some(v) = v else {
                return Err(self.error(word, format!("the corner `{word}` has no vertex")));
            };
            for (coverage, index) in [(&mut self.text.uvs, vt), (&mut self.text.normals, vn)] {
                *(if index.is_some() { &mut coverage.with } else { &mut coverage.without }) += 1;
            }
            // One-based, and one further for the zero that stands first.
            let [vt, vn] = [vt, vn].map(|index| index.map_or(1, |index| index + 2));
            // Writing to a string can't fail.
            let _ = write!(self.text.geometry, " {}/{vt}/{vn}", v + 1);
            corners += 1;
        }
        self.text.geometry.push('\n');
        if corners < 3 {
            self.text.geometry.truncate(start);
            self.dropped += 1;
            return Ok(());
        }
        match self.text.runs.last_mut() {
            Some(run) if run.material == self.material => run.triangles += corners - 2,
            _ => self.text.runs.push(Run { material: self.material.clone(), triangles: corners - 2 }),
        }
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 0.
    fn corner(&mut self, word: &str) -> Result<[Option<usize>; 3], LoadError> {
        let mut indices = [None; 3];
        let mut parts = word.split('/');
        for (kind, part) in parts.by_ref().take(3).enumerate() {
            if part.is_empty() {
                continue;
            }
            let number: i64 = part
                .parse()
                .map_err(|_| self.error(word, format!("expected a corner `v/vt/vn`, found `{word}`")))?;
            let count = self.counts[kind];
            let index = match usize::try_from(number) {
                Ok(0) => return Err(self.error(part, "index 0: OBJ counts from 1")),
                Ok(index) => index - 1,
                Err(_) => usize::try_from(number.unsigned_abs())
                    .ok()
                    .and_then(|back| count.checked_sub(back))
                    .ok_or_else(|| {
                        let kind = KINDS[kind];
                        self.error(part, format!("index {number}, but only {count} `{kind}` stand before it"))
                    })?,
            };
            if index > self.furthest[kind].0 || self.furthest[kind].1.is_empty() {
                self.furthest[kind] = (index, text::range_of(self.joined, part));
            }
            indices[kind] = Some(index);
        }
        match parts.next() {
            None => Ok(indices),
            Some(_) => Err(self.error(word, format!("expected a corner `v/vt/vn`, found `{word}`"))),
        }
    }

    fn finish(self, warnings: &mut Vec<Warning>) -> Result<ObjText, LoadError> {
        for (kind, (index, place)) in self.furthest.iter().enumerate() {
            if *index >= self.counts[kind] && !place.is_empty() {
                let message =
                    format!("index {}, but the file has {} `{}`", index + 1, self.counts[kind], KINDS[kind]);
                return Err(LoadError::at(self.path, self.source, place.clone(), message));
            }
        }
        if self.text.runs.is_empty() {
            let only = if self.wires > 0 { "; it has only lines or points, which can't be hit" } else { "" };
            return Err(LoadError::new(self.path, format!("the file has no faces{only}")));
        }
        let mut warn = |message: String| warnings.push(Warning::new(self.path, message));
        if self.dropped > 0 {
            warn(format!("{} faces with fewer than 3 corners were dropped", self.dropped));
        }
        if self.text.normals.is_partial() {
            warn("some faces have no normals: all normals were dropped, smooth ones are computed".into());
        }
        if self.text.uvs.is_partial() {
            warn("some faces have no texture coordinates: (0, 0) stands in".into());
        }
        Ok(self.text)
    }
}
