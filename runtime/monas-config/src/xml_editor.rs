//! Edits an XML text in place: each change replaces only the bytes it concerns.
//!
//! Comments, order, whitespace and unknown elements stay as they are, because the text is never
//! regenerated from a tree.

use std::ops::Range;
use std::sync::Arc;

use yase::{Diagnostic, Source};

use super::element::{Attribute, Element};
use super::xml;

/// A text with the elements in it.
#[derive(Clone, Debug)]
pub(crate) struct XmlEditor {
    source: Arc<Source>,
    elements: Vec<Element>,
    diagnostics: Vec<Diagnostic>,
}

/// New contents of an element.
pub(crate) enum ElementContent<'a> {
    /// A text in it.
    Text(&'a str),
    /// Attributes.
    Attributes(&'a [(String, String)]),
}

impl XmlEditor {
    pub(crate) fn new(source: Arc<Source>) -> XmlEditor {
        let (elements, diagnostics) = xml::parse(&source);
        XmlEditor { source, elements, diagnostics }
    }

    pub(crate) fn source(&self) -> &Arc<Source> {
        &self.source
    }

    pub(crate) fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    pub(crate) fn roots(&self) -> &[Element] {
        &self.elements
    }

    /// Every element in the order of the text, at any depth.
    pub(crate) fn all(&self) -> Vec<&Element> {
        fn below<'a>(elements: &'a [Element], found: &mut Vec<&'a Element>) {
            for element in elements {
                found.push(element);
                below(element.children(), found);
            }
        }
        let mut found = Vec::new();
        below(&self.elements, &mut found);
        found
    }

    /// Sets the text or attributes of the element with this index in [`all`](Self::all).
    pub(crate) fn change(&mut self, index: usize, content: &ElementContent<'_>) {
        let all = self.all();
        let Some(element) = all.get(index) else { return };
        let splices = match content {
            ElementContent::Text(text) => self.text_splices(element, text),
            ElementContent::Attributes(values) => self.attribute_splices(element, values),
        };
        self.splice(splices);
    }

    /// Adds an element: inside the only root if that has children, otherwise after all roots.
    pub(crate) fn add(&mut self, name: &str, content: &ElementContent<'_>) {
        let element = written(name, content);
        let text = &self.source.text;
        let splice = match self.elements.as_slice() {
            [root] if !root.children().is_empty() => {
                let last = root.children().last().map_or(root.span().end, |last| last.span().end);
                (last..last, format!("{}{element}", self.indentation(root)))
            }
            [] if text.trim().is_empty() => (0..text.len(), format!("<?xml version=\"1.0\" ?>\n{element}\n")),
            _ => {
                let line = if text.ends_with('\n') { "" } else { "\n" };
                (text.len()..text.len(), format!("{line}{element}\n"))
            }
        };
        self.splice(vec![splice]);
    }

    /// The whitespace between the children of a root: that before the first.
    fn indentation(&self, root: &Element) -> &str {
        let first = root.children().first().map_or(0, |first| first.span().start);
        let before = &self.source.text[..first];
        &before[before.trim_end().len()..]
    }

    pub(crate) fn splice(&mut self, mut splices: Vec<(Range<usize>, String)>) {
        let mut text = self.source.text.clone();
        // From the end, so that earlier ranges stay valid.
        splices.sort_by_key(|(range, _)| std::cmp::Reverse((range.start, range.end)));
        for (range, replacement) in splices {
            text.replace_range(range, &replacement);
        }
        *self = XmlEditor::new(Source::new(self.source.name.clone(), text));
    }

    pub(crate) fn attribute_splices(
        &self,
        element: &Element,
        values: &[(String, String)],
    ) -> Vec<(Range<usize>, String)> {
        let end = element.attributes().last().map_or(element.name_span().end, |last| self.value_end(last));
        let mut new = String::new();
        let mut splices = Vec::new();
        for (key, value) in values {
            match element.attributes().iter().find(|given| given.name == *key) {
                Some(given) if given.value == *value => {}
                Some(given) => splices.push(self.value_splice(given, value)),
                None => new += &format!(" {key}=\"{}\"", attribute_text(value)),
            }
        }
        if !new.is_empty() {
            splices.push((end..end, new));
        }
        splices
    }

    /// A value keeps its quotes, or gets quotes if it has none.
    fn value_splice(&self, given: &Attribute, value: &str) -> (Range<usize>, String) {
        let value = attribute_text(value);
        match self.quote(given) {
            Some('\'') => (given.value_span.start..given.value_span.end, value.replace('\'', "&apos;")),
            Some(_) => (given.value_span.start..given.value_span.end, value),
            None => (given.value_span.start..given.value_span.end, format!("\"{value}\"")),
        }
    }

    /// The quote around a value.
    fn quote(&self, given: &Attribute) -> Option<char> {
        let quote = self.source.text[..given.value_span.start].chars().next_back()?;
        let closes = self.source.text[given.value_span.end..].starts_with(quote);
        (matches!(quote, '"' | '\'') && closes).then_some(quote)
    }

    fn value_end(&self, given: &Attribute) -> usize {
        given.value_span.end + self.quote(given).map_or(0, char::len_utf8)
    }

    fn text_splices(&self, element: &Element, text: &str) -> Vec<(Range<usize>, String)> {
        if element.text() == text {
            return Vec::new();
        }
        let escaped = element_text(text);
        let source = &self.source.text;
        let behind = element.attributes().last().map_or(element.name_span().end, |last| self.value_end(last));
        let Some(end_of_tag) = source[behind..].find('>').map(|found| behind + found + 1) else {
            return Vec::new();
        };
        if source[..end_of_tag].ends_with("/>") {
            // An empty-element tag is split into an opening and a closing tag.
            let closing = end_of_tag - 2;
            let trimmed = source[..closing].trim_end().len();
            return vec![(trimmed..end_of_tag, format!(">{escaped}</{}>", element.name()))];
        }
        let mut runs = texts(element, source, end_of_tag).into_iter();
        match runs.next() {
            Some(first) => {
                let first = (first, escaped);
                std::iter::once(first).chain(runs.map(|run| (run, String::new()))).collect()
            }
            None => vec![(end_of_tag..end_of_tag, escaped)],
        }
    }
}

