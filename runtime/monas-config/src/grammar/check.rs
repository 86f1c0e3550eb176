//! Checks elements against the grammar.

use yase::Diagnostic;

use super::super::element::{Attribute, Element, camel_case, listed};
use super::{AttributeRule, ElementRule, Grammar};

impl Grammar {
    /// Reports everything in these root elements that the grammar does not allow.
    pub fn check(&self, elements: &[Element], diagnostics: &mut Vec<Diagnostic>) {
        for element in elements {
            match self.roots.iter().find(|root| element.is(root)).and_then(|root| self.element(root)) {
                Some(rule) => self.check_element(element, rule, diagnostics),
                None => diagnostics.push(unknown(element, &self.roots)),
            }
        }
    }

    fn check_element(&self, element: &Element, rule: &ElementRule, diagnostics: &mut Vec<Diagnostic>) {
        check_attributes(element, rule, diagnostics);
        check_text(element, rule, diagnostics);
        check_numbers(element, rule, diagnostics);
        for child in element.children() {
            match rule.child_named(child.name()).and_then(|child| self.element(child.name)) {
                Some(rule) => self.check_element(child, rule, diagnostics),
                None => {
                    let names: Vec<&str> = rule.children.iter().map(|child| child.name).collect();
                    diagnostics.push(unknown(child, &names));
                }
            }
        }
    }
}

fn check_attributes(element: &Element, rule: &ElementRule, diagnostics: &mut Vec<Diagnostic>) {
    for (index, given) in element.attributes().iter().enumerate() {
        match rule.attribute_named(&given.name) {
            Some(known) => {
                check_value(given, known, diagnostics);
                if element.attributes()[..index].iter().any(|earlier| known.is(&earlier.name)) {
                    let message = format!("attribute `{}` is repeated", known.key);
                    diagnostics.push(given.name_error("E0307", message).with_hint("remove one of them"));
                }
            }
            None if rule.takes_parameters => {}
            None => diagnostics.push(unknown_attribute(element, given, rule)),
        }
    }
    for wanted in rule.attributes.iter().filter(|attribute| attribute.is_required) {
        if !element.attributes().iter().any(|given| wanted.is(&given.name)) {
            diagnostics.push(missing_attribute(element, wanted));
        }
    }
}

fn check_value(given: &Attribute, rule: &AttributeRule, diagnostics: &mut Vec<Diagnostic>) {
    if !rule.kind.allows(&given.value) {
        let message = format!("`{}` is `{}`, expected {}", given.name, given.value, rule.kind.expected());
        let diagnostic = given.error("E0306", message);
        diagnostics.push(match rule.kind.nearest(&given.value) {
            Some(hint) => diagnostic.with_hint(hint),
            None => diagnostic,
        });
    }
}

fn missing_attribute(element: &Element, wanted: &AttributeRule) -> Diagnostic {
    let message = format!("`{}` lacks the attribute `{}`", element.name(), wanted.key);
    let diagnostic = element.error("E0305", element.name_span(), message);
    let given = element.attributes().iter().map(|given| given.name.as_str());
    match yase::diagnostic::nearest(&wanted.key, given) {
        Some(wrong) => diagnostic.with_hint(format!("is `{wrong}` meant to be `{}`?", wanted.key)),
        None => diagnostic.with_hint(format!("`{}` is {}", wanted.key, wanted.kind.expected())),
    }
}

fn unknown_attribute(element: &Element, given: &Attribute, rule: &ElementRule) -> Diagnostic {
    let message = format!("unknown attribute `{}` of `{}`", given.name, element.name());
    let diagnostic = given.name_error("E0304", message);
    // Suggestions use the spelling of the given name.
    let as_in_thesis = given.name.starts_with(char::is_uppercase);
    let spelled = |key: &str| if as_in_thesis { camel_case(key) } else { key.to_owned() };
    let known: Vec<String> = rule.attributes.iter().map(|attribute| spelled(&attribute.key)).collect();
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let aliases: Vec<String> =
        rule.attributes.iter().filter_map(|attribute| attribute.alias.map(spelled)).collect();
    let all = known.iter().copied().chain(aliases.iter().map(String::as_str));
    let diagnostic = diagnostic.with_nearest(&given.name, all);
    match (&diagnostic.hint, known.is_empty()) {
        (Some(_), _) => diagnostic,
        (None, true) => diagnostic.with_hint(format!("`{}` has no attributes", element.name())),
        (None, false) => diagnostic.with_hint(format!("expected {}", listed(&known))),
    }
}

fn check_text(element: &Element, rule: &ElementRule, diagnostics: &mut Vec<Diagnostic>) {
    match &rule.text {
        Some(_) if element.text().is_empty() => {
            let message = format!("`{}` is empty", element.name());
            let hint = format!("it is {}", rule.doc);
            diagnostics.push(element.error("E0310", element.name_span(), message).with_hint(hint));
        }
        Some(text) if !text.kind.allows(element.text()) => {
            let expected = text.kind.expected();
            let message = format!("`{}` is `{}`, expected {expected}", element.name(), element.text());
            diagnostics.push(element.error("E0306", element.text_span(), message));
        }
        None if !element.text().is_empty() => {
            let message = format!("`{}` contains text, which is not allowed there", element.name());
            let diagnostic = element.error("E0308", element.text_span(), message);
            let children: Vec<&str> = rule.children.iter().map(|child| child.name).collect();
            diagnostics.push(match children.is_empty() {
                true => diagnostic.with_hint("leave it out"),
                false => diagnostic.with_hint(format!("expected {}", listed(&children))),
            });
        }
        _ => {}
    }
}

/// Checks the number of children of each name.
fn check_numbers(element: &Element, rule: &ElementRule, diagnostics: &mut Vec<Diagnostic>) {
    for wanted in &rule.children {
        let mut found = element.children_named(wanted.name);
        if found.next().is_none() && wanted.is_required {
            let message = format!("`{}` has no `{}`", element.name(), wanted.name);
            let diagnostic = element.error("E0305", element.name_span(), message);
            diagnostics.push(diagnostic.with_hint(format!("give it a `{}`", wanted.name)));
        }
        for second in found.filter(|_| wanted.is_single) {
            let message = format!("`{}` has a second `{}`", element.name(), wanted.name);
            let diagnostic = second.error("E0307", second.name_span(), message);
            diagnostics.push(diagnostic.with_hint("remove one of them"));
        }
    }
}

/// An element of this name is not allowed here; these are.
fn unknown(element: &Element, names: &[&str]) -> Diagnostic {
    let message = format!("unknown element `{}`", element.name());
    let diagnostic = element.error("E0303", element.name_span(), message);
    let diagnostic = diagnostic.with_nearest(element.name(), names.iter().copied());
    match (&diagnostic.hint, names.len()) {
        (Some(_), _) => diagnostic,
        (None, 0) => diagnostic.with_hint("no element is allowed here"),
        // A list of a hundred parameters does not help.
        (None, 1..=12) => diagnostic.with_hint(format!("expected {}", listed(names))),
        (None, _) => diagnostic.with_hint(format!("expected one such as {}", listed(&names[..6]))),
    }
}
