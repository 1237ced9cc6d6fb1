//! The guided tour, walked: every command in it runs, and prints what the tour says that it prints.
//!
//! A command that is followed by its output is run as it stands, and so are those that draw stamps. Others draw pictures,
//! and are run small; so are those of whose output only lines are told that differ from run to run.

#![allow(missing_docs)]

mod program;

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use program::{folder, stderr, stdout};

const TOUR: &str = include_str!("../docs/tour.md");

/// All pictures of the tour together, in bytes.
const PICTURES: u64 = 1_500_000;

/// A command, and the lines that it prints if they are told.
#[derive(Debug, PartialEq)]
struct Step {
    words: Vec<String>,
    printed: Option<Vec<String>>,
}

/// Words as a shell takes them apart; only quotation marks are known.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![];
    let mut word = None;
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => {
                quoted = !quoted;
                word.get_or_insert_default();
            }
            ' ' if !quoted => words.extend(word.take()),
            c => word.get_or_insert_with(String::new).push(c),
        }
    }
    words.extend(word);
    words
}

/// The commands between fences of `sh`; a fence of `text` right behind is what the last one prints.
fn steps(markdown: &str) -> Vec<Step> {
    let mut steps: Vec<Step> = vec![];
    let mut fence: Option<(&str, Vec<&str>)> = None;
    for line in markdown.lines() {
        match (&mut fence, line.strip_prefix("```")) {
            (None, Some(kind)) => fence = Some((kind, vec![])),
            (None, None) => {}
            (Some((_, lines)), None) => lines.push(line),
            (Some((kind, lines)), Some(_)) => {
                match *kind {
                    "sh" => {
                        let joined = lines.join("\n").replace("\\\n", " ");
                        let commands = joined.lines().filter_map(|line| line.strip_prefix("packlight "));
                        steps.extend(commands.map(|line| Step { words: words(line), printed: None }));
                    }
                    "text" => {
                        let step = steps.last_mut().expect("output follows a command");
                        step.printed = Some(lines.iter().map(|&line| line.to_owned()).collect());
                    }
                    _ => {}
                }
                fence = None;
            }
        }
    }
    steps
}

/// Columns of a picture that is as small as need be.
const STAMP: u32 = 64;

/// The same command over a few pixels.
fn small(words: &[String]) -> Vec<String> {
    let width = words.iter().skip_while(|&word| word != "--width").nth(1);
    if width.and_then(|width| width.parse().ok()).is_some_and(|width: u32| width <= STAMP) {
        return words.to_vec();
    }
    let size: &[&str] = match words[0].as_str() {
        "render" => &["--width", "24", "--spp", "1"],
        "brdf" if !words.contains(&"--check".into()) => &["--spp", "1"],
        _ => &[],
    };
    let replaced = |word: &str| size.contains(&word) || (!size.is_empty() && word == "--height");
    let mut small = vec![];
    let mut words = words.iter();
    while let Some(word) = words.next() {
        if replaced(word) {
            words.next();
        } else {
            small.push(word.clone());
        }
    }
    small.extend(size.iter().map(|&word| word.to_owned()));
    small
}

/// What differs from run to run, or from machine to machine.
const ANYTHING: char = '…';

/// Is the line the one that was told, with anything where that says so?
fn matches(line: &str, told: &str) -> bool {
    let mut parts = told.split(ANYTHING);
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = line.strip_prefix(first) else { return false };
    let mut parts = parts.peekable();
    let exact = parts.peek().is_none();
    while let Some(part) = parts.next() {
        rest = match (parts.peek(), rest.find(part)) {
            (None, _) if rest.ends_with(part) => "",
            (Some(_), Some(at)) => &rest[at + part.len()..],
            _ => return false,
        };
    }
    !exact || rest.is_empty()
}

