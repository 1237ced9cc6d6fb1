//! XML as the reader wants it: elements, places and errors.

use std::sync::Arc;

use roxmltree::{Node as XmlNode, ParsingOptions};

use super::source::{Source, Span};
use crate::load::LoadError;

/// Most attributes of an element, and declarations of namespaces in a file. The parser compares each with all the
/// others.
const MAX_ATTRIBUTES: usize = 256;

pub(super) fn parse(source: &Source) -> Result<roxmltree::Document<'_>, LoadError> {
    if let Some(start) = crowded(&source.text) {
        let message = format!("more than {MAX_ATTRIBUTES} attributes of an element, or namespaces of a file");
        return Err(source.range_error(start..start + 1, message));
    }
    let options = ParsingOptions { allow_dtd: false, ..ParsingOptions::default() };
    roxmltree::Document::parse_with_options(&source.text, options).map_err(|e| syntax_error(source, &e))
}

/// Where the first element begins that has too many attributes, or with which there are too many namespaces. What is
/// not XML has none: the parser will say what is wrong.
fn crowded(text: &str) -> Option<usize> {
    let (mut at, mut namespaces) = (0, 0);
    loop {
        let start = at + text[at..].find('<')?;
        let rest = &text[start..];
        let passed = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")]
            .into_iter()
            .find_map(|(begin, end)| rest.starts_with(begin).then_some(end));
        let length = match passed {
            Some(end) => rest.find(end)? + end.len(),
            None => {
                let (length, values) = tag(rest)?;
                namespaces += rest[..length].matches("xmlns").count();
                if values > MAX_ATTRIBUTES || namespaces > MAX_ATTRIBUTES {
                    return Some(start);
                }
                length
            }
        };
        at = start + length;
    }
}

/// Bytes of the tag at the beginning of a text, and values in quotes that are in it.
fn tag(text: &str) -> Option<(usize, usize)> {
    let (mut quote, mut values) = (None, 0);
    for (i, byte) in text.bytes().enumerate() {
        match quote {
            Some(open) if open == byte => {
                quote = None;
                values += 1;
            }
            Some(_) => {}
            None if byte == b'>' => return Some((i + 1, values)),
            None if matches!(byte, b'"' | b'\'') => quote = Some(byte),
            None => {}
        }
    }
    None
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

#[cfg(test)]
mod tests {
    use super::*;

    fn element(attributes: usize) -> String {
        (0..attributes).fold("<a".to_owned(), |text, i| format!("{text} b{i}='>\"'")) + "/>"
    }

    #[test]
    fn crowds_are_found_where_they_stand() {
        for (text, place) in [
            (String::new(), None),
            ("<a b='".into(), None),
            ("<!-- a".into(), None),
            (element(MAX_ATTRIBUTES), None),
            (element(MAX_ATTRIBUTES + 1), Some(0)),
            // What stands in a comment is no element.
            (format!("<?xml a=''?> <!-- ' {} --> <a>", element(MAX_ATTRIBUTES + 1)), None),
            (format!("<a><!-- ' --><![CDATA[<']]>{}</a>", element(MAX_ATTRIBUTES + 1)), Some(27)),
            ("<a xmlns:b='c'>".repeat(MAX_ATTRIBUTES), None),
            ("<a xmlns:b='c'>".repeat(MAX_ATTRIBUTES + 1), Some(15 * MAX_ATTRIBUTES)),
        ] {
            assert_eq!(crowded(&text), place, "{}", &text[..text.len().min(80)]);
        }
    }
}
