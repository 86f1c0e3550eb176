//! JSON Schema 2020-12, for TOML.

use std::fmt::Write;

use super::super::element::camel_case;
use super::super::grammar::{AttributeRule, ElementRule, Grammar, Kind};

/// Pattern of what [`crate::duration`] takes, without blanks around it.
pub(crate) const DURATION: &str = "([0-9]+\\.?[0-9]*|\\.[0-9]+) *(ns|us|ms|s|min|h)";
/// Pattern of a name.
pub(crate) const NAME: &str = "[A-Za-z0-9_\\-]+";

pub(crate) fn write(grammar: &Grammar) -> String {
    let definitions = grammar.elements().iter().map(|rule| (rule.name.to_owned(), definition(rule, grammar)));
    let definitions = JsonNode::Object(definitions.collect());
    let roots = grammar.roots().iter().flat_map(|root| spellings(root).map(|name| (name, one_or_many(root))));
    let document = JsonNode::Object(vec![
        ("$schema".into(), JsonNode::text("https://json-schema.org/draft/2020-12/schema")),
        ("title".into(), JsonNode::text("Monas configuration")),
        ("type".into(), JsonNode::text("object")),
        ("additionalProperties".into(), JsonNode::False),
        ("properties".into(), JsonNode::Object(roots.collect())),
        ("$defs".into(), definitions),
    ]);
    let mut out = String::new();
    document.write(&mut out, 0);
    out + "\n"
}

/// An element is a table; a plain text if it has only a text; an array if it may occur several
/// times.
fn definition(rule: &ElementRule, grammar: &Grammar) -> JsonNode {
    let mut properties: Vec<(String, JsonNode)> = Vec::new();
    for known in &rule.attributes {
        let names = spellings(&known.key).into_iter().chain(known.alias.into_iter().flat_map(spellings));
        properties.extend(names.map(|name| (name, attribute(known))));
    }
    for child in rule.children.iter().filter(|child| grammar.element(child.name).is_some()) {
        properties.extend(spellings(child.name).map(|name| (name, one_or_many(child.name))));
    }
    if let Some(text) = &rule.text {
        properties.push((text.key.into(), JsonNode::Object(value(&text.kind))));
    }
    let mut table = vec![("type".to_owned(), JsonNode::text("object"))];
    if !rule.takes_parameters {
        table.push(("additionalProperties".into(), JsonNode::False));
    }
    table.push(("properties".into(), JsonNode::Object(properties)));
    let doc = ("description".to_owned(), JsonNode::text(rule.doc));
    match &rule.text {
        Some(text) => {
            let either = vec![JsonNode::Object(value(&text.kind)), JsonNode::Object(table)];
            JsonNode::Object(vec![doc, ("anyOf".into(), JsonNode::Array(either))])
        }
        None => JsonNode::Object(std::iter::once(doc).chain(table).collect()),
    }
}

fn one_or_many(name: &str) -> JsonNode {
    let reference = || JsonNode::Object(vec![("$ref".into(), JsonNode::text(&format!("#/$defs/{name}")))]);
    let many = vec![("type".into(), JsonNode::text("array")), ("items".into(), reference())];
    JsonNode::Object(vec![("anyOf".into(), JsonNode::Array(vec![reference(), JsonNode::Object(many)]))])
}

fn attribute(rule: &AttributeRule) -> JsonNode {
    let mut schema = value(&rule.kind);
    schema.push(("description".into(), JsonNode::text(rule.doc)));
    if let Some(default) = &rule.default {
        schema.push(("default".into(), JsonNode::text(default)));
    }
    JsonNode::Object(schema)
}

/// The schema of a value, as its type or as a text.
fn value(kind: &Kind) -> Vec<(String, JsonNode)> {
    let typed = |name: &str| ("type".to_owned(), JsonNode::text(name));
    let limits = |min: f64, max: f64| {
        let min = ("minimum".to_owned(), JsonNode::Number(min));
        let max = (max < f64::MAX).then(|| ("maximum".to_owned(), JsonNode::Number(max)));
        std::iter::once(min).chain(max)
    };
    let words = |words: &[&str]| JsonNode::Array(words.iter().map(|word| JsonNode::text(word)).collect());
    match kind {
        Kind::Flag => vec![(
            "enum".into(),
            JsonNode::Array(vec![
                JsonNode::True,
                JsonNode::False,
                JsonNode::Number(1.0),
                JsonNode::Number(0.0),
                JsonNode::text("1"),
                JsonNode::text("0"),
                JsonNode::text("true"),
                JsonNode::text("false"),
            ]),
        )],
        Kind::Whole { min, max } => {
            std::iter::once(typed("integer")).chain(limits(*min as f64, *max as f64)).collect()
        }
        Kind::Number { min, max } => std::iter::once(typed("number")).chain(limits(*min, *max)).collect(),
        Kind::Duration { .. } => {
            vec![typed("string"), ("pattern".into(), JsonNode::text(&format!("^{DURATION}$")))]
        }
        Kind::Word(known) => vec![("enum".into(), words(known))],
        Kind::Name => vec![typed("string"), ("pattern".into(), JsonNode::text(&format!("^{NAME}$")))],
        Kind::File => vec![typed("string"), ("minLength".into(), JsonNode::Number(1.0))],
        Kind::List => vec![("type".into(), words(&["string", "array"]))],
        Kind::Text => vec![("type".into(), words(&["string", "number", "boolean"]))],
    }
}

fn spellings(key: &str) -> [String; 2] {
    [key.to_owned(), camel_case(key)]
}

/// The subset of JSON needed to write a schema in the order of the grammar.
enum JsonNode {
    True,
    False,
    Number(f64),
    Text(String),
    Array(Vec<JsonNode>),
    Object(Vec<(String, JsonNode)>),
}

impl JsonNode {
    fn text(text: &str) -> JsonNode {
        JsonNode::Text(text.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    fn write(&self, out: &mut String, depth: usize) {
        match self {
            JsonNode::True => out.push_str("true"),
            JsonNode::False => out.push_str("false"),
            JsonNode::Number(number) => drop(write!(out, "{number}")),
            JsonNode::Text(text) => quoted(out, text),
            JsonNode::Array(values) => {
                out.push('[');
                for (index, value) in values.iter().enumerate() {
                    out.push_str(if index == 0 { "" } else { ", " });
                    value.write(out, depth);
                }
                out.push(']');
            }
            JsonNode::Object(entries) => {
                out.push('{');
                for (index, (key, value)) in entries.iter().enumerate() {
                    out.push_str(if index == 0 { "\n" } else { ",\n" });
                    out.push_str(&" ".repeat(2 * depth + 2));
                    quoted(out, key);
                    out.push_str(": ");
                    value.write(out, depth + 1);
                }
                out.push('\n');
                out.push_str(&" ".repeat(2 * depth));
                out.push('}');
            }
        }
    }
}

fn quoted(out: &mut String, text: &str) {
    out.push('"');
    for character in text.chars() {
        match character {
            '"' | '\\' => {
                out.push('\\');
                out.push(character);
            }
            control if control < ' ' => drop(write!(out, "\\u{:04x}", control as u32)),
            other => out.push(other),
        }
    }
    out.push('"');
}
