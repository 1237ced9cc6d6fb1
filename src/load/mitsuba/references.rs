//! What objects refer to, before anything is built of it: no circles, no towers, no multitudes.
//!
//! Builders follow references, and build what is referred to each time anew. So an object that contains itself
//! would never be finished, and thirty blends, each of the one before with itself, would be 2³⁰ materials.

use super::{
    document::{Document, Value},
    vocabulary::Class,
};
use crate::load::LoadError;

/// Deepest nesting of objects, those that are referred to included.
const MAX_DEPTH: usize = 64;
/// Most objects that a bsdf consists of; one that it refers to twice counts twice.
const MAX_PARTS: usize = 1024;

/// How far an object reaches.
#[derive(Clone, Copy, Debug)]
struct Extent {
    /// Objects below each other, itself included.
    depth: usize,
    /// Objects in it, itself included.
    parts: usize,
}

/// Where the walk is with an object.
#[derive(Clone, Copy, Debug)]
enum State {
    New,
    /// It is being walked, and so is all that contains it.
    Open,
    Known(Extent),
}

/// Checks a document whose references have been resolved.
///
/// # Errors
/// Where an object contains itself, or is too deep or too large.
// With a stack of its own: what it refuses is what would overflow the other one.
pub(super) fn check(document: &Document) -> Result<(), LoadError> {
    let mut states = vec![State::New; document.nodes.len()];
    let mut walk = vec![(document.root, 0)];
    while let Some((index, place)) = walk.last_mut() {
        let node = &document.nodes[*index];
        if let Some(entry) = node.entries.get(*place) {
            *place += 1;
            let Value::Object(next) = entry.value else { continue };
            match states[next] {
                State::New => {
                    states[next] = State::Open;
                    walk.push((next, 0));
                }
                State::Open => {
                    let error = entry.span.error("an object can't contain itself");
                    return Err(error.label("this leads back to where it stands"));
                }
                State::Known(_) => {}
            }
            continue;
        }
        let mut extent = Extent { depth: 1, parts: 1 };
        for entry in &node.entries {
            if let Value::Object(nested) = entry.value
                && let State::Known(nested) = states[nested]
            {
                extent.depth = extent.depth.max(1 + nested.depth);
                extent.parts = extent.parts.saturating_add(nested.parts);
            }
        }
        if extent.depth > MAX_DEPTH {
            return Err(node.tag.error(format!("objects refer to each other more than {MAX_DEPTH} deep")));
        }
        if node.class == Class::Bsdf && extent.parts > MAX_PARTS {
            return Err(node
                .tag
                .error(format!("this bsdf consists of more than {MAX_PARTS} objects"))
                .help("what it refers to several times counts several times"));
        }
        states[*index] = State::Known(extent);
        walk.pop();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use crate::load::{LoadOptions, load};

    fn refusal(objects: &str) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.xml");
        let text = format!("<scene version=\"3.0.0\">\n<sensor type=\"perspective\"/>\n{objects}</scene>\n");
        fs::write(&path, text).unwrap();
        let error = load(&path, &LoadOptions::default()).err()?.to_string();
        Some(error.rsplit_once("a.xml").map_or(error.clone(), |(_, end)| end.to_owned()))
    }

    /// `a0`, and wrappers each around the one before.
    fn tower(wrappers: usize, wrapper: impl Fn(usize) -> String) -> String {
        let mut objects = "<bsdf type=\"diffuse\" id=\"a0\"/>\n".to_owned();
        for i in 1..=wrappers {
            objects += &wrapper(i);
        }
        objects + &format!("<shape type=\"sphere\"><ref id=\"a{wrappers}\"/></shape>\n")
    }

    fn masks(count: usize) -> String {
        tower(count, |i| format!("<bsdf type=\"mask\" id=\"a{i}\"><ref id=\"a{}\"/></bsdf>\n", i - 1))
    }

    fn blends(count: usize) -> String {
        tower(count, |i| {
            let below = i - 1;
            format!(
                "<bsdf type=\"blendbsdf\" id=\"a{i}\"><float name=\"weight\" value=\".5\"/>\
                 <ref id=\"a{below}\"/><ref id=\"a{below}\"/></bsdf>\n"
            )
        })
    }

    #[test]
    fn circles_are_refused() {
        for (objects, place) in [
            ("<bsdf type=\"mask\" id=\"a\"><ref id=\"a\"/></bsdf>\n", ":3:"),
            (
                "<bsdf type=\"mask\" id=\"a\"><ref id=\"b\"/></bsdf>\n\
                 <bsdf type=\"mask\" id=\"b\"><ref id=\"a\"/></bsdf>\n",
                ":4:",
            ),
        ] {
            let refusal = refusal(objects).expect("refused");
            assert!(refusal.starts_with(place) && refusal.contains("contain itself"), "{refusal}");
        }
    }

    #[test]
    fn towers_and_multitudes_are_refused() {
        assert_eq!(refusal(&masks(50)), None);
        assert!(refusal(&masks(100)).expect("refused").contains("more than 64 deep"));
        assert!(refusal(&masks(100_000)).expect("refused").contains("more than 64 deep"));
        assert_eq!(refusal(&blends(8)), None);
        assert!(refusal(&blends(30)).expect("refused").contains("more than 1024 objects"));
    }
}