/// Runs all commands in a folder.
fn walk(steps: &[Step], folder: &Path) -> Result<(), String> {
    for step in steps {
        let told = step.printed.as_deref().unwrap_or_default();
        let words = if told.iter().any(|line| !line.contains(ANYTHING)) {
            step.words.clone()
        } else {
            small(&step.words)
        };
        let output = Command::new(env!("CARGO_BIN_EXE_packlight")).args(&words).current_dir(folder).output();
        let output = output.expect("the program starts");
        let told = format!("packlight {}", step.words.join(" "));
        if !output.status.success() {
            return Err(format!("{told}: {}", stderr(&output)));
        }
        if !stderr(&output).is_empty() {
            return Err(format!("{told} warns: {}", stderr(&output)));
        }
        let printed = stdout(&output);
        let mut lines = printed.lines().map(str::trim_end);
        for expected in step.printed.iter().flatten() {
            if !lines.any(|line| matches(line, expected.trim_end())) {
                return Err(format!("{told} does not print `{expected}` there, but\n{printed}"));
            }
        }
    }
    Ok(())
}

/// A folder in which commands find what they name as they would in the project's.
fn stage(name: &str) -> PathBuf {
    let folder = folder(name);
    let project = Path::new(env!("CARGO_MANIFEST_DIR"));
    let copy = |from: &str, to: &Path| {
        fs::create_dir_all(to).expect("a folder can be made");
        for entry in fs::read_dir(project.join(from)).expect("readable") {
            let entry = entry.expect("readable");
            if entry.file_type().expect("readable").is_file() {
                fs::copy(entry.path(), to.join(entry.file_name())).expect("a file can be copied");
            }
        }
    };
    for part in ["scenes", "scenes/meshes", "scenes/textures"] {
        copy(part, &folder.join(part));
    }
    fs::create_dir_all(folder.join("docs/tour")).expect("a folder can be made");
    for scene in ["lamp.xml", "shadow.xml"] {
        let place = format!("docs/tour/{scene}");
        fs::copy(project.join(&place), folder.join(&place)).expect("a file can be copied");
    }
    folder
}

#[test]
fn every_command_of_the_tour_runs() {
    let steps = steps(TOUR);
    assert!(steps.len() > 10 && steps.iter().any(|step| step.printed.is_some()), "{}", steps.len());
    let folder = stage("tour");
    walk(&steps, &folder).unwrap_or_else(|why| panic!("{why}"));
    // What is shown was drawn by one of them.
    let mut bytes = 0;
    for picture in TOUR.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        let place = Path::new("docs").join(picture.split('#').next().unwrap_or(picture));
        let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join(&place);
        if picture.ends_with(".png") {
            assert!(folder.join(&place).exists(), "no command draws {picture}");
            bytes += fs::metadata(&kept).unwrap_or_else(|why| panic!("{picture}: {why}")).len();
        } else if !picture.starts_with("https:") {
            assert!(kept.exists(), "{picture} is not there");
        }
    }
    assert!(bytes > 0 && bytes < PICTURES, "{bytes}");
}

#[test]
fn a_command_that_is_wrong_is_found() {
    let folder = stage("tour-wrong");
    let failure = |markdown: &str| walk(&steps(markdown), &folder).expect_err(markdown);
    assert!(failure("```sh\npacklight meter docs/tour/lamp.xml --hat 0,0,0\n```\n").contains("--hat"));
    assert!(failure("```sh\npacklight info \\\n  scenes/no-such.xml\n```\n").contains("no-such.xml"));
    let wrong = "```sh\npacklight info docs/tour/lamp.xml\n```\n```text\n  shapes      2\n```\n";
    assert!(failure(wrong).contains("does not print `  shapes      2`"));
    let right = wrong.replace("      2", "      1");
    assert_eq!(walk(&steps(&right), &folder), Ok(()));
    // What is told in part has to be there too.
    let part = wrong.replace("      2", "      …");
    assert_eq!(walk(&steps(&part), &folder), Ok(()));
    assert!(failure(&part.replace("shapes", "ships")).contains("ships"));
    assert!(matches("a 1 b 2 c", "a … b … c") && matches("a", "…") && matches("ab", "ab"));
    for (line, told) in [("a 1 b 2 d", "a … b … c"), ("abc", "ab"), ("b 1", "a …"), ("a 1", "a … b …")]
    {
        assert!(!matches(line, told), "{line}: {told}");
    }
    // As small as it is told to be, whatever the tour says.
    let words: Vec<String> = words("render a.xml --spp 4096 -o \"a b.png\" --height 9");
    assert_eq!(small(&words), ["render", "a.xml", "-o", "a b.png", "--width", "24", "--spp", "1"]);
    let stamp = self::words("render a.xml --spp 4096 --width 64");
    assert_eq!(small(&stamp), stamp);
}
