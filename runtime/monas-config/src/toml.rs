//! Reads TOML into the same elements as XML, with the location of each value.
//!
//! A table is an element, an array of tables several elements of one name. A key is an attribute
//! or, if the grammar has such an element, a child with a text. The text of an element with
//! attributes has its own key:
//!
//! ```toml
//! [[agent]]
//! name = "Motion"
//! thread_frequency = 10
//! activity = ["Vision", { name = "MotionController", gait = "quick" }]
//! ```

use std::sync::Arc;

use ::toml::Spanned;
use ::toml::de::{DeTable, DeValue};
use yase::{Diagnostic, Source, Span};

use super::element::{Attribute, Element, Layer};
use super::grammar::{ElementRule, Grammar, Kind};
use super::lenient_xml::within;

/// Parses a text: its elements in order, and diagnostics.
pub(crate) fn parse(source: &Arc<Source>, grammar: &Grammar) -> (Vec<Element>, Vec<Diagnostic>) {
    let (document, errors) = DeTable::parse_recoverable(&source.text);
    let mut reader = TomlReader { source, grammar, diagnostics: Vec::new() };
    for error in errors {
        let span = error.span().unwrap_or_default();
        let message = format!("not TOML: {}", first_line(error.message()));
        let hint = "a line is `key = value`, texts are quoted: `name = \"Motion\"`";
        reader.report("E0342", span.into(), message, hint);
    }
    let mut elements = Vec::new();
    for (key, value) in in_order(document.get_ref()) {
        let location = KeyLocation { name: key.get_ref(), span: key.span().into() };
        reader.elements(location, value, &mut elements);
    }
    (elements, reader.diagnostics)
}

/// A key and its location.
#[derive(Clone, Copy)]
struct KeyLocation<'a> {
    name: &'a str,
    span: Span,
}

struct TomlReader<'a> {
    source: &'a Arc<Source>,
    grammar: &'a Grammar,
    diagnostics: Vec<Diagnostic>,
}

type TomlEntry<'a, 'i> = (&'a Spanned<::toml::de::DeString<'i>>, &'a Spanned<DeValue<'i>>);

/// The entries of a table in the order of the text.
fn in_order<'a, 'i>(table: &'a DeTable<'i>) -> Vec<TomlEntry<'a, 'i>> {
    let mut entries: Vec<TomlEntry<'a, 'i>> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries
}

impl TomlReader<'_> {
    fn report(&mut self, code: &'static str, span: Span, message: String, hint: &str) {
        let span = within(&self.source.text, span);
        let diagnostic = Diagnostic::error(code, span, message).with_hint(hint);
        self.diagnostics.push(diagnostic.in_source(self.source));
    }

    /// The elements for a key: several if its value is an array.
    fn elements(&mut self, location: KeyLocation<'_>, value: &Spanned<DeValue<'_>>, into: &mut Vec<Element>) {
        match value.get_ref() {
            DeValue::Array(values) => values.iter().for_each(|one| self.elements(location, one, into)),
            DeValue::Table(table) => {
                let element = self.table(location, table, value.span().into());
                into.push(element);
            }
            scalar => {
                let mut element = self.empty(location, value.span().into());
                element.text = text_of(scalar);
                element.text_span = self.unquoted(value.span().into());
                into.push(element);
            }
        }
    }

    fn empty(&self, location: KeyLocation<'_>, span: Span) -> Element {
        Element {
            name: location.name.to_owned(),
            name_span: location.span,
            span: location.span.to(span),
            attributes: Vec::new(),
            children: Vec::new(),
            text: String::new(),
            text_span: location.span,
            source: self.source.clone(),
            layer: Layer::File,
        }
    }

    fn table(&mut self, location: KeyLocation<'_>, table: &DeTable<'_>, span: Span) -> Element {
        let rule = self.grammar.element(location.name);
        let mut element = self.empty(location, span);
        for (key, value) in in_order(table) {
            let index = KeyLocation { name: key.get_ref(), span: key.span().into() };
            self.entry(index, value, rule, &mut element);
        }
        element
    }

    /// An entry of a table is the element's text, a child, or an attribute.
    fn entry(
        &mut self,
        location: KeyLocation<'_>,
        value: &Spanned<DeValue<'_>>,
        rule: Option<&ElementRule>,
        element: &mut Element,
    ) {
        let span: Span = value.span().into();
        if span.start == span.end {
            return; // there is no value, which has been said
        }
        let is_child = rule.is_some_and(|rule| rule.child_named(location.name).is_some());
        let is_text = rule.and_then(|rule| rule.text.as_ref()).is_some_and(|text| text.key == location.name);
        match value.get_ref() {
            _ if is_child => self.elements(location, value, &mut element.children),
            DeValue::Table(_) => self.elements(location, value, &mut element.children),
            DeValue::Array(values) => {
                let attribute = rule.and_then(|rule| rule.attribute_named(location.name));
                let texts: Option<Vec<String>> = values.iter().map(|one| word_of(one.get_ref())).collect();
                match (texts, attribute.map(|attribute| &attribute.kind)) {
                    (Some(texts), Some(Kind::List)) => {
                        element.attributes.push(self.attribute(location, texts.join(" "), span));
                    }
                    (None, None) => self.elements(location, value, &mut element.children),
                    _ => {
                        let message = format!("`{}` is an array, expected one value", location.name);
                        self.report("E0343", span, message, "keep one of them, without brackets");
                    }
                }
            }
            scalar if is_text => {
                element.text = text_of(scalar);
                element.text_span = self.unquoted(span);
            }
            scalar => {
                let attribute = self.attribute(location, text_of(scalar), self.unquoted(span));
                element.attributes.push(attribute);
            }
        }
    }

    fn attribute(&self, location: KeyLocation<'_>, value: String, value_span: Span) -> Attribute {
        Attribute {
            name: location.name.to_owned(),
            name_span: location.span,
            value,
            value_span,
            source: self.source.clone(),
            layer: Layer::File,
        }
    }

    /// The location of a text without its quotes.
    fn unquoted(&self, span: Span) -> Span {
        let text = self.source.text.get(span.start..span.end).unwrap_or_default();
        let quotes = ["\"\"\"", "'''", "\"", "'"].into_iter().find(|quotes| {
            text.len() >= 2 * quotes.len() && text.starts_with(quotes) && text.ends_with(quotes)
        });
        let length = quotes.map_or(0, str::len);
        Span::new(span.start + length, span.end - length)
    }
}

/// A value in the spelling of XML.
fn text_of(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => text.trim().to_owned(),
        DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
            Ok(number) => number.to_string(),
            Err(_) => number.as_str().to_owned(),
        },
        DeValue::Float(number) => number.as_str().to_owned(),
        DeValue::Boolean(yes) => yes.to_string(),
        DeValue::Datetime(time) => time.to_string(),
        DeValue::Array(_) | DeValue::Table(_) => String::new(),
    }
}

/// A value that is one of several words.
fn word_of(value: &DeValue<'_>) -> Option<String> {
    (!matches!(value, DeValue::Array(_) | DeValue::Table(_))).then(|| text_of(value))
}

fn first_line(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}
