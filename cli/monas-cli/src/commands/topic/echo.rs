//! `monas topic echo`: prints messages as they are published.

use monas_link::control::messages::Seen;
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, seconds};
use serde_json::{Value, json};

use super::schemas::Schemas;
use crate::remote::{RunSelector, WatchLimits, connection, watch};

pub(crate) fn execute(
    pattern: &str,
    limits: &WatchLimits,
    choice: &RunSelector,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = choice.format.value;
    let socket = connection::socket(choice)?;
    let mut schemas = Schemas::new(socket, format);
    let mut lost = 0;
    let end = watch(pattern, true, limits, choice, console, |seen, console| {
        if let Some(seen) = seen {
            let message = match seen.payload.len() as u64 == seen.size {
                true => schemas.decode(&seen.path, &seen.payload)?,
                false => Value::Null,
            };
            write(&seen, message, format, console)?;
            if seen.lost > lost && format == Format::Text {
                writeln!(
                    console.err,
                    "{} messages were overwritten before they were fetched",
                    seen.lost - lost
                )?;
            }
            lost = seen.lost;
        }
        Ok(true)
    })?;
    Ok(end)
}

fn write(
    seen: &Seen,
    message: Value,
    format: Format,
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    match format {
        Format::Json => {
            let object = json!({"host": seen.host, "from": seen.from, "topic": seen.path, "publisher": seen.publisher,
                "sequence": seen.sequence, "seconds": seconds(seen.local), "size": seen.size, "lost": seen.lost,
                "message": message});
            writeln!(console.out, "{object}")?;
        }
        Format::Text => {
            let Seen { path, publisher, sequence, size, .. } = seen;
            let at = seconds(seen.local);
            let message = if message.is_null() { format!("({size} bytes)") } else { message.to_string() };
            writeln!(
                console.out,
                "{at:.3} s {} {path} by {publisher}, number {sequence}: {message}",
                hosts(seen)
            )?;
        }
    }
    console.out.flush()?;
    Ok(())
}

/// The host, and the host that a message came from.
pub(crate) fn hosts(seen: &Seen) -> String {
    match seen.from == seen.host {
        true => seen.host.clone(),
        false => format!("{} from {}", seen.host, seen.from),
    }
}
