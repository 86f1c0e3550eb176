//! Writer of a `.proto` file.

use std::fmt::Write;

use super::{Ontology, OntologyField, OntologyFieldKind, OntologyMessage};

impl Ontology {
    /// The messages as a `.proto` file of a package (`proto3`). Fields of unknown type get a
    /// comment.
    pub fn to_proto(&self, package: &str) -> String {
        let mut text = format!(
            "// The messages of statecharts: derived from expressions, to be completed by hand.\nsyntax = \"proto3\";\n\npackage {package};\n"
        );
        for message in &self.messages {
            text.push('\n');
            for topic in &message.topics {
                line(&mut text, 0, &format!("// On `{}`, kept as `{}`.", topic.name, topic.kind));
            }
            block(&mut text, 0, message);
        }
        text
    }
}

fn block(text: &mut String, depth: usize, message: &OntologyMessage) {
    if message.fields.is_empty() {
        line(text, depth, "// No field is used.");
        line(text, depth, &format!("message {} {{}}", message.name));
        return;
    }
    line(text, depth, &format!("message {} {{", message.name));
    let enumerations = enumerations(&message.fields);
    message.fields.iter().for_each(|field| types(text, depth + 1, field, &enumerations));
    for (number, field) in (1..).zip(&message.fields) {
        member(text, depth + 1, field, number, &enumerations);
    }
    line(text, depth, "}");
}

/// An enumeration of a message.
struct Enumeration<'a> {
    /// The fields of this type; it is called after the first.
    fields: Vec<&'a str>,
    values: Vec<&'a str>,
}

impl Enumeration<'_> {
    fn name(&self) -> String {
        camel(self.fields.first().copied().unwrap_or_default())
    }
}

/// The enumerations of a message. In protobuf the names of values belong to the message around the
/// enumeration, so fields that have a value in common have one enumeration.
fn enumerations(fields: &[OntologyField]) -> Vec<Enumeration<'_>> {
    let mut found: Vec<Enumeration<'_>> = Vec::new();
    for field in fields {
        let OntologyFieldKind::OneOf(values) = &field.kind else { continue };
        let has_one =
            |it: &Enumeration<'_>| it.values.iter().any(|value| values.iter().any(|own| own == value));
        let (mut shared, others): (Vec<_>, Vec<_>) = found.into_iter().partition(has_one);
        shared.push(Enumeration {
            fields: vec![field.name.as_str()],
            values: values.iter().map(String::as_str).collect(),
        });
        let mut joined = Enumeration { fields: Vec::new(), values: Vec::new() };
        for enumeration in shared {
            joined.fields.extend(enumeration.fields);
            let new = enumeration.values.into_iter().filter(|value| !joined.values.contains(value));
            let new: Vec<&str> = new.collect();
            joined.values.extend(new);
        }
        found = others;
        found.push(joined);
    }
    found
}

/// The nested types that a field requires. An enumeration is written at its first field.
fn types(text: &mut String, depth: usize, field: &OntologyField, enumerations: &[Enumeration<'_>]) {
    match &field.kind {
        OntologyFieldKind::OneOf(_) => {
            let is_first = |it: &&Enumeration<'_>| it.fields.first() == Some(&field.name.as_str());
            let Some(enumeration) = enumerations.iter().find(is_first) else { return };
            let fields: Vec<String> = enumeration.fields.iter().map(|name| format!("`{name}`")).collect();
            line(text, depth, &format!("// The values of {}.", fields.join(" and ")));
            line(text, depth, &format!("enum {} {{", enumeration.name()));
            for (number, value) in enumeration.values.iter().enumerate() {
                line(text, depth + 1, &format!("{value} = {number};"));
            }
            line(text, depth, "}");
        }
        OntologyFieldKind::Fields(fields) => {
            let inner =
                OntologyMessage { name: camel(&field.name), topics: Vec::new(), fields: fields.clone() };
            block(text, depth, &inner);
        }
        OntologyFieldKind::Unknown
        | OntologyFieldKind::Condition
        | OntologyFieldKind::Number
        | OntologyFieldKind::Text => {}
    }
}

fn member(
    text: &mut String,
    depth: usize,
    field: &OntologyField,
    number: usize,
    enumerations: &[Enumeration<'_>],
) {
    let kind = match &field.kind {
        OntologyFieldKind::Unknown => {
            line(text, depth, "// The type is unknown.");
            "double".to_owned()
        }
        OntologyFieldKind::Condition => "bool".to_owned(),
        OntologyFieldKind::Number => "double".to_owned(),
        OntologyFieldKind::Text => "string".to_owned(),
        OntologyFieldKind::OneOf(_) => {
            let is_own = |it: &&Enumeration<'_>| it.fields.contains(&field.name.as_str());
            enumerations.iter().find(is_own).map_or_else(|| camel(&field.name), Enumeration::name)
        }
        OntologyFieldKind::Fields(_) => camel(&field.name),
    };
    line(text, depth, &format!("{kind} {} = {number};", field.name));
}

fn line(text: &mut String, depth: usize, content: &str) {
    // writing into a text never fails
    _ = writeln!(text, "{:indent$}{content}", "", indent = depth * 2);
}

/// `UpperCamelCase`: `player_state` becomes `PlayerState`.
fn camel(name: &str) -> String {
    let capital = |word: &str| {
        let mut letters = word.chars();
        letters
            .next()
            .map_or_else(String::new, |first| first.to_ascii_uppercase().to_string() + letters.as_str())
    };
    name.split('_').map(capital).collect()
}
