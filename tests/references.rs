//! Every paper that the source cites is in REFERENCES.md, and every paper there is cited.

#![allow(missing_docs)]

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

/// Keys with the first place they were found at.
type Keys = BTreeMap<String, String>;

/// `[MT97]`, `[Whi80]`, `[DBC17b]`: a capital, letters, two digits, perhaps a letter.
fn keys(text: &str) -> impl Iterator<Item = &str> {
    text.match_indices('[').filter_map(|(start, _)| {
        let inside = &text[start + 1..];
        // Documentation escapes brackets, so that a key is not taken for a link.
        let key = inside[..inside.find(']')?].trim_end_matches('\\');
        is_key(key).then_some(key)
    })
}

fn is_key(key: &str) -> bool {
    let digits = key.trim_end_matches(|c: char| c.is_ascii_lowercase());
    let letters = digits.trim_end_matches(|c: char| c.is_ascii_digit());
    key.len() - digits.len() <= 1
        && digits.len() - letters.len() == 2
        && letters.starts_with(|c: char| c.is_ascii_uppercase())
        && letters.chars().all(|c| c.is_ascii_alphabetic())
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("src can be read") {
        let path = entry.expect("src can be read").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

fn cited() -> Keys {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    sources(&root.join("src"), &mut files);
    files.sort();
    let mut cited = Keys::new();
    for file in files {
        let text = fs::read_to_string(&file).expect("a source can be read");
        let place = file.strip_prefix(root).unwrap_or(&file).display().to_string();
        // Papers are cited in comments; in code, brackets hold types.
        let comments: Vec<&str> = text.lines().filter(|line| line.trim_start().starts_with("//")).collect();
        for key in keys(&comments.join("\n")) {
            cited.entry(key.to_owned()).or_insert_with(|| place.clone());
        }
    }
    cited
}

fn listed() -> Keys {
    let text = include_str!("../REFERENCES.md");
    keys(text).map(|key| (key.to_owned(), "REFERENCES.md".to_owned())).collect()
}

/// Keys of one that are not in the other, with their places.
fn only_in(one: &Keys, other: &Keys) -> Vec<String> {
    let missing = one.iter().filter(|(key, _)| !other.contains_key(*key));
    missing.map(|(key, place)| format!("[{key}] ({place})")).collect()
}

#[test]
fn what_is_cited_is_listed() {
    let missing = only_in(&cited(), &listed());
    assert!(missing.is_empty(), "cited, but not in REFERENCES.md: {}", missing.join(", "));
}

#[test]
fn what_is_listed_is_cited() {
    let idle = only_in(&listed(), &cited());
    assert!(idle.is_empty(), "in REFERENCES.md, but cited nowhere in src: {}", idle.join(", "));
}

#[test]
fn keys_are_told_from_other_brackets() {
    let text =
        "[MT97] [Whi80], [DBC17b]; [0] [f32; 8] [mt97] [MT1997] [MT9] [PJH23](url) a[i] [97] [M-T97] [A97bc]";
    assert_eq!(keys(text).collect::<Vec<_>>(), ["MT97", "Whi80", "DBC17b", "PJH23"]);
}
