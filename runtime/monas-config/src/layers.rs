//! Layers of a configuration: settings of a robot and of the command line override the file.
//!
//! A layer consists of elements like the file. Its element overrides the element of the same name
//! and identity: agents by name, activities, providers and statecharts by text, links, teams and
//! robots by an attribute. Its attributes replace those of the file or are added, and its children
//! are applied recursively.

use yase::{Diagnostic, Source, Span};

use super::element::{Attribute, Element, Layer, is_written, listed};
use super::grammar::{ElementRule, Grammar, Identity};

/// Layers over a configuration, in the order of their addition.
#[derive(Clone, Debug, Default)]
pub struct Layers {
    over: Vec<Element>,
}

/// A setting of the command line that matches no element.
#[derive(Clone, Debug)]
pub struct UnmatchedSetting {
    /// Its index, counted from 0 over all elements of the layers.
    pub index: usize,
    /// The diagnostic, with a suggestion.
    pub diagnostic: Diagnostic,
}

impl Layers {
    /// No layers.
    pub fn new() -> Layers {
        Layers::default()
    }

    /// The number of elements in the layers.
    pub fn len(&self) -> usize {
        self.over.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.over.is_empty()
    }

    /// Adds settings of one robot. Elements that the file does not have are added.
    pub fn robot(mut self, elements: impl IntoIterator<Item = Element>) -> Layers {
        let on_layer = |mut element: Element| {
            // Settings of the command line in it stay on their layer.
            let layer = element.layer.max(Layer::Robot);
            raise(&mut element, layer);
            element
        };
        self.over.extend(elements.into_iter().map(on_layer));
        self
    }

    /// Adds a setting of the command line: `agent.Motion.frequency=50`. Parts that contain dots are
    /// in double quotes.
    ///
    /// # Errors
    /// The path or the value does not match the grammar.
    pub fn set(mut self, text: &str, grammar: &Grammar) -> Result<Layers, Box<Diagnostic>> {
        self.over.push(setting(text, grammar)?);
        Ok(self)
    }

    /// The layers of root elements with these names.
    pub fn of(&self, roots: &[&str]) -> Layers {
        let wanted = |element: &&Element| roots.iter().any(|root| element.is(root));
        Layers { over: self.over.iter().filter(wanted).cloned().collect() }
    }

    /// The settings of the command line, as written.
    pub fn settings(&self) -> impl Iterator<Item = &str> {
        let set = self.over.iter().filter(|element| element.layer == Layer::CommandLine);
        set.map(|element| element.source.text.as_str())
    }

    /// These layers, followed by others.
    pub fn and(mut self, others: &Layers) -> Layers {
        self.over.extend(others.over.iter().cloned());
        self
    }

    /// Applies the layers to root elements. Settings of the command line change existing elements;
    /// those that match none are returned.
    pub fn apply(&self, elements: &mut Vec<Element>, grammar: &Grammar) -> Vec<UnmatchedSetting> {
        let mut unmatched = Vec::new();
        for (index, over) in self.over.iter().enumerate() {
            let adds = over.layer != Layer::CommandLine;
            if let Err(diagnostic) = overlay(elements, over.clone(), grammar, adds, None) {
                unmatched.push(UnmatchedSetting { index, diagnostic: *diagnostic });
            }
        }
        unmatched
    }
}

fn raise(element: &mut Element, layer: Layer) {
    element.layer = element.layer.max(layer);
    for attribute in &mut element.attributes {
        attribute.layer = attribute.layer.max(layer);
    }
    element.children.iter_mut().for_each(|child| raise(child, layer));
}

/// Applies an element to its counterpart among these.
fn overlay(
    elements: &mut Vec<Element>,
    over: Element,
    grammar: &Grammar,
    adds: bool,
    within: Option<&ElementRule>,
) -> Result<(), Box<Diagnostic>> {
    let Some(rule) = grammar.element(&over.name) else {
        elements.push(over);
        return Ok(());
    };
    let is_repeated = rule.identity == Identity::None
        && within.and_then(|above| above.child_named(rule.name)).is_some_and(|child| !child.is_single);
    let target = match is_repeated {
        true => None,
        false => same_identity(elements, rule, rule.identity_of(&over), grammar),
    };
    match target {
        Some(target) => merge(target, over, rule, grammar, adds),
        None if adds || rule.identity == Identity::None => {
            elements.push(over);
            Ok(())
        }
        None => Err(Box::new(not_there(elements, &over, rule, grammar))),
    }
}

/// The element of that name and identity, also inside groups.
fn same_identity<'a>(
    elements: &'a mut [Element],
    rule: &ElementRule,
    identity: Option<&str>,
    grammar: &Grammar,
) -> Option<&'a mut Element> {
    elements.iter_mut().find_map(|element| match grammar.element(&element.name) {
        Some(own) if own.is_group => same_identity(&mut element.children, rule, identity, grammar),
        _ => (element.is(rule.name) && rule.identity_of(element) == identity).then_some(element),
    })
}

