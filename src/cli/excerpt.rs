//! The lines of a file that a message shows, cut to the terminal's width around what is meant.
//!
//! A terminal would go on with a long line in the next row, and the line that underlines it as well.

use std::fmt;

use miette::{
    Diagnostic, LabeledSpan, MietteError, MietteSpanContents, Severity, SourceCode, SourceSpan, SpanContents,
};

/// Stands where something was cut away.
const CUT: char = '…';

/// From one stop of the tabulator to the next, as reports show it.
const TAB: usize = 4;

/// Columns that a report takes before a line besides its number.
const GUTTER: usize = 4;

/// Columns between what is underlined and its label.
const ARROW: usize = 4;

/// A message whose lines are short enough.
pub(super) struct Excerpt<'a> {
    told: &'a dyn Diagnostic,
    lines: Lines,
    label: LabeledSpan,
}

/// Some lines of a file.
#[derive(Debug, PartialEq)]
struct Lines {
    name: String,
    text: String,
    /// Lines of the file before the first one.
    before: usize,
    /// Characters of the file's line before what is meant.
    column: usize,
}

impl<'a> Excerpt<'a> {
    /// `None` where nothing has to be cut: there are no lines, or they fit, or several of them are meant.
    pub(super) fn of(told: &'a dyn Diagnostic, width: usize) -> Option<Self> {
        let source = told.source_code()?;
        let label = told.labels()?.next()?;
        let shown = source.read_span(label.inner(), 1, 1).ok()?;
        let text = std::str::from_utf8(shown.data()).ok()?;
        let before = shown.line();
        let digits = (before + text.lines().count()).to_string().len();
        let room = width.saturating_sub(digits + GUTTER);
        let start = label.offset().checked_sub(shown.span().offset())?;
        let meant = Meant {
            start,
            length: label.len(),
            label: label.label().map_or(0, |label| label.chars().count()),
        };
        let (text, span, column) = cut(text, &meant, room)?;
        let lines = Lines { name: shown.name()?.to_owned(), text, before, column };
        let label = LabeledSpan::new_with_span(label.label().map(String::from), span);
        Some(Self { told, lines, label })
    }
}

/// What is underlined: bytes of a text, and the characters of what is said of it.
struct Meant {
    start: usize,
    length: usize,
    label: usize,
}

/// The lines of a text with at most `room` columns, what is meant in them, and the characters before it in its line.
fn cut(text: &str, meant: &Meant, room: usize) -> Option<(String, SourceSpan, usize)> {
    let columns = |line: &str| line.chars().count();
    let lines: Vec<String> = text.lines().map(widened).collect();
    if room < 2 * ARROW || lines.iter().all(|line| columns(line) <= room) {
        return None;
    }
    let row = text.get(..meant.start)?.matches('\n').count();
    let line_start = text[..meant.start].rfind('\n').map_or(0, |newline| newline + 1);
    let line = text[line_start..].lines().next()?;
    let before = line.get(..meant.start - line_start)?;
    let until = line.get(..meant.start + meant.length - line_start)?;
    let (first, last) = (columns(&widened(before)), columns(&widened(until)));
    let needed = last.max(usize::midpoint(first, last) + ARROW + meant.label) + 1;
    // The beginning of what is meant is always seen, behind the sign that something is cut away.
    let away = needed.saturating_sub(room).min(first.saturating_sub(1));
    let shown: Vec<String> = lines.iter().map(|line| window(line, away, room)).collect();
    let above: usize = shown[..row].iter().map(|line| line.len() + 1).sum();
    let byte = |column: usize| shown[row].chars().take(column).map(char::len_utf8).sum::<usize>();
    let (start, end) = (byte(first - away), byte(last - away));
    Some((shown.join("\n") + "\n", (above + start, end - start).into(), columns(before)))
}

/// With blanks in place of tabulators.
fn widened(line: &str) -> String {
    let mut wide = String::new();
    let mut column = 0;
    for character in line.chars() {
        let blanks = if character == '\t' { TAB - column % TAB } else { 0 };
        wide.extend(std::iter::repeat_n(' ', blanks));
        wide.extend((blanks == 0).then_some(character));
        column += blanks.max(1);
    }
    wide
}

/// `room` columns of a line, from the one after so many.
fn window(line: &str, away: usize, room: usize) -> String {
    let length = line.chars().count();
    let seen = line.chars().enumerate().skip(away).take(room);
    let shown = seen.map(|(place, character)| {
        let more = place + 1 == away + room && place + 1 < length;
        if away > 0 && place == away || more { CUT } else { character }
    });
    shown.collect()
}

impl SourceCode for Lines {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let inner = self.text.read_span(span, before, after)?;
        // Asked for without its neighbours, it is the place that is told.
        let column = if before + after == 0 { self.column } else { inner.column() };
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            inner.data(),
            *inner.span(),
            inner.line() + self.before,
            column,
            inner.line_count(),
        )))
    }
}

impl fmt::Debug for Excerpt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.told, f)
    }
}

impl fmt::Display for Excerpt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self.told, f)
    }
}

impl std::error::Error for Excerpt<'_> {}

impl Diagnostic for Excerpt<'_> {
    fn severity(&self) -> Option<Severity> {
        self.told.severity()
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.told.help()
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.lines)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(std::iter::once(self.label.clone())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lines, and what is meant in them, if anything was cut.
    fn shown(text: &str, meant: &str, label: usize, room: usize) -> Option<(String, String, usize)> {
        let start = text.find(meant).expect("it is there");
        let (text, span, column) = cut(text, &Meant { start, length: meant.len(), label }, room)?;
        let meant = text[span.offset()..span.offset() + span.len()].to_owned();
        Some((text, meant, column))
    }

    #[test]
    fn lines_that_fit_stay() {
        assert_eq!(shown("one\ntwo\n", "two", 4, 8), None);
        assert_eq!(shown("12345678\n", "5678", 40, 8), None);
    }

    #[test]
    fn what_is_meant_stays_in_sight() {
        let long = "  the beginning of a line, MEANT, and its end";
        let around = Some(("\n…a line, MEANT, and…\n\n".into(), "MEANT".into(), 27));
        assert_eq!(shown(&format!("a\n{long}\nb\n"), "MEANT", 4, 20), around);
        assert_eq!(shown(long, "the", 2, 20), Some(("  the beginning of …\n".into(), "the".into(), 2)));
        // Longer than the room: from its beginning.
        let part = Some(("…line, ME…\n".into(), "line, ME…".into(), 21));
        assert_eq!(shown(long, "line, MEANT, and", 2, 10), part);
    }

    #[test]
    fn tabulators_and_letters_of_several_bytes_take_their_columns() {
        let text = "\tä\tüüüüüüüüüü MEANT\n";
        assert_eq!(shown(text, "MEANT", 1, 12), Some(("…üü MEANT\n".into(), "MEANT".into(), 14)));
        assert_eq!(widened("\tä\tb"), "    ä   b");
    }

    #[test]
    fn what_is_meant_over_several_lines_is_left_as_it_is() {
        assert_eq!(shown("0123456789\n0123456789abcdef\n", "89\n01", 1, 12), None);
    }
}
