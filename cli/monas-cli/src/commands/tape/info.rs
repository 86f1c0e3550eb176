//! `monas tape info`: the content of a tape.

use std::io::Write;
use std::path::Path;

use monas::Timestamp;
use monas_tape::{ChannelOverview, Recording, TapeOverview};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, counted, failed, grouped, size, table};
use serde_json::{Value, json};

pub(crate) fn execute(
    file: &Path,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let recording = Recording::open(file).map_err(failed(format))?;
    let overview = recording.overview().map_err(failed(format))?;
    match format {
        Format::Text => write_text(console.out, file, &overview)?,
        Format::Json => {
            objects(file, &overview).iter().try_for_each(|object| writeln!(console.out, "{object}"))?
        }
    }
    Ok(Exit::Success)
}

fn write_text(out: &mut dyn Write, file: &Path, overview: &TapeOverview) -> Result<(), CommandFailure> {
    let what = format!("{}, {}", size(overview.bytes as u64), counted(overview.messages(), "message"));
    writeln!(out, "{}: {what}, {}", file.display(), state(overview))?;
    if let Some((first, last)) = overview.span {
        let length = last.since(first).as_secs_f64();
        writeln!(out, "{length:.3} s, from {:.3} s to {:.3} s", seconds(first), seconds(last))?;
    }
    for damage in &overview.damages {
        writeln!(out, "{damage}")?;
    }
    for facts in &overview.facts {
        writeln!(out, "\n{}", facts.name)?;
        let width = facts.entries.keys().map(String::len).max().unwrap_or_default();
        for (key, value) in &facts.entries {
            writeln!(out, "  {:width$}  {value}", key.replace('_', " "))?;
        }
    }
    if !overview.attachments.is_empty() {
        writeln!(out, "\nfiles")?;
        let width = overview.attachments.iter().map(|(name, ..)| name.len()).max().unwrap_or_default();
        for (name, _, bytes) in &overview.attachments {
            writeln!(out, "  {name:width$}  {}", size(*bytes as u64))?;
        }
    }
    if !overview.channels.is_empty() {
        writeln!(out, "\n{}", channels(&overview.channels))?;
    }
    Ok(())
}

fn state(overview: &TapeOverview) -> &'static str {
    match (overview.is_finished, overview.damages.is_empty()) {
        (true, true) => "finished",
        (true, false) => "damaged: `monas tape recover` keeps what can be read",
        (false, _) => "truncated: `monas tape recover` repairs it",
    }
}

fn seconds(moment: Timestamp) -> f64 {
    moment.as_secs_f64()
}

fn channels(channels: &[ChannelOverview]) -> table::Table {
    let header = ["host", "topic", "kept as", "type", "published by", "messages", "Hz", "size"];
    let row = |one: &ChannelOverview| {
        let channel = &one.channel;
        let host = match &channel.received_by {
            Some(receiver) => format!("{} to {receiver}", channel.host),
            None => channel.host.clone(),
        };
        let frequency = one.frequency().map_or_else(|| "-".into(), |hertz| format!("{hertz:.1}"));
        let publisher = match channel.part {
            0 => channel.publisher.clone(),
            part => format!("{} #{}", channel.publisher, part + 1),
        };
        let names = [&*channel.topic, &*channel.kind, channel.message_type(), &publisher];
        let names = names.map(str::to_owned);
        let figures = [grouped(one.messages), frequency, size(one.bytes)];
        std::iter::once(host).chain(names).chain(figures)
    };
    table::of_numbers(header, 5, channels.iter().map(row))
}

/// One object for the tape, and one for each metadata entry, attachment and channel.
fn objects(file: &Path, overview: &TapeOverview) -> Vec<Value> {
    let tape = json!({
        "kind": "tape",
        "file": file.display().to_string(),
        "bytes": overview.bytes,
        "finished": overview.is_finished,
        "damages": overview.damages,
        "messages": overview.messages(),
        "first_seconds": overview.span.map(|(first, _)| seconds(first)),
        "last_seconds": overview.span.map(|(_, last)| seconds(last)),
    });
    let facts = overview
        .facts
        .iter()
        .map(|facts| json!({"kind": "facts", "name": facts.name, "entries": facts.entries}));
    let files = overview.attachments.iter().map(|(name, media_type, bytes)| {
        json!({"kind": "file", "name": name, "media_type": media_type, "bytes": bytes})
    });
    let channels = overview.channels.iter().map(channel_object);
    std::iter::once(tape).chain(facts).chain(files).chain(channels).collect()
}

fn channel_object(one: &ChannelOverview) -> Value {
    let channel = &one.channel;
    json!({
        "kind": "channel",
        "host": channel.host,
        "received_by": channel.received_by,
        "topic": channel.topic,
        "kept_as": channel.kind,
        "type": channel.message_type(),
        "publisher": channel.publisher,
        "part": channel.part,
        "messages": one.messages,
        "bytes": one.bytes,
        "hertz": one.frequency(),
        "first_seconds": seconds(one.span.0),
        "last_seconds": seconds(one.span.1),
    })
}
