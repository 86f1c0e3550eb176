//! `monas tape replay`: replays agents on recorded messages.

mod names;
mod report;

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use monas::Timestamp;
use monas::replay::{
    ComparisonCounts, RecordedMessage, RecordedStream, Replay, ReplayChannel, ReplayDifference,
};
use monas_tape::{Channel, RecordedSample, Recording, TapeOverview};
use monas_terminal::{CommandFailure, CommandOutput, Exit, Format, WallClock, failed};

use super::arguments::ReplayArguments;
#[cfg(unix)]
use crate::commands::studio;
use crate::input::{self, chosen_hosts, end_of, run_of};

/// The result of a replay.
struct ReplayOutcome {
    /// The earliest difference.
    first: Option<ReplayDifference>,
    tallies: Vec<ComparisonCounts>,
    /// The length of the replayed part of the run.
    length: Duration,
    /// Wall-clock time of the replay.
    took: Duration,
}

impl ReplayOutcome {
    fn compared(&self) -> u64 {
        self.tallies.iter().map(|tally| tally.compared).sum()
    }

    fn differences(&self) -> u64 {
        self.tallies.iter().map(ComparisonCounts::differences).sum()
    }
}

pub(crate) fn execute(
    arguments: &ReplayArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    #[cfg(unix)]
    if arguments.listen.is_given() && !arguments.studio {
        return Err(CommandFailure::Usage("--listen is for the studio: add --studio".into()));
    }
    #[cfg(unix)]
    arguments.listen.require_no_control()?;
    let recording = Recording::open(&arguments.file).map_err(failed(format))?;
    let overview = recording.overview().map_err(failed(format))?;
    let run =
        run_of(&arguments.file, &overview).map_err(|message| CommandFailure::Failed(format, message))?;
    run.warn(console.err)?;
    let hosts = chosen_hosts(&recording, &run, arguments.config.as_deref(), &arguments.agents, format)?;
    let replay =
        input::replay(hosts, &run, &overview).map_err(|error| CommandFailure::failed(format, error))?;
    let mut marks = DifferenceMarks::default();
    let outcome = play(&recording, &overview, replay, &mut marks, format)?;
    report::write(console.out, format, &recording, &overview, &outcome)?;
    if outcome.compared() + outcome.differences() == 0 {
        return Err(CommandFailure::Failed(
            format,
            "nothing was compared: the agents have published nothing".into(),
        ));
    }
    #[cfg(unix)]
    if arguments.studio {
        studio::view_replay(&arguments.file, marks.events(), &arguments.listen, format, console)?;
    }
    Ok(if arguments.verify && outcome.differences() > 0 { Exit::Diverged } else { Exit::Success })
}

/// The differences that the timeline of the studio marks: the first of each agent and topic in each
/// second.
#[derive(Default)]
struct DifferenceMarks {
    by_second: BTreeMap<(u64, String, String, String), Timestamp>,
}

impl DifferenceMarks {
    /// The most marks of a timeline.
    const MAX_MARKS: usize = 5_000;

    fn note(&mut self, difference: &ReplayDifference) {
        let ReplayDifference { host, agent, topic, time, .. } = difference;
        let second = time.as_nanos() / 1_000_000_000;
        let key = (second, host.clone(), agent.clone(), topic.clone());
        if self.by_second.len() < DifferenceMarks::MAX_MARKS || self.by_second.contains_key(&key) {
            let first = self.by_second.entry(key).or_insert(*time);
            *first = (*first).min(*time);
        }
    }

    #[cfg(unix)]
    fn events(self) -> Vec<(Timestamp, monas_studio::SceneEvent)> {
        let event = |((_, host, agent, topic), time)| {
            let text = format!("the replay of {host}/{agent} differs on {topic}");
            (time, monas_studio::SceneEvent { kind: "difference".into(), text, lasts: false })
        };
        self.by_second.into_iter().map(event).collect()
    }
}

/// Feeds the recording to the replay.
fn play(
    recording: &Recording,
    overview: &TapeOverview,
    mut replay: Replay,
    marks: &mut DifferenceMarks,
    format: Format,
) -> Result<ReplayOutcome, CommandFailure> {
    let clock = WallClock::start();
    let mut first: Option<ReplayDifference> = None;
    let mut report_difference = |difference: ReplayDifference| {
        marks.note(&difference);
        if first.as_ref().is_none_or(|first| difference.time < first.time) {
            first = Some(difference);
        }
    };
    let mut inputs = ReplayInputs::default();
    let end = end_of(overview);
    let mut has_ended = false;
    for message in recording.messages().map_err(failed(format))? {
        let message = message.map_err(failed(format))?;
        // Messages recorded at the end or later were published while agents were being stopped.
        if let Some(end) = end.filter(|end| !has_ended && message.received >= *end) {
            replay.end(end, &mut report_difference);
            has_ended = true;
        }
        inputs
            .feed(&message, &mut replay, &mut report_difference)
            .map_err(|error| CommandFailure::failed(format, error))?;
    }
    if let Some(end) = end.filter(|_| !has_ended) {
        replay.end(end, &mut report_difference);
    }
    let tallies = replay
        .finish(end.is_some(), &mut report_difference)
        .map_err(|error| CommandFailure::failed(format, error))?;
    let length = end.or(overview.span.map(|(_, last)| last)).unwrap_or_default().since(Timestamp::ZERO);
    Ok(ReplayOutcome { first, tallies, length, took: clock.elapsed() })
}

/// The input of each channel, by the channel's address. The channel is kept, so that its address is
/// not reused.
#[derive(Default)]
struct ReplayInputs {
    known: BTreeMap<*const Channel, (Arc<Channel>, ReplayChannel)>,
}

impl ReplayInputs {
    fn feed(
        &mut self,
        message: &RecordedSample<'_>,
        replay: &mut Replay,
        report: &mut dyn FnMut(ReplayDifference),
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
        let RecordedSample { sequence, published, received, bytes, .. } = *message;
        replay.feed(input, RecordedMessage { sequence, published, received, bytes }, report)
    }
}

fn recorded(channel: &Channel) -> RecordedStream<'_> {
    RecordedStream {
        host: &channel.host,
        received_by: channel.received_by.as_deref(),
        publisher: &channel.publisher,
        part: channel.part,
        topic: &channel.topic,
    }
}