/// The runs of text directly in an element that are not blank, trimmed.
fn texts(element: &Element, source: &str, start: usize) -> Vec<Range<usize>> {
    let end = source[..element.span().end].rfind("</").unwrap_or(start);
    let mut runs = Vec::new();
    let mut at = start;
    while at < end {
        let rest = &source[at..end];
        let child = element.children().iter().find(|child| child.span().start == at);
        at = match child {
            Some(child) => child.span().end,
            None if rest.starts_with("<!--") => behind(source, at, "-->"),
            None if rest.starts_with("<?") => behind(source, at, "?>"),
            None if rest.starts_with("<![CDATA[") => {
                let stop = behind(source, at, "]]>");
                runs.push(at..stop);
                stop
            }
            None => {
                let next = rest.char_indices().skip(1).find(|(_, character)| *character == '<');
                let stop = next.map_or(end, |(found, _)| at + found);
                let run = &source[at..stop];
                let blanks = run.len() - run.trim_start().len();
                if blanks < run.len() {
                    runs.push(at + blanks..at + run.trim_end().len());
                }
                stop
            }
        };
    }
    runs
}

fn behind(source: &str, at: usize, terminator: &str) -> usize {
    source[at..].find(terminator).map_or(source.len(), |found| at + found + terminator.len())
}

/// An element as new text.
fn written(name: &str, content: &ElementContent<'_>) -> String {
    match content {
        ElementContent::Text(text) => format!("<{name}>{}</{name}>", element_text(text)),
        ElementContent::Attributes(values) => {
            let values: String =
                values.iter().map(|(key, value)| format!("{key}=\"{}\" ", attribute_text(value))).collect();
            format!("<{name} {values}/>")
        }
    }
}

/// A value as written between double quotes.
pub(crate) fn attribute_text(value: &str) -> String {
    let mut escaped = String::with_capacity(value.len());
    yase_scxml::escape(value, true, &mut escaped);
    escaped
}

/// A text as written in an element.
pub(crate) fn element_text(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    yase_scxml::escape(text, false, &mut escaped);
    escaped
}
