//! XML as the reader wants it: elements, places and errors.

use std::sync::Arc;

use roxmltree::{Node as XmlNode, ParsingOptions};

use super::source::{Source, Span};
use crate::load::LoadError;

pub(super) fn parse(source: &Source) -> Result<roxmltree::Document<'_>, LoadError> {
    let options = ParsingOptions { allow_dtd: false, ..ParsingOptions::default() };
    roxmltree::Document::parse_with_options(&source.text, options).map_err(|e| syntax_error(source, &e))
}

fn syntax_error(source: &Source, error: &roxmltree::Error) -> LoadError {
    let text = &source.text;
    if matches!(error, roxmltree::Error::DtdDetected) {
        let start = text.find("<!DOCTYPE").unwrap_or(0);
        return source
            .range_error(start..start + "<!DOCTYPE".len(), "document type declarations are not read")
            .help("remove `<!DOCTYPE …>`; `<default>` and `<include>` do what entities do");
    }
    let position = error.pos();
    let message = error.to_string().replace(&format!(" at {position}"), "");
    let at_end = matches!(
        error,
        roxmltree::Error::UnexpectedEndOfStream
            | roxmltree::Error::UnclosedRootNode
            | roxmltree::Error::NoRootNode
    );
    let start = match at_end {
        true => text.trim_end().len(),
        false => byte_of(text, position.row, position.col),
    };
    source.range_error(start..start + 1, format!("this is not XML: {message}"))
}

/// The byte at a row and a column, counted from 1 in characters.
fn byte_of(text: &str, row: u32, column: u32) -> usize {
    let line_start: usize = text.split_inclusive('\n').take(row as usize - 1).map(str::len).sum();
    let line = &text[line_start..];
    line_start + line.char_indices().nth(column as usize - 1).map_or(line.len(), |(byte, _)| byte)
}

/// Of the element's name.
pub(super) fn tag_span(source: &Arc<Source>, xml: XmlNode) -> Span {
    let start = xml.range().start + '<'.len_utf8();
    source.span(start..start + xml.tag_name().name().len())
}

/// The child elements; text between them is an error, comments are not.
pub(super) fn elements<'a, 'i>(
    source: &Arc<Source>,
    parent: XmlNode<'a, 'i>,
) -> Result<Vec<XmlNode<'a, 'i>>, LoadError> {
    let stray = |child: &XmlNode| child.is_text() && child.text().is_some_and(|t| !t.trim().is_empty());
    if let Some(text) = parent.children().find(stray) {
        let range = text.range();
        let written = &source.text[range.clone()];
        let start = range.start + written.len() - written.trim_start().len();
        return Err(source
            .span(start..start + written.trim().len())
            .error("text between elements has no meaning")
            .help("values stand in attributes; remarks stand in <!-- comments -->"));
    }
    Ok(parent.children().filter(XmlNode::is_element).collect())
}

/// Refuses elements inside one that takes none.
pub(super) fn no_children(source: &Arc<Source>, xml: XmlNode) -> Result<(), LoadError> {
    match elements(source, xml)?.first() {
        None => Ok(()),
        Some(&child) => Err(tag_span(source, child).error(format!(
            "`{}` can't stand inside `{}`",
            child.tag_name().name(),
            xml.tag_name().name()
        ))),
    }
}
