//! `monas tape recover`, `cut` and `merge`.

use std::path::{Path, PathBuf};

use monas_tape::{Channel, MetadataEntry, Recording, TapeFilter};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, check_distinct, counted, failed};
use serde_json::json;

use super::arguments::CutArguments;

pub(crate) fn recover(
    file: &Path,
    output: Option<&Path>,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
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
        true => writeln!(console.out, "{target}: {messages}, already complete")?,
        false => writeln!(console.out, "{target}: recovered, {messages}")?,
    }
    Ok(Exit::Success)
}

pub(crate) fn cut(arguments: &CutArguments, console: &mut CommandOutput<'_>) -> Result<Exit, CommandFailure> {
    let CutArguments { file, output, selection, format } = arguments;
    let format = format.value;
    check_distinct(file, output, "tape")?;
    let recording = Recording::open(file).map_err(failed(format))?;
    selection.check(&recording.overview().map_err(failed(format))?)?;
    let (from, to) = selection.span();
    let wanted = |channel: &Channel| selection.wants(channel);
    // A chart's trace refers to the names in its model, so those messages are always kept.
    let names = |channel: &Channel| channel.topic == monas::records::MODEL.path();
    // The entry with the run's end is dropped if the end is cut off.
    let facts = |facts: &MetadataEntry| to.is_none() || facts.name != monas_recording::END;
    let cut = TapeFilter { from, to, channels: Some(&wanted), always: Some(&names), facts: Some(&facts) };
    let messages = monas_tape::cut(&recording, &cut, output).map_err(failed(format))?;
    written(output, messages, format, console)
}

pub(crate) fn merge(
    files: &[PathBuf],
    output: &Path,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    files.iter().try_for_each(|file| check_distinct(file, output, "tape"))?;
    let recordings: Result<Vec<Recording>, _> = files.iter().map(Recording::open).collect();
    let messages = monas_tape::merge(&recordings.map_err(failed(format))?, output).map_err(failed(format))?;
    written(output, messages, format, console)
}

fn written(
    file: &Path,
    messages: u64,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
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
