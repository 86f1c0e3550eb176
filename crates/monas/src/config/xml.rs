//! XML as people write it: elements with their places, and attributes read with diagnostics.
//!
//! [`parse`] never fails. It accepts what the thesis writes (values without quotes, several roots) and returns what it
//! understood beside what it has to say. Every [`Element`] and [`Attribute`] knows its place in the file. [`Attributes`]
//! reads the attributes of one element by key: a key is written in snake case in code (`thread_frequency`), and a file
//! may write it so or as the thesis does (`ThreadFrequency`). Keys that nobody asked for are reported with the nearest one
//! that somebody did.
//!
//! ```
//! use monas::config::xml::{self, Attributes};
//! use yase::Source;
//!
//! let source = Source::new("field.xml", "<field length=6 widht=4/>");
//! let (elements, mut diagnostics) = xml::parse(&source);
//! let mut attributes = Attributes::new(&elements[0], &mut diagnostics);
//! assert_eq!(attributes.number("length"), Some(6.0));
//! assert_eq!(attributes.number("width"), None);
//! attributes.finish();
//! assert_eq!(
//!     diagnostics[0].to_string(),
//!     "field.xml:1:17: error[E0304]: unknown attribute `widht` of `field` (did you mean `width`?)"
//! );
//! ```

use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

use yase::{Diagnostic, Source, Span};

use super::repair::{Repaired, repair, within};

/// An element with what stands in it. Comments are not kept.
#[derive(Clone, Debug)]
pub struct Element {
    name: String,
    name_span: Span,
    span: Span,
    attributes: Vec<Attribute>,
    children: Vec<Element>,
    text: String,
    text_span: Span,
    source: Arc<Source>,
}

/// An attribute of an element.
#[derive(Clone, Debug)]
pub struct Attribute {
    /// Its name as written.
    pub name: String,
    /// Where its name stands.
    pub name_span: Span,
    /// Its value, entities replaced.
    pub value: String,
    /// Where its value stands, without quotes.
    pub value_span: Span,
}

/// Reads a text: its elements in order, and what is wrong with it.
pub fn parse(source: &Arc<Source>) -> (Vec<Element>, Vec<Diagnostic>) {
    let mut repaired = repair(&source.text);
    let mut diagnostics = std::mem::take(&mut repaired.diagnostics);
    let elements = match roxmltree::Document::parse(&repaired.text) {
        Ok(document) => children(document.root_element(), &repaired, source),
        Err(error) => {
            let at = repaired.original(byte_of(&repaired.text, error.pos()));
            let span = within(&source.text, (at..at + 1).into());
            diagnostics.push(Diagnostic::error(
                "E0301",
                span,
                format!("not XML: {}", without_position(&error)),
            ));
            Vec::new()
        }
    };
    (elements, diagnostics.into_iter().map(|diagnostic| diagnostic.in_source(source)).collect())
}

/// What is wrong; where it is in the repaired text means nothing to whoever wrote the original.
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

fn children(node: roxmltree::Node<'_, '_>, repaired: &Repaired, source: &Arc<Source>) -> Vec<Element> {
    node.children().filter(|child| child.is_element()).map(|child| element(child, repaired, source)).collect()
}

fn element(node: roxmltree::Node<'_, '_>, repaired: &Repaired, source: &Arc<Source>) -> Element {
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
        attributes: node.attributes().map(|given| attribute(&given, repaired)).collect(),
        children: children(node, repaired, source),
        text: text.trim().to_owned(),
        text_span: spoken.map_or(name_span, |text| trimmed_span(text.range(), repaired)),
        source: source.clone(),
        name,
    }
}

fn attribute(given: &roxmltree::Attribute<'_, '_>, repaired: &Repaired) -> Attribute {
    let (name, value) = (given.range_qname(), given.range_value());
    let value_span = repaired.original_span(value.start, value.end);
    Attribute {
        name: given.name().to_owned(),
        name_span: repaired.original_span(name.start, name.end),
        value: given.value().to_owned(),
        value_span,
    }
}

fn trimmed_span(range: std::ops::Range<usize>, repaired: &Repaired) -> Span {
    let text = &repaired.text[range.clone()];
    let start = range.start + (text.len() - text.trim_start().len());
    repaired.original_span(start, start + text.trim().len())
}

impl Element {
    /// Its name as written.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where its name stands.
    pub fn name_span(&self) -> Span {
        self.name_span
    }

    /// Where it stands, from the beginning of its opening tag to the end of its closing one.
    pub fn span(&self) -> Span {
        self.span
    }

