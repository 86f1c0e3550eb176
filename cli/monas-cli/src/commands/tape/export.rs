//! `monas tape export`: messages as a table or as JSON.

use std::collections::BTreeMap;
use std::io::{BufWriter, Write};

use monas_files::AtomicFile;
use monas_tape::{Decoder, RecordedSample, Recording, Value};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, check_distinct, failed, output_file};
use serde_json::json;

use super::arguments::{ExportArguments, ExportFormat};
use super::value_text;

/// The columns before those of the message's fields.
const FIRST_COLUMNS: [&str; 5] = ["seconds", "host", "publisher", "topic", "sequence"];

pub(crate) fn execute(
    arguments: &ExportArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let recording = Recording::open(&arguments.file).map_err(failed(Format::Text))?;
    arguments.selection.check(&recording.overview().map_err(failed(Format::Text))?)?;
    match output_file(arguments.output.as_deref()) {
        None => write(arguments, &recording, &mut BufWriter::new(&mut *console.out))?,
        Some(path) => {
            check_distinct(&arguments.file, path, "tape")?;
            let cannot = |error| {
                CommandFailure::Failed(Format::Text, format!("cannot write {}: {error}", path.display()))
            };
            let mut file = AtomicFile::create(path).map_err(cannot)?;
            write(arguments, &recording, &mut file).map_err(|failure| match failure {
                CommandFailure::Output(error) => cannot(error),
                other => other,
            })?;
            file.commit().map_err(cannot)?;
        }
    }
    Ok(Exit::Success)
}

fn write(
    arguments: &ExportArguments,
    recording: &Recording,
    out: &mut dyn Write,
) -> Result<(), CommandFailure> {
    match arguments.format {
        ExportFormat::Jsonl => write_objects(arguments, recording, out),
        ExportFormat::Csv => write_table(arguments, recording, out),
    }?;
    Ok(out.flush()?)
}

/// Calls `act` with each selected message.
fn each(
    arguments: &ExportArguments,
    recording: &Recording,
    mut act: impl FnMut(&RecordedSample<'_>, &Value) -> Result<(), CommandFailure>,
) -> Result<(), CommandFailure> {
    let (selection, mut decoder) = (&arguments.selection, Decoder::new());
    for message in recording.messages().map_err(failed(Format::Text))? {
        let message = message.map_err(failed(Format::Text))?;
        if selection.wants(&message.channel) && selection.is_within(&message) {
            let value = decoder.decode(&message.channel, message.bytes).map_err(failed(Format::Text))?;
            act(&message, &value)?;
        }
    }
    Ok(())
}

fn write_objects(
    arguments: &ExportArguments,
    recording: &Recording,
    out: &mut dyn Write,
) -> Result<(), CommandFailure> {
    each(arguments, recording, |message, value| {
        let channel = &message.channel;
        let object = json!({
            "seconds": message.published.as_secs_f64(),
            "host": channel.host,
            "publisher": channel.publisher,
            "topic": channel.topic,
            "sequence": message.sequence,
            "type": channel.message_type(),
            "message": value_text::json(value),
        });
        Ok(writeln!(out, "{object}")?)
    })
}

fn write_table(
    arguments: &ExportArguments,
    recording: &Recording,
    out: &mut dyn Write,
) -> Result<(), CommandFailure> {
    let columns = Columns::of(arguments, recording)?;
    let header = FIRST_COLUMNS.iter().map(|name| (*name).to_owned()).chain(columns.names.iter().cloned());
    write_row(out, header)?;
    each(arguments, recording, |message, value| {
        let channel = &message.channel;
        let mut row = vec![String::new(); columns.names.len()];
        value_text::cells(value, &mut |path, value| {
            let index = columns.indices.get(&(channel.message_type().to_owned(), path.to_owned()));
            if let Some(&position) = index {
                row[position] = value_text::plain(value);
            }
        });
        let seconds = message.published.as_secs_f64().to_string();
        let names = [&channel.host, &channel.publisher, &channel.topic].map(Clone::clone);
        let head = std::iter::once(seconds).chain(names).chain([message.sequence.to_string()]);
        write_row(out, head.chain(row))
    })
}

fn write_row(out: &mut dyn Write, cells: impl Iterator<Item = String>) -> Result<(), CommandFailure> {
    let cells: Vec<String> = cells.map(|cell| value_text::quoted(&cell)).collect();
    Ok(writeln!(out, "{}", cells.join(","))?)
}

/// One column for each field of each message type that occurs.
struct Columns {
    names: Vec<String>,
    /// By type and path.
    indices: BTreeMap<(String, String), usize>,
}

impl Columns {
    /// Ordered by type and field. With several types, the type is a prefix of the field.
    fn of(arguments: &ExportArguments, recording: &Recording) -> Result<Columns, CommandFailure> {
        let mut types: BTreeMap<String, Vec<String>> = BTreeMap::new();
        each(arguments, recording, |message, value| {
            let paths = types.entry(message.channel.message_type().to_owned()).or_default();
            let mut after = 0;
            value_text::cells(value, &mut |path, value| match paths.iter().position(|known| known == path) {
                Some(index) => after = index + 1,
                // An unset message has no fields and therefore no columns.
                None if *value == Value::NoMessage => {}
                None => {
                    paths.insert(after, path.to_owned());
                    after += 1;
                }
            });
            Ok(())
        })?;
        let is_single = types.len() <= 1;
        let mut columns = Columns { names: Vec::new(), indices: BTreeMap::new() };
        for (name, paths) in types {
            for path in paths {
                let short = name.rsplit('.').next().unwrap_or(&name);
                columns.names.push(if is_single { path.clone() } else { format!("{short}.{path}") });
                columns.indices.insert((name.clone(), path), columns.names.len() - 1);
            }
        }
        Ok(columns)
    }
}
