//! XML parsing with the position of each element and attribute.

use std::ops::Range;

use roxmltree::{Document, Node, ParsingOptions};
use yase::{Diagnostic, Span};

/// Limit of elements and attributes.
const MOST_NODES: u32 = 4_000_000;

/// Whether a text is XML, judged by its first character.
pub fn is_xml(text: &str) -> bool {
    text.trim_start_matches('\u{feff}').trim_start().starts_with('<')
}

/// Parses a text as XML, or returns the error (E0246). A document type is refused: no tool of the
/// method writes one, and its entities can ask for any amount of memory.
pub fn parse(text: &str) -> Result<Document<'_>, Diagnostic> {
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| match error {
        roxmltree::Error::DtdDetected => {
            let at = text.find("<!DOCTYPE").unwrap_or_default();
            Diagnostic::error("E0246", Span::new(at, at), "models have no document type")
                .with_hint("write what its entities stand for, and take `<!DOCTYPE` away")
        }
        error => {
            let message = format!("this is not well-formed XML: {error}");
            Diagnostic::error("E0246", span_at(text, error.pos()), message)
        }
    })
}

/// From the `<` of an element to the end of its name.
pub fn tag(node: Node<'_, '_>) -> Span {
    let text = node.document().input_text();
    let start = node.range().start;
    let name = text[start..].find([' ', '>', '/', '\n', '\t', '\r']);
    Span::new(start, start + name.unwrap_or(text.len() - start))
}

/// The character at a line and column, both from 1; the end of the text if there is none.
fn span_at(text: &str, position: roxmltree::TextPos) -> Span {
    let (row, column) = (position.row.saturating_sub(1) as usize, position.col.saturating_sub(1) as usize);
    let lines = text.split_inclusive('\n');
    let start: usize = lines.take(row).map(str::len).sum();
    match text[start..].char_indices().nth(column) {
        Some((at, letter)) => Span::new(start + at, start + at + letter.len_utf8()),
        None => Span::new(text.len(), text.len()),
    }
}

/// The text with the value of an attribute decoded, each reference padded with blanks, which
/// formulas ignore, so that all byte positions stay the same. Line breaks are blanks unless written
/// as references, as XML requires.
pub fn decoded(text: &str, value: Range<usize>) -> String {
    let mut decoded = String::from(&text[..value.start]);
    let mut rest = &text[value.clone()];
    while let Some(character) = rest.chars().next() {
        let reference = character_reference(rest);
        let (meant, length) = match reference {
            Some(reference) => reference,
            None if character.is_whitespace() => (' ', character.len_utf8()),
            None => (character, character.len_utf8()),
        };
        decoded.push(meant);
        decoded.extend(std::iter::repeat_n(' ', length - meant.len_utf8()));
        rest = &rest[length..];
    }
    decoded.push_str(&text[value.end..]);
    decoded
}

/// The character of a reference at the start of a text, and the length of the reference.
fn character_reference(text: &str) -> Option<(char, usize)> {
    let (name, _) = text.strip_prefix('&')?.split_once(';')?;
    let character = match name {
        "amp" => '&',
        "lt" => '<',
        "gt" => '>',
        "quot" => '"',
        "apos" => '\'',
        _ => char::from_u32(match name.strip_prefix("#x") {
            Some(digits) => u32::from_str_radix(digits, 16).ok()?,
            None => name.strip_prefix('#')?.parse().ok()?,
        })?,
    };
    Some((character, name.len() + 2))
}