    /// The text directly in it, blanks around it removed.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Where that text stands; its name's place if there is none.
    pub fn text_span(&self) -> Span {
        self.text_span
    }

    /// The text it stands in.
    pub fn source(&self) -> &Arc<Source> {
        &self.source
    }

    /// Its attributes in the order of the file.
    pub fn attributes(&self) -> &[Attribute] {
        &self.attributes
    }

    /// Its elements in the order of the file.
    pub fn children(&self) -> &[Element] {
        &self.children
    }

    /// Whether its name is `name`, in snake case or as the thesis writes names.
    pub fn is(&self, name: &str) -> bool {
        is_written(&self.name, name)
    }

    /// Its elements of one name.
    pub fn children_named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.is(name))
    }

    /// The element of that name; a second one is reported, and none as well.
    pub fn only_child(&self, name: &str, diagnostics: &mut Vec<Diagnostic>) -> Option<&Element> {
        let mut found = self.children.iter().filter(|child| child.is(name));
        let first = found.next();
        if first.is_none() {
            let message = format!("`{}` has no `<{name}>`", self.name);
            diagnostics.push(self.error("E0305", self.name_span, message));
        }
        for second in found {
            let message = format!("`{}` has a second `<{name}>`", self.name);
            diagnostics.push(self.error("E0307", second.name_span, message));
        }
        first
    }

    /// Reports each child whose name is none of these.
    pub fn expect_children(&self, names: &[&str], diagnostics: &mut Vec<Diagnostic>) {
        for child in self.children.iter().filter(|child| !names.iter().any(|name| child.is(name))) {
            diagnostics.push(child.unknown(names));
        }
    }

    /// That an element of this name has no meaning where it stands; these have.
    pub fn unknown(&self, names: &[&str]) -> Diagnostic {
        let diagnostic = self.error("E0303", self.name_span, format!("unknown element `{}`", self.name));
        let diagnostic = diagnostic.with_nearest(&self.name, names.iter().copied());
        match diagnostic.hint {
            Some(_) => diagnostic,
            None => diagnostic.with_hint(format!("expected {}", listed(names))),
        }
    }

    /// An error about a place in this element's text.
    pub fn error(&self, code: &'static str, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, span, message).in_source(&self.source)
    }
}

/// Reads the attributes of an element by key, and reports what is missing, malformed or unknown.
#[derive(Debug)]
pub struct Attributes<'a> {
    element: &'a Element,
    asked: Vec<&'static str>,
    diagnostics: &'a mut Vec<Diagnostic>,
}