fn merge(
    target: &mut Element,
    over: Element,
    rule: &ElementRule,
    grammar: &Grammar,
    adds: bool,
) -> Result<(), Box<Diagnostic>> {
    if rule.attributes.is_empty() && rule.children.is_empty() {
        *target = over;
        return Ok(());
    }
    for attribute in over.attributes.into_iter().filter(|given| !is_identity(rule, &given.name)) {
        let known = rule.attribute_named(&attribute.name);
        let same = |given: &Attribute| match known {
            Some(known) => known.is(&given.name),
            None => given.name == attribute.name,
        };
        match target.attributes.iter_mut().find(|given| same(given)) {
            Some(given) => *given = attribute,
            None => target.attributes.push(attribute),
        }
    }
    for child in over.children {
        if is_identity(rule, &child.name) {
            continue;
        }
        overlay(&mut target.children, child, grammar, adds || rule.is_layer, Some(rule))?;
    }
    Ok(())
}

/// Whether an attribute or child of that name is the identity.
fn is_identity(rule: &ElementRule, name: &str) -> bool {
    matches!(rule.identity, Identity::Child(key) | Identity::Attribute(key) if is_written(name, key))
}

fn not_there(elements: &[Element], over: &Element, rule: &ElementRule, grammar: &Grammar) -> Diagnostic {
    let identity = rule.identity_of(over).unwrap_or_default();
    let message = format!("there is no `{}` `{identity}`", rule.name);
    let diagnostic = over.error("E0341", over.text_span, message);
    let known = identities(elements, rule, grammar);
    let near = diagnostic.with_nearest(identity, known.iter().copied());
    let is_value = rule.identity == Identity::Text && over.attributes.is_empty() && over.children.is_empty();
    if let Some(first) = known.first().filter(|_| is_value) {
        let path = over.source.text.split('=').next().unwrap_or_default();
        let hint = format!(
            "there is {}; it cannot be replaced, but its attributes can be set, as in `{path}.\"{first}\".enable=0`",
            listed(&known)
        );
        return near.with_hint(hint);
    }
    match (&near.hint, known.is_empty()) {
        (Some(_), _) => near,
        (None, true) => near.with_hint(format!("there is no `{}` at all", rule.name)),
        (None, false) => near.with_hint(format!("there is {}", listed(&known))),
    }
}

fn identities<'a>(elements: &'a [Element], rule: &ElementRule, grammar: &Grammar) -> Vec<&'a str> {
    let of = |element: &'a Element| match grammar.element(&element.name) {
        Some(own) if own.is_group => identities(&element.children, rule, grammar),
        _ if element.is(rule.name) => rule.identity_of(element).into_iter().collect(),
        _ => Vec::new(),
    };
    elements.iter().flat_map(of).collect()
}

/// A segment of a path, with its location in the setting.
struct PathSegment {
    text: String,
    span: Span,
}

/// The element of the command line's layer for a setting.
fn setting(text: &str, grammar: &Grammar) -> Result<Element, Box<Diagnostic>> {
    let source = Source::new("--set", text);
    let wrong = |span: Span, message: String, hint: String| {
        Box::new(Diagnostic::error("E0340", span, message).with_hint(hint).in_source(&source))
    };
    let example = || "write `agent.NAME.priority=2`: a path, `=` and a value".to_owned();
    let (parts, value) = parts(text).ok_or_else(|| {
        wrong(Span::new(0, text.len()), format!("`{text}` is not a path with a value"), example())
    })?;
    let [first, rest @ ..] = parts.as_slice() else {
        return Err(wrong(Span::new(0, text.len()), format!("`{text}` has no path"), example()));
    };
    let Some(rule) =
        grammar.roots().iter().find_map(|root| grammar.element(root).filter(|_| *root == first.text))
    else {
        let message = format!("there is no setting `{}`", first.text);
        let roots: Vec<&str> =
            grammar.roots().iter().copied().filter(|root| !is_group(grammar, root)).collect();
        let near = yase::diagnostic::nearest(&first.text, roots.iter().copied());
        let hint = match near {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("expected {}", listed(&roots)),
        };
        return Err(wrong(first.span, message, hint));
    };
    let writer = SettingWriter { source: &source, grammar, value };
    writer.element(first, rule, rest).map_err(|(span, message, hint)| wrong(span, message, hint))
}

fn is_group(grammar: &Grammar, name: &str) -> bool {
    grammar.element(name).is_some_and(|rule| rule.is_group)
}

