//! Resolves a configuration: the file with its layers, and every value with its origin.

use std::path::Path;
use std::sync::Arc;

use yase::{Diagnostic, Source, Span};

use super::element::{Attribute, Element, Layer};
use super::grammar::{AttributeRule, ElementRule, Grammar, Identity};
use super::layers::{Layers, UnmatchedSetting};
use super::paths;

/// A file with its layers.
#[derive(Clone, Debug, Default)]
pub struct Resolved {
    /// The elements of the file, with layers applied.
    pub elements: Vec<Element>,
    /// Settings that match nothing in this file.
    pub unmatched: Vec<UnmatchedSetting>,
    /// Other diagnostics.
    pub diagnostics: Vec<Diagnostic>,
}

impl Resolved {
    /// All diagnostics, in the order of the text.
    pub fn into_diagnostics(self) -> Vec<Diagnostic> {
        let unmatched = self.unmatched.into_iter().map(|unmatched| unmatched.diagnostic);
        let mut all: Vec<Diagnostic> = self.diagnostics.into_iter().chain(unmatched).collect();
        sort(&mut all);
        all
    }
}

/// Reads a file, applies the layers, and reports everything the grammar does not allow.
pub fn resolve(path: &Path, grammar: &Grammar, layers: &Layers) -> Resolved {
    match paths::read(path) {
        Ok(source) => resolve_text(&source, grammar, layers),
        Err(diagnostic) => Resolved { diagnostics: vec![*diagnostic], ..Resolved::default() },
    }
}

/// As [`resolve`], from a text in memory.
pub fn resolve_text(source: &Arc<Source>, grammar: &Grammar, layers: &Layers) -> Resolved {
    let (mut elements, mut diagnostics) = grammar.parse(source);
    let unmatched = layers.apply(&mut elements, grammar);
    grammar.check(&elements, &mut diagnostics);
    Resolved { elements, unmatched, diagnostics }
}

/// Sorts diagnostics by file and location.
pub fn sort(diagnostics: &mut [Diagnostic]) {
    let names: Vec<Option<String>> = diagnostics.iter().map(file_of).collect();
    diagnostics.sort_by_key(|diagnostic| {
        let name = file_of(diagnostic);
        (names.iter().position(|known| *known == name), diagnostic.span.start)
    });
}

fn file_of(diagnostic: &Diagnostic) -> Option<String> {
    diagnostic.source.as_ref().map(|source| source.name.clone())
}

/// A value of a configuration.
#[derive(Clone, Debug)]
pub struct ResolvedEntry {
    /// Its path, as in `--set`: `agent.Motion.priority`.
    pub path: String,
    /// The value; none for an element without text.
    pub value: Option<String>,
    /// The layer it comes from.
    pub layer: Layer,
    /// Its location; none for a default.
    pub location: Option<(Arc<Source>, Span)>,
}

impl ResolvedEntry {
    /// Its origin, in prose.
    pub fn origin(&self) -> String {
        match (&self.location, self.layer) {
            (Some((source, _)), Layer::CommandLine) => format!("{} {}", source.name, source.text),
            (Some((source, span)), layer) => {
                let (line, column) = source.position(span.start);
                let of = if layer == Layer::Robot { " (robot)" } else { "" };
                format!("{}:{line}:{column}{of}", source.name)
            }
            (None, layer) => layer.name().to_owned(),
        }
    }
}

/// Every value of these elements, including defaults: elements in order, each with its attributes
/// and children.
pub fn entries(elements: &[Element], grammar: &Grammar) -> Vec<ResolvedEntry> {
    let mut entries = Vec::new();
    list(elements, "", grammar, &mut entries);
    entries
}

fn list(elements: &[Element], prefix: &str, grammar: &Grammar, entries: &mut Vec<ResolvedEntry>) {
    for (index, element) in elements.iter().enumerate() {
        match grammar.element(&element.name) {
            Some(rule) if rule.is_group => list(&element.children, prefix, grammar, entries),
            Some(rule) => {
                let namesakes = elements.iter().filter(|one| one.is(rule.name)).count();
                let earlier = elements[..index].iter().filter(|one| one.is(rule.name)).count();
                let path = path_of(element, rule, prefix, (namesakes > 1).then_some(earlier + 1));
                list_element(element, rule, &path, grammar, entries);
            }
            None => {}
        }
    }
}

/// The path of an element; the number distinguishes elements without identity.
fn path_of(element: &Element, rule: &ElementRule, prefix: &str, number: Option<usize>) -> String {
    let name = format!("{prefix}{}", rule.name);
    match (rule.identity_of(element), number) {
        (Some(identity), _) if identity.contains(['.', '=', '"']) => format!("{name}.\"{identity}\""),
        (Some(identity), _) => format!("{name}.{identity}"),
        (None, Some(number)) => format!("{name}[{number}]"),
        (None, None) => name,
    }
}

fn list_element(
    element: &Element,
    rule: &ElementRule,
    path: &str,
    grammar: &Grammar,
    entries: &mut Vec<ResolvedEntry>,
) {
    let is_plain = rule.text.is_some() && rule.identity != Identity::Text;
    let has_values =
        !rule.attributes.is_empty() || !element.attributes.is_empty() || !element.children.is_empty();
    if is_plain || !has_values {
        let value = is_plain.then(|| element.text.clone());
        let span = Some((element.source.clone(), element.text_span));
        entries.push(ResolvedEntry { path: path.to_owned(), value, layer: element.layer, location: span });
    }
    let is_identity =
        |known: &&AttributeRule| matches!(rule.identity, Identity::Attribute(key) if key == known.key);
    for known in rule.attributes.iter().filter(|known| !is_identity(known)) {
        let given = element.attributes.iter().find(|given| known.is(&given.name));
        match (given, &known.default) {
            (Some(given), _) => entries.push(entry(path, &known.key, given)),
            (None, Some(default)) => entries.push(ResolvedEntry {
                path: format!("{path}.{}", known.key),
                value: Some(default.clone()),
                layer: Layer::Default,
                location: None,
            }),
            (None, None) => {}
        }
    }
    let unknown = element.attributes.iter().filter(|given| rule.attribute_named(&given.name).is_none());
    entries.extend(unknown.map(|given| entry(path, &given.name, given)));
    let below: Vec<Element> = element
        .children
        .iter()
        .filter(|child| !matches!(rule.identity, Identity::Child(name) if child.is(name)))
        .cloned()
        .collect();
    list(&below, &format!("{path}."), grammar, entries);
    list_defaults(&below, rule, path, grammar, entries);
}

/// The absent child elements that have a default text.
fn list_defaults(
    below: &[Element],
    rule: &ElementRule,
    path: &str,
    grammar: &Grammar,
    entries: &mut Vec<ResolvedEntry>,
) {
    for child in &rule.children {
        let Some(known) = grammar.element(child.name) else { continue };
        if let Some(default) = known.default.as_ref().filter(|_| !below.iter().any(|one| one.is(child.name)))
        {
            entries.push(ResolvedEntry {
                path: format!("{path}.{}", child.name),
                value: Some(default.clone()),
                layer: Layer::Default,
                location: None,
            });
        }
    }
}

fn entry(path: &str, key: &str, given: &Attribute) -> ResolvedEntry {
    ResolvedEntry {
        path: format!("{path}.{key}"),
        value: Some(given.value.clone()),
        layer: given.layer,
        location: Some((given.source.clone(), given.value_span)),
    }
}
