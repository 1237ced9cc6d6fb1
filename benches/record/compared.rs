//! What `peers compare` prints, read back.

/// The comparison on one mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Compared {
    pub(crate) triangles: u64,
    pub(crate) classes: Vec<Class>,
    pub(crate) builds: Vec<Build>,
}

/// A class of rays: rates in millions a second.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Class {
    pub(crate) name: String,
    pub(crate) ours: f64,
    pub(crate) theirs: f64,
    /// Embree's fastest build and mode.
    pub(crate) mode: String,
    pub(crate) agrees: bool,
}

/// A tree: `ours`, or one of Embree's.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Build {
    pub(crate) name: String,
    pub(crate) seconds: f64,
    pub(crate) bytes_per_triangle: f64,
}

impl Compared {
    /// Reads all of stdout.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        let mut found = Self::default();
        for line in text.lines() {
            let understood = if let Some(rest) = line.strip_prefix("Embree: ") {
                triangles(rest).map(|triangles| found.triangles = triangles)
            } else if let Some(rest) = line.strip_prefix("built: ") {
                build(rest).map(|build| found.builds.push(build))
            } else if line.starts_with("class ") || line.trim().is_empty() {
                Some(())
            } else {
                class(line).map(|class| found.classes.push(class))
            };
            understood.ok_or_else(|| format!("peers compare said what the record can't read: {line}"))?;
        }
        if found.triangles == 0 || found.classes.is_empty() || found.builds.is_empty() {
            return Err(format!("peers compare did not say everything:\n{text}"));
        }
        Ok(found)
    }

    /// A tree by its name.
    pub(crate) fn build(&self, name: &str) -> Option<&Build> {
        self.builds.iter().find(|build| build.name == name)
    }
}

/// `AVX512; 100000 triangles, 1 thread(s)`.
fn triangles(text: &str) -> Option<u64> {
    text.split(';').nth(1)?.split_whitespace().next()?.parse().ok()
}

/// `embree/medium 0.060 s, 66.8 bytes/tri`.
fn build(text: &str) -> Option<Build> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let &[name, seconds, "s,", bytes, "bytes/tri"] = words.as_slice() else {
        return None;
    };
    Some(Build {
        name: name.to_owned(),
        seconds: seconds.parse().ok()?,
        bytes_per_triangle: bytes.parse().ok()?,
    })
}

/// `ao 2.828 4.376 0.646 high 8-inc 3.300 0.857 0.0e0 0.0e0 agrees`; the mode is some words.
fn class(text: &str) -> Option<Class> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let [name, ours, theirs, _, mode @ .., _, _, _, _, result] = words.as_slice() else {
        return None;
    };
    let agrees = match *result {
        "agrees" => true,
        "DISAGREES" => false,
        _ => return None,
    };
    let (ours, theirs) = (ours.parse().ok()?, theirs.parse().ok()?);
    Some(Class { name: (*name).to_owned(), ours, theirs, mode: mode.join(" "), agrees })
}