/// The segments of a path and the value.
fn parts(text: &str) -> Option<(Vec<PathSegment>, PathSegment)> {
    let mut parts = Vec::new();
    let mut at = 0;
    loop {
        let rest = &text[at..];
        let (part, length) = match rest.strip_prefix('"') {
            Some(quoted) => {
                let end = quoted.find('"')?;
                (
                    PathSegment { text: quoted[..end].to_owned(), span: Span::new(at + 1, at + 1 + end) },
                    end + 2,
                )
            }
            None => {
                let end = rest.find(['.', '='])?;
                (PathSegment { text: rest[..end].trim().to_owned(), span: Span::new(at, at + end) }, end)
            }
        };
        if part.text.is_empty() {
            return None;
        }
        parts.push(part);
        at += length;
        match text[at..].chars().next()? {
            '.' => at += 1,
            '=' => {
                let value = text[at + 1..].trim().to_owned();
                return Some((parts, PathSegment { text: value, span: Span::new(at + 1, text.len()) }));
            }
            _ => return None,
        }
    }
}

/// An error in a setting: location, message, and hint.
type SettingError = (Span, String, String);

struct SettingWriter<'a> {
    source: &'a std::sync::Arc<Source>,
    grammar: &'a Grammar,
    value: PathSegment,
}

impl SettingWriter<'_> {
    fn element(
        &self,
        name: &PathSegment,
        rule: &ElementRule,
        rest: &[PathSegment],
    ) -> Result<Element, SettingError> {
        let mut element = self.empty(rule.name, name.span);
        let rest = match (rule.identity, rest) {
            (Identity::None, rest) => rest,
            (identity, [own, rest @ ..]) => {
                element.text_span = own.span;
                self.identify(&mut element, identity, own);
                rest
            }
            (_, []) => {
                let message = format!("the setting does not name the `{}`", rule.name);
                return Err((name.span, message, example_of(rule)));
            }
        };
        match rest {
            [] => {
                let message = format!("the setting does not name an attribute of `{}`", rule.name);
                Err((name.span, message, example_of(rule)))
            }
            [key] if is_identity(rule, &key.text) => {
                let message =
                    format!("the `{}` of `{}` identifies it and cannot be set", key.text, rule.name);
                Err((key.span, message, "change it in the file".into()))
            }
            [key] => {
                self.last(&mut element, rule, key);
                Ok(element)
            }
            [child, rest @ ..] => {
                let below = rule.child_named(&child.text).and_then(|child| self.grammar.element(child.name));
                let Some(below) = below else {
                    let message = format!("`{}` holds no `{}`", rule.name, child.text);
                    let names: Vec<&str> = rule.children.iter().map(|child| child.name).collect();
                    let near = yase::diagnostic::nearest(&child.text, names.iter().copied());
                    let hint = match near {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("expected {}", listed(&names)),
                    };
                    return Err((child.span, message, hint));
                };
                element.children.push(self.element(child, below, rest)?);
                Ok(element)
            }
        }
    }

    /// The last segment is an attribute, or an element with a text.
    fn last(&self, element: &mut Element, rule: &ElementRule, key: &PathSegment) {
        let child = rule.child_named(&key.text).and_then(|child| self.grammar.element(child.name));
        match child.filter(|_| rule.attribute_named(&key.text).is_none()) {
            Some(child) => {
                let mut inner = self.empty(child.name, key.span);
                (inner.text, inner.text_span) = (self.value.text.clone(), self.value.span);
                element.children.push(inner);
            }
            None => element.attributes.push(self.attribute(&key.text, key.span, &self.value)),
        }
    }

    fn identify(&self, element: &mut Element, identity: Identity, own: &PathSegment) {
        match identity {
            Identity::None => {}
            Identity::Text => element.text.clone_from(&own.text),
            Identity::Attribute(key) => element.attributes.push(self.attribute(key, own.span, own)),
            Identity::Child(name) => {
                let mut child = self.empty(name, own.span);
                (child.text, child.text_span) = (own.text.clone(), own.span);
                element.children.push(child);
            }
        }
    }

    fn attribute(&self, name: &str, name_span: Span, value: &PathSegment) -> Attribute {
        Attribute {
            name: name.to_owned(),
            name_span,
            value: value.text.clone(),
            value_span: value.span,
            source: self.source.clone(),
            layer: Layer::CommandLine,
        }
    }

    fn empty(&self, name: &str, span: Span) -> Element {
        Element {
            name: name.to_owned(),
            name_span: span,
            span: Span::new(0, self.source.text.len()),
            attributes: Vec::new(),
            children: Vec::new(),
            text: String::new(),
            text_span: span,
            source: self.source.clone(),
            layer: Layer::CommandLine,
        }
    }
}

/// An example of a setting of an element.
fn example_of(rule: &ElementRule) -> String {
    let key = rule.attributes.first().map_or("KEY", |attribute| &*attribute.key);
    match rule.identity {
        Identity::None => format!("write `{}.{key}=VALUE`", rule.name),
        _ => format!("write `{}.NAME.{key}=VALUE`", rule.name),
    }
}
