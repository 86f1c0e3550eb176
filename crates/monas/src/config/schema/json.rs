//! JSON Schema 2020-12, for TOML.

use std::fmt::Write;

use super::super::element::camel_case;
use super::super::grammar::{AttributeRule, ElementRule, Grammar, Kind};

/// What a length of time looks like.
pub(super) const DURATION: &str = "[0-9]+(\\.[0-9]+)?([eE][-+]?[0-9]+)? *(ns|us|ms|s|min)";
/// What a name looks like.
pub(super) const NAME: &str = "[A-Za-z0-9_\\-]+";

pub(super) fn write(grammar: &Grammar) -> String {
    let definitions = grammar.elements().iter().map(|rule| (rule.name.to_owned(), definition(rule, grammar)));
    let definitions = Json::Object(definitions.collect());
    let roots = grammar.roots().iter().flat_map(|root| spellings(root).map(|name| (name, one_or_many(root))));
    let document = Json::Object(vec![
        ("$schema".into(), Json::text("https://json-schema.org/draft/2020-12/schema")),
        ("title".into(), Json::text("Monas configuration")),
        ("type".into(), Json::text("object")),
        ("additionalProperties".into(), Json::False),
        ("properties".into(), Json::Object(roots.collect())),
        ("$defs".into(), definitions),
    ]);
    let mut out = String::new();
    document.write(&mut out, 0);
    out + "\n"
}

/// An element is a table; a plain text where that is all of it; an array where there are several.
fn definition(rule: &ElementRule, grammar: &Grammar) -> Json {
    let mut properties: Vec<(String, Json)> = Vec::new();
    for known in &rule.attributes {
        let names = spellings(known.key).into_iter().chain(known.alias.into_iter().flat_map(spellings));
        properties.extend(names.map(|name| (name, attribute(known))));
    }
    for child in rule.children.iter().filter(|child| grammar.element(child.name).is_some()) {
        properties.extend(spellings(child.name).map(|name| (name, one_or_many(child.name))));
    }
    if let Some(text) = &rule.text {
        properties.push((text.key.into(), Json::Object(value(&text.kind))));
    }
    let mut table = vec![("type".to_owned(), Json::text("object"))];
    if !rule.takes_parameters {
        table.push(("additionalProperties".into(), Json::False));
    }
    table.push(("properties".into(), Json::Object(properties)));
    let doc = ("description".to_owned(), Json::text(rule.doc));
    match &rule.text {
        Some(text) => {
            let either = vec![Json::Object(value(&text.kind)), Json::Object(table)];
            Json::Object(vec![doc, ("anyOf".into(), Json::Array(either))])
        }
        None => Json::Object(std::iter::once(doc).chain(table).collect()),
    }
}

fn one_or_many(name: &str) -> Json {
    let reference = || Json::Object(vec![("$ref".into(), Json::text(&format!("#/$defs/{name}")))]);
    let many = vec![("type".into(), Json::text("array")), ("items".into(), reference())];
    Json::Object(vec![("anyOf".into(), Json::Array(vec![reference(), Json::Object(many)]))])
}

fn attribute(rule: &AttributeRule) -> Json {
    let mut schema = value(&rule.kind);
    schema.push(("description".into(), Json::text(rule.doc)));
    if let Some(default) = &rule.default {
        schema.push(("default".into(), Json::text(default)));
    }
    Json::Object(schema)
}

/// What a value may be, of its own type or as a text.
fn value(kind: &Kind) -> Vec<(String, Json)> {
    let typed = |name: &str| ("type".to_owned(), Json::text(name));
    let limits = |least: f64, most: f64| {
        let least = ("minimum".to_owned(), Json::Number(least));
        let most = (most < f64::MAX).then(|| ("maximum".to_owned(), Json::Number(most)));
        std::iter::once(least).chain(most)
    };
    let words = |words: &[&str]| Json::Array(words.iter().map(|word| Json::text(word)).collect());
    match kind {
        Kind::Flag => vec![(
            "enum".into(),
            Json::Array(vec![
                Json::True,
                Json::False,
                Json::Number(1.0),
                Json::Number(0.0),
                Json::text("1"),
                Json::text("0"),
                Json::text("true"),
                Json::text("false"),
            ]),
        )],
        Kind::Whole { least, most } => {
            std::iter::once(typed("integer")).chain(limits(*least as f64, *most as f64)).collect()
        }
        Kind::Number { least, most } => {
            std::iter::once(typed("number")).chain(limits(*least, *most)).collect()
        }
        Kind::Duration { .. } => {
            vec![typed("string"), ("pattern".into(), Json::text(&format!("^{DURATION}$")))]
        }
        Kind::Word(known) => vec![("enum".into(), words(known))],
        Kind::Name => vec![typed("string"), ("pattern".into(), Json::text(&format!("^{NAME}$")))],
        Kind::File => vec![typed("string"), ("minLength".into(), Json::Number(1.0))],
        Kind::List => vec![("type".into(), words(&["string", "array"]))],
        Kind::Text => vec![("type".into(), words(&["string", "number", "boolean"]))],
    }
}

fn spellings(key: &str) -> [String; 2] {
    [key.to_owned(), camel_case(key)]
}

/// Just enough of JSON to write a schema in the order of the grammar.
enum Json {
    True,
    False,
    Number(f64),
    Text(String),
    Array(Vec<Json>),
    Object(Vec<(String, Json)>),
}

impl Json {
    fn text(text: &str) -> Json {
        Json::Text(text.split_whitespace().collect::<Vec<_>>().join(" "))
    }

    fn write(&self, out: &mut String, depth: usize) {
        match self {
            Json::True => out.push_str("true"),
            Json::False => out.push_str("false"),
            Json::Number(number) => drop(write!(out, "{number}")),
            Json::Text(text) => quoted(out, text),
            Json::Array(values) => {
                out.push('[');
                for (index, value) in values.iter().enumerate() {
                    out.push_str(if index == 0 { "" } else { ", " });
                    value.write(out, depth);
                }
                out.push(']');
            }
            Json::Object(entries) => {
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
