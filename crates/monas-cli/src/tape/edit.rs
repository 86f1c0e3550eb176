//! `monas tape recover`, `cut` and `merge`: tapes made of tapes.

use std::path::{Path, PathBuf};

use monas_tape::{Channel, Cut, Facts, Recording};
use serde_json::json;

use super::arguments::CutArguments;
use super::{counted, failed};
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;

pub(super) fn recover(
    file: &Path,
    output: Option<&Path>,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let target = output.unwrap_or(file);
    let recovery = monas_tape::recover(file, target).map_err(failed(format))?;
    let (messages, whole) = (recovery.messages, recovery.was_whole());
    if format == Format::Json {
        let object = json!({"kind": "recovery", "file": target.display().to_string(), "messages": messages,
            "was_finished": recovery.was_finished, "damages": recovery.damages, "was_whole": whole});
        writeln!(console.out, "{object}")?;
        return Ok(Exit::Success);
    }
    for damage in &recovery.damages {
        writeln!(console.err, "lost: {damage}")?;
    }
    let target = target.display();
    let messages = counted(messages, "message");
    match whole {
        true => writeln!(console.out, "{target}: {messages}, nothing was to mend")?,
        false => writeln!(console.out, "{target}: mended, {messages}")?,
    }
    Ok(Exit::Success)
}

pub(super) fn cut(arguments: &CutArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let CutArguments { file, output, selection, format } = arguments;
    let format = format.value;
    let recording = Recording::open(file).map_err(failed(format))?;
    selection.check(&recording.overview().map_err(failed(format))?)?;
    let (from, to) = selection.span();
    let wanted = |channel: &Channel| selection.wants(channel);
    // Without the names in a chart its trace says nothing.
    let names = |channel: &Channel| channel.topic == monas::records::MODEL.path();
    // Where its end is missing, nothing says when the run ended.
    let facts = |facts: &Facts| to.is_none() || facts.name != monas_match::END;
    let cut = Cut { from, to, channels: Some(&wanted), always: Some(&names), facts: Some(&facts) };
    let messages = monas_tape::cut(&recording, &cut, output).map_err(failed(format))?;
    written(output, messages, format, console)
}

pub(super) fn merge(
    files: &[PathBuf],
    output: &Path,
    format: Format,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let recordings: Result<Vec<Recording>, _> = files.iter().map(Recording::open).collect();
    let messages = monas_tape::merge(&recordings.map_err(failed(format))?, output).map_err(failed(format))?;
    written(output, messages, format, console)
}

fn written(file: &Path, messages: u64, format: Format, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let file = file.display();
    match format {
        Format::Text => writeln!(console.out, "{file}: {}", counted(messages, "message"))?,
        Format::Json => {
            let object = json!({"kind": "tape", "file": file.to_string(), "messages": messages});
            writeln!(console.out, "{object}")?;
        }
    }
    Ok(Exit::Success)
}
