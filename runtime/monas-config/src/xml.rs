//! Lenient XML: elements with their locations.
//!
//! [`parse`] never fails. It accepts the XML of the thesis (values without quotes, several roots)
//! and returns the elements together with diagnostics. Every [`Element`] and [`Attribute`] has its
//! location in the file.
//!
//! ```
//! use monas_config::xml;
//! use yase::Source;
//!
//! let (elements, diagnostics) = xml::parse(&Source::new("agents.xml", "<agent Priority=1><name>Motion</nam></agent>"));
//! assert_eq!(elements[0].attribute("priority").map(|priority| &*priority.value), Some("1"));
//! assert_eq!(
//!     diagnostics[0].to_string(),
//!     "agents.xml:1:33: error[E0301]: `</nam>` closes nothing (did you mean `name`?)"
//! );
//! ```

use std::sync::Arc;

use yase::{Diagnostic, Source, Span};

use super::element::{Attribute, Element, Layer};
use super::lenient_xml::{RepairedXml, repair, within};

/// Parses a text: its elements in order, and diagnostics.
pub fn parse(source: &Arc<Source>) -> (Vec<Element>, Vec<Diagnostic>) {
    let mut repaired = repair(&source.text);
    let mut diagnostics = std::mem::take(&mut repaired.diagnostics);
    let elements = match roxmltree::Document::parse(&repaired.text) {
        Ok(document) => children(document.root_element(), &repaired, source),
        Err(error) => {
            diagnostics.push(not_xml(&error, &repaired, source));
            Vec::new()
        }
    };
    (elements, diagnostics.into_iter().map(|diagnostic| diagnostic.in_source(source)).collect())
}

/// Parses a text that other programs write, by the rules of XML: with namespaces, one root, and no
/// repairs.
///
/// # Errors
/// It is not XML, or more than [`MAX_DEPTH`] elements are in one another.
pub(crate) fn parse_strict(source: &Arc<Source>) -> Result<Element, Diagnostic> {
    let text = RepairedXml::unchanged(&source.text);
    let document = roxmltree::Document::parse(&source.text)
        .map_err(|error| not_xml(&error, &text, source).in_source(source))?;
    match document.descendants().find(|node| node.ancestors().take(MAX_DEPTH + 1).count() > MAX_DEPTH) {
        Some(deep) => {
            let message = format!("more than {MAX_DEPTH} elements are in one another");
            let span = within(&source.text, (deep.range().start..deep.range().start + 1).into());
            Err(Diagnostic::error("E0301", span, message).in_source(source))
        }
        None => Ok(element(document.root_element(), &text, source)),
    }
}

/// The greatest depth of elements in [`parse_strict`].
const MAX_DEPTH: usize = 64;

fn not_xml(error: &roxmltree::Error, repaired: &RepairedXml, source: &Arc<Source>) -> Diagnostic {
    let at = repaired.original(byte_of(&repaired.text, error.pos()));
    let span = within(&source.text, (at..at + 1).into());
    Diagnostic::error("E0301", span, format!("not XML: {}", without_position(error)))
}

/// The message without its position, which refers to the repaired text.
fn without_position(error: &roxmltree::Error) -> String {
    let text = error.to_string();
    match text.rsplit_once(" at ") {
        Some((what, _)) => what.to_owned(),
        None => text,
    }
}

fn byte_of(text: &str, position: roxmltree::TextPos) -> usize {
    let before: usize = text.split_inclusive('\n').take(position.row as usize - 1).map(str::len).sum();
    let line = text[before..].chars().take((position.col as usize).saturating_sub(1));
    before + line.map(char::len_utf8).sum::<usize>()
}

fn children(node: roxmltree::Node<'_, '_>, repaired: &RepairedXml, source: &Arc<Source>) -> Vec<Element> {
    node.children().filter(|child| child.is_element()).map(|child| element(child, repaired, source)).collect()
}

fn element(node: roxmltree::Node<'_, '_>, repaired: &RepairedXml, source: &Arc<Source>) -> Element {
    let range = node.range();
    let name = node.tag_name().name().to_owned();
    let name_start = range.start + 1;
    let name_span = repaired.original_span(name_start, name_start + name.len());
    let texts: Vec<_> = node.children().filter(|child| child.is_text()).collect();
    let text: String = texts.iter().filter_map(|text| text.text()).collect();
    let spoken = texts.iter().find(|text| text.text().is_some_and(|text| !text.trim().is_empty()));
    Element {
        name_span,
        span: repaired.original_span(range.start, range.end),
        attributes: node.attributes().map(|given| attribute(&given, repaired, source)).collect(),
        children: children(node, repaired, source),
        text: text.trim().to_owned(),
        text_span: spoken.map_or(name_span, |text| trimmed_span(text.range(), repaired)),
        source: source.clone(),
        layer: Layer::File,
        name,
    }
}

fn attribute(
    given: &roxmltree::Attribute<'_, '_>,
    repaired: &RepairedXml,
    source: &Arc<Source>,
) -> Attribute {
    let (name, value) = (given.range_qname(), given.range_value());
    let value_span = repaired.original_span(value.start, value.end);
    Attribute {
        name: given.name().to_owned(),
        name_span: repaired.original_span(name.start, name.end),
        value: given.value().to_owned(),
        value_span,
        source: source.clone(),
        layer: Layer::File,
    }
}

fn trimmed_span(range: std::ops::Range<usize>, repaired: &RepairedXml) -> Span {
    let text = &repaired.text[range.clone()];
    let start = range.start + (text.len() - text.trim_start().len());
    repaired.original_span(start, start + text.trim().len())
}
