//! Executes agents again on recorded inputs and compares their publications with the recorded ones.
//!
//! A recording of simulated time is followed message by message, see [`simulated`]. One of real
//! time is followed turn by turn, see [`real_time`]: the interleaving of threads varies, but
//! records of cycles describe it.

mod comparison;
mod real_time;
mod recorded_changes;
mod recorded_inputs;
mod replay_host;
mod replayed_agents;
mod replayed_thread;
mod simulated;

use narukom::Timestamp;

pub use super::recorded_publisher::RecordedPublisher;
use super::run_config::RunConfig;
use monas_core::activity_context::SimulatedTimeGuard;
use monas_core::error::{Error, ErrorKind};

use real_time::RealTimeReplay;
use simulated::SimulatedReplay;

/// The common properties of the messages of one publisher on one topic.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RecordedStream<'a> {
    /// The host on which they were published.
    pub host: &'a str,
    /// The host that recorded them, if it received them from the other one.
    pub received_by: Option<&'a str>,
    /// The publisher.
    pub publisher: &'a str,
    /// The part of the publisher, see [`Header::part`](narukom::Header::part).
    pub part: u16,
    /// The path of the topic.
    pub topic: &'a str,
}

/// A recorded message of an [input](Replay::input).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RecordedMessage<'a> {
    /// Its number among its publisher's messages on the topic; the lower 32 bits.
    pub sequence: u32,
    /// The time of its publication.
    pub published: Timestamp,
    /// The time of its arrival at the recorded hub.
    pub received: Timestamp,
    /// Its protobuf encoding.
    pub bytes: &'a [u8],
}

/// A difference between a replayed and a recorded publication of an agent.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ReplayDifference {
    /// The agent's host.
    pub host: String,
    /// The agent.
    pub agent: String,
    /// The agent's cycle, counted from 1.
    pub cycle: u64,
    /// The time of the publication.
    pub time: Timestamp,
    /// The path of the topic.
    pub topic: String,
    /// The recorded message; `None` if there was none.
    pub recorded: Option<Vec<u8>>,
    /// The replayed message; `None` if there was none. If both are equal, their order differs.
    pub replayed: Option<Vec<u8>>,
}

/// The counts of the comparison for one agent and topic.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ComparisonCounts {
    /// The agent's host.
    pub host: String,
    /// The agent.
    pub agent: String,
    /// The path of the topic.
    pub topic: String,
    /// Messages that were published both times.
    pub compared: u64,
    /// Number of these that differ.
    pub different: u64,
    /// Messages that were published only in the recording.
    pub only_recorded: u64,
    /// Messages that were published only in the replay.
    pub only_replayed: u64,
}

impl ComparisonCounts {
    /// Number of all messages that differ or exist only once.
    pub fn differences(&self) -> u64 {
        self.different + self.only_recorded + self.only_replayed
    }
}

/// Identifies a source of recorded messages: see [`Replay::input`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ReplayChannel(usize);

/// A replay of agents on recorded inputs. Messages of other publishers are published again at their
/// recorded times; messages of the agents are compared, byte by byte, with the recorded ones.
///
/// In simulated time the agents form one run, in which they read each other's present messages. In
/// real time each agent repeats its own recorded turns at their recorded times with the recorded
/// deliveries: messages of the other agents, replayed or not, come from the recording.
///
/// Changes of agents are applied again: in simulated time at their request, in real time between
/// those turns of the agent between which it applied them. An agent that was removed and added
/// again returns as it did. Agents that were first added during the recording are not replayed: the
/// others receive their recorded messages. A list that was added while its agent ran begins at its
/// recorded time.
///
/// External inputs that are not messages, such as an event raised by hand, are not in a recording
/// and so not in a replay. The same holds for other inputs of an activity: a clock, a device or
/// another thread. They appear as differences.
pub struct Replay {
    mode: ReplayMode,
    /// The time of the most recent message.
    now: Timestamp,
}

/// The kind of recording that is followed.
enum ReplayMode {
    Simulated(SimulatedReplay),
    RealTime(RealTimeReplay),
}

impl Replay {
    /// A replay of a recording of simulated time.
    pub(crate) fn simulated(
        config: RunConfig,
        seed: u64,
        publishers: &[RecordedPublisher],
    ) -> Result<Replay, Error> {
        let replay = SimulatedReplay::new(config, seed, publishers)?;
        Ok(Replay { mode: ReplayMode::Simulated(replay), now: Timestamp::ZERO })
    }

    /// A replay of a recording of real time.
    pub(crate) fn real_time(config: RunConfig, publishers: &[RecordedPublisher]) -> Result<Replay, Error> {
        let replay = RealTimeReplay::new(config, publishers)?;
        Ok(Replay { mode: ReplayMode::RealTime(replay), now: Timestamp::ZERO })
    }

    /// Registers the messages of a publisher on a topic.
    ///
    /// # Errors
    /// A message of another host does not name its receiving host, or there are too many hosts.
    pub fn input(&mut self, recorded: RecordedStream<'_>) -> Result<ReplayChannel, Error> {
        let number = match &mut self.mode {
            ReplayMode::Simulated(replay) => replay.input(recorded),
            ReplayMode::RealTime(replay) => replay.input(recorded),
        };
        number.map(ReplayChannel)
    }

    /// Proceeds to the next recorded message. Calls `on_difference` with each difference that is
    /// definite by now.
    ///
    /// # Errors
    /// The bytes are not a message of the topic's type; or the recording of a run in real time
    /// lacks the inputs of its cycles.
    pub fn feed(
        &mut self,
        input: ReplayChannel,
        message: RecordedMessage<'_>,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<(), Error> {
        self.now = message.received;
        let _time = SimulatedTimeGuard::begin(self.now);
        match &mut self.mode {
            ReplayMode::Simulated(replay) => replay.feed(input.0, message, on_difference),
            ReplayMode::RealTime(replay) => replay.feed(input.0, message, on_difference),
        }
    }

    /// Marks the end of the recorded run: later records were published while its agents were being
    /// stopped.
    pub fn end(&mut self, moment: Timestamp, on_difference: &mut dyn FnMut(ReplayDifference)) {
        self.now = moment;
        let _time = SimulatedTimeGuard::begin(moment);
        match &mut self.mode {
            ReplayMode::Simulated(replay) => replay.end(moment, on_difference),
            // The recording contains how each agent stopped.
            ReplayMode::RealTime(_) => {}
        }
    }

    /// Ends the replay and returns the counts by host, agent and topic. A truncated recording does
    /// not count as the end of the run: messages that agents would have published afterwards are
    /// not differences.
    ///
    /// # Errors
    /// As in [`feed`](Replay::feed).
    pub fn finish(
        self,
        is_whole: bool,
        on_difference: &mut dyn FnMut(ReplayDifference),
    ) -> Result<Vec<ComparisonCounts>, Error> {
        let _time = SimulatedTimeGuard::begin(self.now);
        match self.mode {
            ReplayMode::Simulated(replay) => replay.finish(is_whole, on_difference),
            ReplayMode::RealTime(replay) => replay.finish(is_whole, on_difference),
        }
    }
}

impl std::fmt::Debug for Replay {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hosts = match &self.mode {
            ReplayMode::Simulated(replay) => replay.hosts(),
            ReplayMode::RealTime(replay) => replay.hosts(),
        };
        f.debug_struct("Replay").field("hosts", &hosts).finish_non_exhaustive()
    }
}

/// An input that does not belong to this replay.
fn no_input() -> Error {
    Error::new(ErrorKind::Invalid, "no such input of this replay")
}
