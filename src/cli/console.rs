//! stdout: what was asked for, and nothing else.

use std::io::{self, ErrorKind, Write, stdout};

use serde::Serialize;
use terminal_size::{Width, terminal_size_of};
use textwrap::{Options, WordSeparator, WordSplitter, WrapAlgorithm};

use super::failure::Failure;

/// Writes to stdout. A reader that has had enough (`packlight info … | head -1`) is not a failure.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut out = stdout().lock();
    forgive(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Writes to stdout, on a terminal with lines no longer than it is wide: what is left of one goes on below the
/// column `indent`. Elsewhere a line stays a line, to be searched for.
pub(super) fn print_folded(text: &str, indent: usize) -> Result<(), Failure> {
    match terminal_size_of(stdout()) {
        Some((Width(columns), _)) => print(&folded(text, indent, columns.into())),
        None => print(text),
    }
}

/// Lines broken at blanks. A word is never broken, and a colour takes no room.
pub(super) fn folded(text: &str, indent: usize, width: usize) -> String {
    let indent = " ".repeat(indent);
    let options = Options::new(width)
        .subsequent_indent(&indent)
        .break_words(false)
        .word_separator(WordSeparator::AsciiSpace)
        .word_splitter(WordSplitter::NoHyphenation)
        .wrap_algorithm(WrapAlgorithm::FirstFit);
    text.lines().map(|line| textwrap::fill(line, &options) + "\n").collect()
}

/// One JSON object and a newline.
pub(super) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::Sentence(format!("can't write JSON: {error}")))?;
    print(&(json + "\n"))
}

/// One JSON object on a line of its own.
pub(super) fn print_json_line(value: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_string(value)
        .map_err(|error| Failure::Sentence(format!("can't write JSON: {error}")))?;
    print(&(json + "\n"))
}

fn forgive(result: io::Result<()>) -> Result<(), Failure> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Sentence(format!("can't write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_goes_on_below_its_column() {
        let text = "  one two, three, four\n  short\n";
        assert_eq!(folded(text, 6, 80), text);
        assert_eq!(folded(text, 6, 16), "  one two,\n      three,\n      four\n  short\n");
        assert_eq!(folded("abcdefgh ij\n", 2, 4), "abcdefgh\n  ij\n");
        assert_eq!(
            folded("  name      a well-known word   and\n", 12, 24),
            "  name      a well-known\n            word   and\n"
        );
        assert_eq!(folded("\na ± b × c\n", 2, 9), "\na ± b × c\n");
    }

    #[test]
    fn only_a_broken_pipe_is_forgiven() {
        assert!(forgive(Ok(())).is_ok());
        assert!(forgive(Err(ErrorKind::BrokenPipe.into())).is_ok());
        assert!(forgive(Err(ErrorKind::StorageFull.into())).is_err());
    }
}
