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
    message.fields.iter().for_each(|field| types(text, depth + 1, field));
    for (number, field) in (1..).zip(&message.fields) {
        member(text, depth + 1, field, number);
    }
    line(text, depth, "}");
}

/// The nested types that a field requires.
fn types(text: &mut String, depth: usize, field: &OntologyField) {
    match &field.kind {
        OntologyFieldKind::OneOf(values) => {
            line(text, depth, &format!("// The values of `{}`.", field.name));
            line(text, depth, &format!("enum {} {{", camel(&field.name)));
            for (number, value) in values.iter().enumerate() {
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

fn member(text: &mut String, depth: usize, field: &OntologyField, number: usize) {
    let kind = match &field.kind {
        OntologyFieldKind::Unknown => {
            line(text, depth, "// The type is unknown.");
            "double".to_owned()
        }
        OntologyFieldKind::Condition => "bool".to_owned(),
        OntologyFieldKind::Number => "double".to_owned(),
        OntologyFieldKind::Text => "string".to_owned(),
        OntologyFieldKind::OneOf(_) | OntologyFieldKind::Fields(_) => camel(&field.name),
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