impl<'a> Attributes<'a> {
    /// Begins to read; what is wrong is added to `diagnostics`.
    pub fn new(element: &'a Element, diagnostics: &'a mut Vec<Diagnostic>) -> Attributes<'a> {
        Attributes { element, asked: Vec::new(), diagnostics }
    }

    /// The attribute of that key, if it is given.
    pub fn get(&mut self, key: &'static str) -> Option<&'a Attribute> {
        self.asked.push(key);
        self.element.attributes.iter().find(|attribute| is_written(&attribute.name, key))
    }

    /// Its text.
    pub fn text(&mut self, key: &'static str) -> Option<&'a str> {
        self.get(key).map(|attribute| attribute.value.as_str())
    }

    /// Its text, and a diagnostic if there is none.
    pub fn required(&mut self, key: &'static str) -> Option<&'a str> {
        let found = self.text(key);
        if found.is_none() {
            let message = format!("`{}` has no attribute `{key}`", self.element.name);
            let nearest = self.near_misses(key);
            let diagnostic = self.element.error("E0305", self.element.name_span, message);
            self.diagnostics.push(match nearest {
                Some(wrong) => diagnostic.with_hint(format!("is `{wrong}` meant to be `{key}`?")),
                None => diagnostic,
            });
        }
        found
    }

    fn near_misses(&self, key: &'static str) -> Option<&'a str> {
        yase::diagnostic::nearest(
            key,
            self.element.attributes.iter().map(|attribute| attribute.name.as_str()),
        )
    }

    /// A finite number.
    pub fn number(&mut self, key: &'static str) -> Option<f64> {
        self.read(key, "a number", |text| f64::from_str(text).ok().filter(|number| number.is_finite()))
    }

    /// A finite number of at least `least`.
    pub fn number_from(&mut self, key: &'static str, least: f64) -> Option<f64> {
        let expected = format!("a number of at least {least}");
        let fits = |number: &f64| number.is_finite() && *number >= least;
        self.read(key, &expected, |text| f64::from_str(text).ok().filter(fits))
    }

    /// A whole number within what `T` holds.
    pub fn integer<T: FromStr>(&mut self, key: &'static str) -> Option<T> {
        self.read(key, "a whole number", |text| T::from_str(text).ok())
    }

    /// Yes or no: `1`, `0`, `true` or `false`.
    pub fn flag(&mut self, key: &'static str) -> Option<bool> {
        self.one_of(key, &[("1", true), ("0", false), ("true", true), ("false", false)])
    }

    /// A length of time: a number with a unit, `300s`, `100ms` or `10min`.
    pub fn duration(&mut self, key: &'static str) -> Option<Duration> {
        self.read(key, "a time such as `300s` or `100ms`", duration)
    }

    /// One of a list of words, each with what it stands for.
    pub fn one_of<T: Clone>(&mut self, key: &'static str, words: &[(&str, T)]) -> Option<T> {
        let attribute = self.get(key)?;
        let found = words.iter().find(|(word, _)| *word == attribute.value.trim());
        if found.is_none() {
            let names: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            let diagnostic = self.malformed(attribute, &format!("one of {}", listed(&names)));
            let better = yase::diagnostic::nearest(&attribute.value, names.iter().copied());
            self.diagnostics.push(match better {
                Some(word) => diagnostic.with_hint(format!("did you mean `{word}`?")),
                None => diagnostic,
            });
        }
        found.map(|(_, value)| value.clone())
    }

    /// Whatever `parse` makes of the value; if nothing, a diagnostic says what was expected.
    pub fn read<T>(
        &mut self,
        key: &'static str,
        expected: &str,
        parse: impl FnOnce(&str) -> Option<T>,
    ) -> Option<T> {
        let attribute = self.get(key)?;
        let value = parse(attribute.value.trim());
        if value.is_none() {
            let diagnostic = self.malformed(attribute, expected);
            self.diagnostics.push(diagnostic);
        }
        value
    }

    fn malformed(&self, attribute: &Attribute, expected: &str) -> Diagnostic {
        let Attribute { name, value, .. } = attribute;
        self.element.error(
            "E0306",
            attribute.value_span,
            format!("`{name}` is `{value}`, expected {expected}"),
        )
    }

    /// The attributes that nobody has asked for, for elements whose attributes are not all known here.
    pub fn rest(self) -> Vec<&'a Attribute> {
        let unasked = |attribute: &&Attribute| !self.asked.iter().any(|key| is_written(&attribute.name, key));
        self.element.attributes.iter().filter(unasked).collect()
    }

    /// Reports every attribute that nobody has asked for.
    pub fn finish(self) {
        let Attributes { element, asked, .. } = &self;
        let unasked = |attribute: &&Attribute| !asked.iter().any(|key| is_written(&attribute.name, key));
        let unknown: Vec<Diagnostic> =
            element.attributes.iter().filter(unasked).map(|a| self.unknown(a)).collect();
        self.diagnostics.extend(unknown);
    }

    fn unknown(&self, attribute: &Attribute) -> Diagnostic {
        let message = format!("unknown attribute `{}` of `{}`", attribute.name, self.element.name);
        let diagnostic = self.element.error("E0304", attribute.name_span, message);
        // A suggestion keeps the writer's way of writing names.
        let as_in_thesis = attribute.name.starts_with(char::is_uppercase);
        let known: Vec<String> =
            self.asked.iter().map(|key| if as_in_thesis { camel_case(key) } else { (*key).into() }).collect();
        diagnostic.with_nearest(&attribute.name, known.iter().map(String::as_str))
    }
}

/// Whether a name in a file is that key: in snake case, or as the thesis writes names (`IsRealTime` for `is_real_time`).
pub fn is_written(name: &str, key: &str) -> bool {
    name == key || name == camel_case(key)
}

fn camel_case(key: &str) -> String {
    key.split('_').flat_map(capitalised).collect()
}

fn capitalised(word: &str) -> impl Iterator<Item = char> {
    word.chars()
        .enumerate()
        .map(|(index, letter)| if index == 0 { letter.to_ascii_uppercase() } else { letter })
}

/// Reads a length of time: a number and `ns`, `us`, `ms`, `s` or `min`.
pub fn duration(text: &str) -> Option<Duration> {
    let unit_start = text.find(|c: char| c.is_alphabetic())?;
    let seconds = match &text[unit_start..] {
        "ns" => 1e-9,
        "us" => 1e-6,
        "ms" => 1e-3,
        "s" => 1.0,
        "min" => 60.0,
        _ => return None,
    };
    let number = f64::from_str(text[..unit_start].trim()).ok()?;
    Duration::try_from_secs_f64(number * seconds).ok()
}

fn listed(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => "nothing".into(),
    }
}
