//! stdout: what was asked for, and nothing else.

use std::io::{self, ErrorKind, Write, stdout};

use serde::Serialize;
use terminal_size::{Width, terminal_size_of};
use textwrap::{Options, WordSeparator, WordSplitter, WrapAlgorithm};

use super::failure::Failure;

/// Blanks between columns, and before what is left of a line that has none.
const INDENT: usize = 2;

/// Columns of the terminal that stdout is, if it is one.
pub(super) fn columns() -> Option<usize> {
    terminal_size_of(stdout()).map(|(Width(columns), _)| columns.into())
}

/// Writes to stdout, on a terminal [`folded`] to its width; elsewhere a line stays a line, to be searched for.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    match columns() {
        Some(columns) => print_as_it_is(&folded(text, columns)),
        None => print_as_it_is(text),
    }
}

/// Writes to stdout what somebody may want to copy from the screen. A reader that has had enough
/// (`packlight info … | head -1`) is not a failure.
pub(super) fn print_as_it_is(text: &str) -> Result<(), Failure> {
    let mut out = stdout().lock();
    forgive(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Lines broken at blanks; what is left of one goes on below its last column, if that is in the left half. A word is
/// never broken, and a colour takes no room.
pub(super) fn folded(text: &str, width: usize) -> String {
    let fold = |line: &str| {
        let indent = " ".repeat(column(line, width / 2));
        let options = Options::new(width)
            .subsequent_indent(&indent)
            .break_words(false)
            .word_separator(WordSeparator::AsciiSpace)
            .word_splitter(WordSplitter::NoHyphenation)
            .wrap_algorithm(WrapAlgorithm::FirstFit);
        textwrap::fill(line, &options) + "\n"
    };
    text.lines().map(fold).collect()
}

/// Where the last column of a line begins that does not begin behind `most`. Columns are two blanks apart.
fn column(line: &str, most: usize) -> usize {
    let mut blanks = 0;
    let mut last = INDENT;
    for (place, character) in line.chars().take(most + 1).enumerate() {
        if character != ' ' && blanks >= INDENT {
            last = place;
        }
        blanks = if character == ' ' { blanks + 1 } else { 0 };
    }
    last
}

/// One JSON object and a newline.
pub(super) fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::Sentence(format!("can't write JSON: {error}")))?;
    print_as_it_is(&(json + "\n"))
}

/// One JSON object on a line of its own.
pub(super) fn print_json_line(value: &impl Serialize) -> Result<(), Failure> {
    let json = serde_json::to_string(value)
        .map_err(|error| Failure::Sentence(format!("can't write JSON: {error}")))?;
    print_as_it_is(&(json + "\n"))
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
        let text = "  a   two, three, four\n  short\n";
        assert_eq!(folded(text, 80), text);
        assert_eq!(folded(text, 16), "  a   two,\n      three,\n      four\n  short\n");
        assert_eq!(folded("abcdefgh ij\n", 4), "abcdefgh\n  ij\n");
        assert_eq!(
            folded("  name      a well-known word   and\n", 24),
            "  name      a well-known\n            word   and\n"
        );
        assert_eq!(folded("      below it all\n", 14), "      below it\n      all\n");
        assert_eq!(folded("  a  yes  one two three\n", 20), "  a  yes  one two\n          three\n");
        assert_eq!(folded("\na ± b × c\n", 9), "\na ± b × c\n");
    }

    #[test]
    fn only_a_broken_pipe_is_forgiven() {
        assert!(forgive(Ok(())).is_ok());
        assert!(forgive(Err(ErrorKind::BrokenPipe.into())).is_ok());
        assert!(forgive(Err(ErrorKind::StorageFull.into())).is_err());
    }
}
