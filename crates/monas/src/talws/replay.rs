//! Runs agents again on what was recorded, and compares what they publish with what they published then.
//!
//! A recording of simulated time is followed message by message, see [`simulated`]. One of real time is followed turn by turn, see
//! [`real_time`]: when threads ran was chance, but records of cycles tell of it.

mod changes;
mod compare;
mod feed;
mod ordered;
mod real_time;
mod repeated;
mod scene;
mod simulated;

use narukom::Moment;

use super::Talws;
use crate::error::{Error, ErrorKind};
use crate::logger::Simulating;

use real_time::RealTime;
use simulated::Simulated;

/// A publisher of a host, as it was when the host was recorded.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Company {
    /// The host.
    pub host: String,
    /// The publisher's name.
    pub publisher: String,
    /// Whether it was an agent: whether it published records of its cycles.
    pub is_agent: bool,
    /// The last of the parts that published under that name, see [`Header::part`](narukom::Header::part).
    pub last_part: u16,
}

/// What the messages of one publisher on one topic have in common.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Recorded<'a> {
    /// The host on which they were published.
    pub host: &'a str,
    /// The host that recorded them, if they came to it from the other one.
    pub received_by: Option<&'a str>,
    /// Who published.
    pub publisher: &'a str,
    /// Which of those who published under that name, see [`Header::part`](narukom::Header::part).
    pub part: u16,
    /// The path of the topic.
    pub topic: &'a str,
}

/// A recorded message of an [input](Replay::input).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RecordedMessage<'a> {
    /// Its number among its publisher's messages on the topic; the lower 32 bits.
    pub sequence: u32,
    /// When it was published.
    pub published: Moment,
    /// When it came to the hub that was recorded.
    pub received: Moment,
    /// Its protobuf encoding.
    pub bytes: &'a [u8],
}

/// How what an agent publishes in a replay differs from what it published when it was recorded.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Difference {
    /// The agent's host.
    pub host: String,
    /// The agent.
    pub agent: String,
    /// The agent's cycle, counted from 1.
    pub cycle: u64,
    /// When.
    pub time: Moment,
    /// The path of the topic.
    pub topic: String,
    /// What was recorded; none if nothing was.
    pub recorded: Option<Vec<u8>>,
    /// What was published in the replay; none if nothing was. If both are equal, they came in another order.
    pub replayed: Option<Vec<u8>>,
}

/// What was compared of one agent on one topic.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Tally {
    /// The agent's host.
    pub host: String,
    /// The agent.
    pub agent: String,
    /// The path of the topic.
    pub topic: String,
    /// Messages that were published both times.
    pub compared: u64,
    /// How many of these differ.
    pub different: u64,
    /// Messages that were only recorded.
    pub only_recorded: u64,
    /// Messages that were only published in the replay.
    pub only_replayed: u64,
}

impl Tally {
    /// How many messages are not what they were.
    pub fn differences(&self) -> u64 {
        self.different + self.only_recorded + self.only_replayed
    }
}

/// Where recorded messages come in: see [`Replay::input`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Input(usize);

/// Agents that run again on what was recorded. What others published is published again, at the moments of then; what the agents publish
/// is compared, byte by byte, with what they published then.
///
/// In simulated time the agents make one run, in which they read each other's messages as they are now. In real time each agent repeats
/// its own recorded turns, at the moments of then, and is given what was delivered to it in each: of the other agents, replayed or not,
/// what was recorded.
///
/// Changes of agents that were made meanwhile are made again: in simulated time when they were asked for, in real time between those turns
/// of the agent between which it followed them. One that was removed and added anew comes back as it did. Agents that were new then are not
/// replayed: what they published is given to the others. A list that began while its agent ran begins where it did.
///
/// What comes from outside and is no message, an event that somebody raised by hand, is not in a recording and so not in a replay. Nor is
/// what an activity learns in other ways: from a clock, a device or another thread. That shows as a difference.
pub struct Replay {
    course: Course,
    /// The moment of the message that came last.
    now: Moment,
}

/// What is followed.
enum Course {
    Simulated(Simulated),
    RealTime(RealTime),
}

impl Talws {
    /// Prepares a replay of the agents of these hosts, which need no bodies, on a recording of simulated time. The seed is that of the
    /// recorded run; `company` are all who published on the hosts.
    ///
    /// # Errors
    /// As in [`simulate`](Talws::simulate).
    pub fn replay(self, seed: u64, company: &[Company]) -> Result<Replay, Error> {
        Ok(Replay { course: Course::Simulated(Simulated::new(self, seed, company)?), now: Moment::ZERO })
    }

    /// As [`replay`](Talws::replay), on a recording of real time.
    ///
    /// # Errors
    /// As there, and if an agent has neither charts nor activities when the run begins.
    pub fn replay_real_time(self, company: &[Company]) -> Result<Replay, Error> {
        Ok(Replay { course: Course::RealTime(RealTime::new(self, company)?), now: Moment::ZERO })
    }
}

impl Replay {
    /// Where the messages of a publisher on a topic come in.
    ///
    /// # Errors
    /// A message of another host names the host that it came to, or there are too many hosts.
    pub fn input(&mut self, recorded: Recorded<'_>) -> Result<Input, Error> {
        let number = match &mut self.course {
            Course::Simulated(course) => course.input(recorded),
            Course::RealTime(course) => course.input(recorded),
        };
        number.map(Input)
    }

    /// Goes on to the next recorded message. `told` hears of each difference that is certain by now.
    ///
    /// # Errors
    /// The bytes are no message of the topic's type; or the recording of a run in real time lacks what its cycles were given.
    pub fn feed(
        &mut self,
        input: Input,
        message: RecordedMessage<'_>,
        told: &mut dyn FnMut(Difference),
    ) -> Result<(), Error> {
        self.now = message.received;
        let _time = Simulating::begin(self.now);
        match &mut self.course {
            Course::Simulated(course) => course.feed(input.0, message, told),
            Course::RealTime(course) => course.feed(input.0, message, told),
        }
    }

    /// The recorded run ended at this moment: what is recorded from now on was published while its agents were being stopped.
    pub fn end(&mut self, moment: Moment, told: &mut dyn FnMut(Difference)) {
        self.now = moment;
        let _time = Simulating::begin(moment);
        match &mut self.course {
            Course::Simulated(course) => course.end(moment, told),
            // How each agent stopped is recorded.
            Course::RealTime(_) => {}
        }
    }

    /// Ends the replay, and tells what was compared, by host, agent and topic. The end of a recording that was cut off is not taken
    /// for an end of the run: what agents would have published then is no difference.
    ///
    /// # Errors
    /// As in [`feed`](Replay::feed).
    pub fn finish(self, is_whole: bool, told: &mut dyn FnMut(Difference)) -> Result<Vec<Tally>, Error> {
        let _time = Simulating::begin(self.now);
        match self.course {
            Course::Simulated(course) => course.finish(is_whole, told),
            Course::RealTime(course) => course.finish(is_whole, told),
        }
    }
}

impl std::fmt::Debug for Replay {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let hosts = match &self.course {
            Course::Simulated(course) => course.hosts(),
            Course::RealTime(course) => course.hosts(),
        };
        f.debug_struct("Replay").field("hosts", &hosts).finish_non_exhaustive()
    }
}

/// An input that this replay does not have.
fn no_input() -> Error {
    Error::new(ErrorKind::Invalid, "no such input of this replay")
}

/// The names of those who published on a host.
pub(super) fn names_on(company: &[Company], host: &str) -> impl Iterator<Item = String> {
    company.iter().filter(move |one| one.host == host).map(|one| one.publisher.clone())
}
