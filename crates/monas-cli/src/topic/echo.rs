//! `monas topic echo`: messages as they are published.

use std::time::Duration;

use monas_link::control::Watching;
use monas_link::control::messages::Seen;
use serde_json::{Value, json};

use super::arguments::{Limits, RunChoice};
use super::connect::{self, failure};
use super::list::seconds;
use super::schemas::Schemas;
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::run::{Interrupt, WallClock};

/// How long it is waited at most before the limits are looked at.
const LOOK: Duration = Duration::from_millis(20);

pub(super) fn execute(
    pattern: &str,
    limits: &Limits,
    choice: &RunChoice,
    console: &mut Console<'_>,
) -> Result<Exit, Failure> {
    let format = choice.format.value;
    let socket = connect::socket(choice)?;
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
                    "{} messages were gone before they could be fetched",
                    seen.lost - lost
                )?;
            }
            lost = seen.lost;
        }
        Ok(true)
    })?;
    Ok(end)
}

/// Hands over what is published, and nothing now and then, until a limit is reached, somebody interrupts, or whoever takes it has enough.
pub(crate) fn watch(
    pattern: &str,
    payload: bool,
    limits: &Limits,
    choice: &RunChoice,
    console: &mut Console<'_>,
    mut take: impl FnMut(Option<Seen>, &mut Console<'_>) -> Result<bool, Failure>,
) -> Result<Exit, Failure> {
    let format = choice.format.value;
    let host = choice.host.as_deref().unwrap_or_default();
    let client = connect::client(choice)?;
    let mut watching: Watching = client.watch(host, pattern, payload).map_err(failure(format))?;
    let interrupt = Interrupt::for_console(console).map_err(|error| Failure::failed(format, error))?;
    let clock = WallClock::start();
    let mut count = 0;
    while !interrupt.is_requested() {
        let left = limits.length.map(|length| length.saturating_sub(clock.elapsed()));
        if left == Some(Duration::ZERO) || limits.count == Some(count) {
            break;
        }
        let seen = watching.wait(left.unwrap_or(LOOK).min(LOOK)).map_err(failure(format))?;
        count += u64::from(seen.is_some());
        if !take(seen, console)? {
            break;
        }
    }
    // Whoever looks until they have seen enough ends by interrupting; that is no failure.
    Ok(Exit::Success)
}

fn write(seen: &Seen, message: Value, format: Format, console: &mut Console<'_>) -> Result<(), Failure> {
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
                place(seen)
            )?;
        }
    }
    console.out.flush()?;
    Ok(())
}

/// The host, and the other one from which a message came.
pub(super) fn place(seen: &Seen) -> String {
    match seen.from == seen.host {
        true => seen.host.clone(),
        false => format!("{} from {}", seen.host, seen.from),
    }
}
