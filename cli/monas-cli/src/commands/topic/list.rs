//! `monas topic list` and `info`.

use monas_link::control::messages::TopicEntry;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, seconds, table};
use prost_reflect::{Cardinality, FieldDescriptor, MessageDescriptor};
use serde_json::{Value, json};

use super::schemas::Schemas;
use crate::remote::{RunSelector, connection, failure};

pub(crate) fn list(
    pattern: Option<&str>,
    choice: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let topics = entries(pattern.unwrap_or_default(), choice)?;
    match choice.format.value {
        Format::Json => topics.iter().try_for_each(|topic| writeln!(console.out, "{}", object(topic)))?,
        Format::Text => {
            let header = ["host", "topic", "keeps", "message", "by", "count", "at"];
            writeln!(console.out, "{}", table::of_numbers(header, 5, topics.iter().map(row)))?;
        }
    }
    Ok(Exit::Success)
}

fn entries(pattern: &str, choice: &RunSelector) -> Result<Vec<TopicEntry>, CommandFailure> {
    let host = choice.host.as_deref().unwrap_or_default();
    connection::client(choice)?.topics(host, pattern).map_err(failure(choice.format.value))
}

fn row(topic: &TopicEntry) -> [String; 7] {
    let last = topic.last.as_ref();
    let none = || "-".to_owned();
    let received = (!topic.from.is_empty()).then(|| format!("from {}", topic.from.join(", ")));
    let by: Vec<String> = last.map(|last| last.publisher.clone()).into_iter().chain(received).collect();
    [
        topic.host.clone(),
        topic.path.clone(),
        keeping(topic),
        topic.r#type.clone(),
        if by.is_empty() { none() } else { by.join(", ") },
        last.map_or_else(none, |last| last.sequence.to_string()),
        last.map_or_else(none, |last| format!("{:.3} s", seconds(last.published))),
    ]
}

fn keeping(topic: &TopicEntry) -> String {
    match topic.kind.as_str() {
        "data" => format!("data {}", topic.depth),
        kind => kind.to_owned(),
    }
}

fn object(topic: &TopicEntry) -> Value {
    let last = topic.last.as_ref().map(|last| {
        json!({"publisher": last.publisher, "sequence": last.sequence, "seconds": seconds(last.published)})
    });
    json!({"host": topic.host, "topic": topic.path, "keeps": topic.kind, "depth": topic.depth, "type": topic.r#type,
        "last": last, "from": topic.from})
}

pub(crate) fn info(
    topic: &str,
    choice: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = choice.format.value;
    let mut entries = entries(topic, choice)?;
    // A pattern may match several topics; each has its fields after its hosts.
    entries.sort_by(|one, other| one.path.cmp(&other.path));
    let mut schemas = Schemas::new(connection::socket(choice)?, format);
    for topic in entries.chunk_by(|one, other| one.path == other.path) {
        let Some(first) = topic.first() else { continue };
        let message = schemas.of(&first.path)?;
        match format {
            Format::Json => info_objects(topic, &message, console)?,
            Format::Text => describe(topic, &message, console)?,
        }
    }
    Ok(Exit::Success)
}

/// One object per host that has the topic.
fn info_objects(
    topic: &[TopicEntry],
    message: &MessageDescriptor,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    let fields: Vec<Value> = message.fields().map(|field| field_object(&field)).collect();
    for entry in topic {
        let mut object = object(entry);
        object["fields"] = fields.clone().into();
        writeln!(console.out, "{object}")?;
    }
    Ok(())
}

/// The topic on each host, and the fields of its messages.
fn describe(
    topic: &[TopicEntry],
    message: &MessageDescriptor,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    for entry in topic {
        writeln!(console.out, "{} on {}: {} of {}", entry.path, entry.host, keeping(entry), entry.r#type)?;
        match &entry.last {
            Some(last) => writeln!(
                console.out,
                "  last by {} at {:.3} s, sequence number {}",
                last.publisher,
                seconds(last.published),
                last.sequence
            )?,
            // Messages received over a link have no local publisher.
            None if entry.from.is_empty() => writeln!(console.out, "  nothing was published on it")?,
            None => {}
        }
        if !entry.from.is_empty() {
            writeln!(console.out, "  received from other hosts: {}", entry.from.join(", "))?;
        }
    }
    for field in message.fields() {
        writeln!(console.out, "  {} {}", type_name(&field), field.name())?;
    }
    Ok(())
}

fn field_object(field: &FieldDescriptor) -> Value {
    json!({"name": field.name(), "type": type_name(field), "number": field.number()})
}

/// The type of a field as in a `.proto` file.
fn type_name(field: &FieldDescriptor) -> String {
    match field.cardinality() {
        Cardinality::Repeated => format!("repeated {:?}", field.kind()),
        _ => format!("{:?}", field.kind()),
    }
}
