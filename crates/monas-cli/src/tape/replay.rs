//! `monas tape replay`: agents run again on what was recorded.

mod cast;
mod names;
mod report;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use monas::Moment;
use monas::replay::{Difference, Input, Recorded, RecordedMessage, Replay, Tally};
use monas_tape::{Channel, Message, Overview, Recording};

use super::arguments::ReplayArguments;
use super::failed;
use crate::arguments::Format;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::run::pace::WallClock;
pub(crate) use cast::recorded_hosts;

/// What a replay came to.
struct Outcome {
    /// The earliest difference.
    first: Option<Difference>,
    tallies: Vec<Tally>,
    /// How much of the run was replayed.
    length: Duration,
    /// How long that took.
    took: Duration,
}

impl Outcome {
    fn compared(&self) -> u64 {
        self.tallies.iter().map(|tally| tally.compared).sum()
    }

    fn differences(&self) -> u64 {
        self.tallies.iter().map(Tally::differences).sum()
    }
}

pub(super) fn execute(arguments: &ReplayArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let recording = Recording::open(&arguments.file).map_err(failed(format))?;
    let overview = recording.overview().map_err(failed(format))?;
    let run = cast::run_of(&overview).map_err(|message| Failure::Failed(format, message))?;
    run.warn(console.err)?;
    let hosts = cast::hosts(arguments, &recording, &run)?;
    let replay = cast::replay(hosts, &run, &overview).map_err(|error| Failure::failed(format, error))?;
    let outcome = play(&recording, &overview, replay, format)?;
    report::write(console.out, format, &recording, &overview, &outcome)?;
    if outcome.compared() + outcome.differences() == 0 {
        return Err(Failure::Failed(
            format,
            "nothing was compared: the agents have published nothing".into(),
        ));
    }
    Ok(if arguments.verify && outcome.differences() > 0 { Exit::Diverged } else { Exit::Success })
}

/// Goes through the recording.
fn play(
    recording: &Recording,
    overview: &Overview,
    mut replay: Replay,
    format: Format,
) -> Result<Outcome, Failure> {
    let clock = WallClock::start();
    let mut first: Option<Difference> = None;
    let mut told = |difference: Difference| {
        if first.as_ref().is_none_or(|first| difference.time < first.time) {
            first = Some(difference);
        }
    };
    let mut inputs = Inputs::default();
    let end = end_of(overview);
    let mut has_ended = false;
    for message in recording.messages().map_err(failed(format))? {
        let message = message.map_err(failed(format))?;
        // What is recorded at the end and later was published while agents were being stopped.
        if let Some(end) = end.filter(|end| !has_ended && message.received >= *end) {
            replay.end(end, &mut told);
            has_ended = true;
        }
        inputs.feed(&message, &mut replay, &mut told).map_err(|error| Failure::failed(format, error))?;
    }
    if let Some(end) = end.filter(|_| !has_ended) {
        replay.end(end, &mut told);
    }
    let tallies = replay.finish(end.is_some(), &mut told).map_err(|error| Failure::failed(format, error))?;
    let length = end.or(overview.span.map(|(_, last)| last)).unwrap_or_default().since(Moment::ZERO);
    Ok(Outcome { first, tallies, length, took: clock.elapsed() })
}

/// When the run ended, if the tape has its end.
fn end_of(overview: &Overview) -> Option<Moment> {
    let facts = overview.facts.iter().find(|facts| facts.name == monas_match::END)?;
    facts.entries.get("nanoseconds")?.parse().ok().map(Moment::from_nanos)
}

/// Where the messages of each channel go in, by the address of what they share; it is kept, so that the address stays its own.
#[derive(Default)]
struct Inputs {
    known: BTreeMap<*const Channel, (Arc<Channel>, Input)>,
}

impl Inputs {
    fn feed(
        &mut self,
        message: &Message<'_>,
        replay: &mut Replay,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), monas::Error> {
        let address = Arc::as_ptr(&message.channel);
        let input = match self.known.get(&address) {
            Some((_, input)) => *input,
            None => {
                let input = replay.input(recorded(&message.channel))?;
                self.known.insert(address, (message.channel.clone(), input));
                input
            }
        };
        let Message { sequence, published, received, bytes, .. } = *message;
        replay.feed(input, RecordedMessage { sequence, published, received, bytes }, told)
    }
}

fn recorded(channel: &Channel) -> Recorded<'_> {
    Recorded {
        host: &channel.host,
        received_by: channel.received_by.as_deref(),
        publisher: &channel.publisher,
        part: channel.part,
        topic: &channel.topic,
    }
}
