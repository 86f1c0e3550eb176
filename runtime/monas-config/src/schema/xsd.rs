//! XML Schema 1.0.

use std::fmt::Write;

use super::super::element::camel_case;
use super::super::grammar::{AttributeRule, ElementRule, Grammar, Kind};
use super::super::xml_editor::{attribute_text, element_text};

const HEAD: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
    <!-- What a configuration of Monas may hold. Written by `monas config schema`. -->\n\
    <xs:schema xmlns:xs=\"http://www.w3.org/2001/XMLSchema\" elementFormDefault=\"qualified\">\n";

pub(crate) fn write(grammar: &Grammar) -> String {
    let mut out = String::from(HEAD);
    for rule in grammar.elements() {
        element(&mut out, rule, grammar);
    }
    out + "</xs:schema>\n"
}

/// A top-level element for each spelling of its name.
fn element(out: &mut String, rule: &ElementRule, grammar: &Grammar) {
    for name in spellings(rule.name) {
        line(out, 1, &format!("<xs:element name=\"{name}\">"));
        documentation(out, 2, rule.doc);
        content(out, rule, grammar);
        line(out, 1, "</xs:element>");
    }
}

fn content(out: &mut String, rule: &ElementRule, grammar: &Grammar) {
    let is_mixed = rule.text.is_some() && !rule.children.is_empty();
    line(out, 2, if is_mixed { "<xs:complexType mixed=\"true\">" } else { "<xs:complexType>" });
    match &rule.text {
        // An element with children is mixed: version 1.0 cannot restrict its text.
        Some(_) if !rule.children.is_empty() => {
            children(out, rule, grammar);
            attributes(out, 3, rule);
        }
        Some(text) => {
            line(out, 3, "<xs:simpleContent>");
            line(out, 4, &format!("<xs:extension base=\"{}\">", base(&text.kind)));
            attributes(out, 5, rule);
            line(out, 4, "</xs:extension>");
            line(out, 3, "</xs:simpleContent>");
        }
        None => {
            children(out, rule, grammar);
            attributes(out, 3, rule);
        }
    }
    line(out, 2, "</xs:complexType>");
}

/// Children are in any order, which version 1.0 can only express without their numbers.
fn children(out: &mut String, rule: &ElementRule, grammar: &Grammar) {
    if rule.children.is_empty() {
        return;
    }
    line(out, 3, "<xs:choice minOccurs=\"0\" maxOccurs=\"unbounded\">");
    let known = rule.children.iter().filter(|child| grammar.element(child.name).is_some());
    for name in known.flat_map(|child| spellings(child.name)) {
        line(out, 4, &format!("<xs:element ref=\"{name}\"/>"));
    }
    line(out, 3, "</xs:choice>");
}

fn attributes(out: &mut String, depth: usize, rule: &ElementRule) {
    for known in &rule.attributes {
        let alias = known.alias.into_iter().flat_map(spellings);
        for name in spellings(&known.key).into_iter().chain(alias) {
            attribute(out, depth, &name, known);
        }
    }
    if rule.takes_parameters {
        line(out, depth, "<xs:anyAttribute processContents=\"skip\"/>");
    }
}

/// A required attribute with several names is optional under each: version 1.0 cannot express "one
/// of these".
fn attribute(out: &mut String, depth: usize, name: &str, rule: &AttributeRule) {
    line(out, depth, &format!("<xs:attribute name=\"{name}\">"));
    let default = rule.default.as_ref().map(|default| format!("; default {default}"));
    documentation(out, depth + 1, &format!("{}{}", rule.doc, default.unwrap_or_default()));
    line(out, depth + 1, "<xs:simpleType>");
    line(out, depth + 2, &format!("<xs:restriction base=\"{}\">", base(&rule.kind)));
    facets(out, depth + 3, &rule.kind);
    line(out, depth + 2, "</xs:restriction>");
    line(out, depth + 1, "</xs:simpleType>");
    line(out, depth, "</xs:attribute>");
}

const fn base(kind: &Kind) -> &'static str {
    match kind {
        Kind::Whole { .. } => "xs:integer",
        Kind::Number { .. } => "xs:double",
        _ => "xs:string",
    }
}

fn facets(out: &mut String, depth: usize, kind: &Kind) {
    let mut facet = |name: &str, value: &str| {
        line(out, depth, &format!("<xs:{name} value=\"{}\"/>", attribute_text(value)));
    };
    match kind {
        Kind::Flag => ["1", "0", "true", "false"].iter().for_each(|word| facet("enumeration", word)),
        Kind::Word(words) => words.iter().for_each(|word| facet("enumeration", word)),
        Kind::Whole { min, max } => {
            facet("minInclusive", &min.to_string());
            facet("maxInclusive", &max.to_string());
        }
        Kind::Number { min, max } => {
            facet("minInclusive", &min.to_string());
            if *max < f64::MAX {
                facet("maxInclusive", &max.to_string());
            }
        }
        Kind::Duration { .. } => facet("pattern", super::json::DURATION),
        Kind::Name => facet("pattern", super::json::NAME),
        Kind::File => facet("minLength", "1"),
        Kind::List | Kind::Text => {}
    }
}

fn documentation(out: &mut String, depth: usize, doc: &str) {
    let doc = doc.split_whitespace().collect::<Vec<_>>().join(" ");
    line(
        out,
        depth,
        &format!(
            "<xs:annotation><xs:documentation>{}</xs:documentation></xs:annotation>",
            element_text(&doc)
        ),
    );
}

/// The spellings of a name: in snake case, and that of the thesis.
fn spellings(key: &str) -> Vec<String> {
    vec![key.to_owned(), camel_case(key)]
}

fn line(out: &mut String, depth: usize, text: &str) {
    let _ = writeln!(out, "{:indent$}{text}", "", indent = 2 * depth); // a string takes everything
}
