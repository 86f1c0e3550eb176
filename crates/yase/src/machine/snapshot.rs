//! What a machine is doing, as data that can be kept, read, changed and brought back.
//!
//! A [`Snapshot`] holds everything about a running [`Machine`](crate::Machine) that the steps to come depend on, by names that do not change when the
//! chart is numbered anew: the paths of states, the names of events and timers. It can be written as text (with serde), looked at, and
//! edited: a timer set, an event dropped, another state made active. [`Machine::restore`](crate::Machine::restore) brings it back, and refuses one that does not
//! fit the chart or cannot be: nothing in it is guessed.
//!
//! # What is not in it
//!
//! What happens outside the machine is the host's to keep and to bring back:
//!
//! - the blackboards of all [regions](crate::Chart::regions): what they show, what has arrived for them, what was assigned and not yet
//!   published;
//! - the [activations](crate::Machine::activations) that are [running](ActivityPhase::Running) (their return will be told), and those that wait to be called
//!   again ([ongoing](ActivityPhase::Ongoing), or [failed](ActivityPhase::Failed) if the host tries again), with the time of that. The machine starts those
//!   that are [queued](ActivityPhase::Queued) itself. A running activation that was asked to return says so
//!   ([`cancelled`](ActivityRecord::cancelled)); the machine does not ask again. One that cannot be brought back is told as returned, say
//!   as [failed](crate::Outcome::Failed), by the first call after [`restore`](crate::Machine::restore);
//! - what was published and has not been told to the machine ([`message_arrived`](crate::Machine::message_arrived)).
//!
//! Restored on a chart compiled from an equal statechart, states, blackboards and activations have the numbers that they had.
//!
//! # Example
//!
//! A lamp goes out after two seconds; it is put away as text while it is on, and brought back with less time left:
//!
//! ```
//! use std::sync::Arc;
//! use yase::expression::parse_transition;
//! use yase::snapshot::Snapshot;
//! use yase::{Activation, Host, Machine, Moment, Node, NodeKind, Statechart, Transition, Vocabulary};
//!
//! let mut lamp = Statechart::new("lamp");
//! let start = lamp.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
//! let off = lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "off"));
//! let on = lamp.add(Statechart::ROOT, Node::new(NodeKind::Basic, "on"));
//! for (source, target, text) in
//!     [(start, off, ""), (off, on, "button / StartTimeout(enough, 2 s)"), (on, off, "enough")]
//! {
//!     let (expression, wrong) = parse_transition(text);
//!     assert!(wrong.is_empty());
//!     lamp.connect(Transition { expression, ..Transition::new(source, target) });
//! }
//!
//! /// A world without messages and activities.
//! struct Dark;
//! impl Host for Dark {
//!     fn start(&mut self, _: Activation) {}
//!     fn cancel(&mut self, _: Activation) {}
//!     fn stop(&mut self, _: Activation) {}
//! }
//!
//! let chart = Arc::new(lamp.compile(&Vocabulary::default()).expect("the chart is in order"));
//! let mut machine = Machine::new(chart.clone());
//! machine.start(Moment::ZERO, &mut Dark);
//! machine.dispatch_name("button");
//! machine.run_to_completion(Moment::ZERO, &mut Dark)?;
//!
//! let text = serde_json::to_string_pretty(&machine.snapshot())?;
//! let mut snapshot: Snapshot = serde_json::from_str(&text)?;
//! assert_eq!(snapshot.configuration, ["lamp", "lamp/on"]);
//! assert!(snapshot.set_timer("lamp", "enough", Moment::from_millis(500)));
//!
//! let mut machine = Machine::restore(chart.clone(), &snapshot)?;
//! machine.run_to_completion(Moment::from_millis(500), &mut Dark)?;
//! assert!(machine.is_active(off));
//!
//! // no state `dim`, and two states at once
//! snapshot.configuration.extend(["lamp/dim".to_owned(), "lamp/off".to_owned()]);
//! let error = Machine::restore(chart, &snapshot).expect_err("it does not fit");
//! assert_eq!(error.misfits().len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod consistency;
mod error;
mod paths;
mod records;
mod restore;
mod take;

use serde::{Deserialize, Serialize};

use crate::machine::{Status, StepSummary};
use crate::moment::Moment;
use crate::semantics::Semantics;

pub use error::{Misfit, MisfitKind, RestoreError};
pub(crate) use paths::{Paths, event_name, find_event, ways};
pub(crate) use records::can_remember;

/// The version of the format that this crate writes and reads.
pub const VERSION: u32 = 1;

/// What a machine is doing. See the [module](self) for what it is good for.
///
/// Nodes are written as their paths (`chart/outer/inner`); of several with one path those after the first have their number at the end
/// (`chart/CONDITION#2`).
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Snapshot {
    /// The version of the format: [`VERSION`].
    pub version: u32,
    /// The name of the chart.
    pub chart: String,
    /// How the machine reads the chart.
    pub semantics: Semantics,
    /// What the machine is doing.
    pub status: Status,
    /// The time of its last step.
    pub now: Moment,
    /// Whether something happened that a step may answer to, other than events and timers.
    pub due: bool,
    /// What a step that is [under way](crate::Machine::micro_step) has done so far: a machine that is restored goes on with it.
    pub step: Option<StepSummary>,
    /// The active nodes in the order of the document, composites before what is in them.
    pub configuration: Vec<String>,
    /// Regions of active ANDs that are entered when the next step begins, since a [swap](crate::swap) has brought them.
    pub to_enter: Vec<String>,
    /// Active regions whose blackboard is filled when the next step begins, since a [swap](crate::swap) has brought them.
    pub to_inherit: Vec<String>,
    /// The active STARTs of which it has been reported that they wait.
    pub waiting_starts: Vec<String>,
    /// Active composites that were left without an active child, and count as complete.
    pub vacated: Vec<String>,
    /// Transitions into JOINs that were taken by themselves and wait for the others.
    pub joined: Vec<Way>,
    /// States that have completed, oldest first, where that is looked at once and has not been yet.
    pub completions: Vec<String>,
    /// Whether the root has reached its END, and is left when the step is over.
    pub ending: bool,
    /// The CHOICE without an open way that kept the machine from being started, which its first step says.
    pub no_branch: Option<String>,
    /// What HISTORYs remember.
    pub history: Vec<HistoryRecord>,
    /// The timers that are set.
    pub timers: Vec<TimerRecord>,
    /// How many activities have been started or queued to be, ever.
    pub activations: u64,
    /// The activities of active states.
    pub activities: Vec<ActivityRecord>,
    /// How many events there have been, ever.
    pub occurrences: u64,
    /// Events that actions raised, oldest first.
    pub raised: Vec<OccurrenceRecord>,
    /// Events that came from elsewhere, oldest first.
    pub arrived: Vec<OccurrenceRecord>,
    /// Events that a state has put off, oldest first.
    pub deferred: Vec<OccurrenceRecord>,
    /// Events that wait for running activities, oldest first.
    pub held: Vec<HeldRecord>,
    /// Interrupting transitions that wait for the activities they have asked to return, oldest first.
    pub pending: Vec<PendingRecord>,
    /// Guards that had no value when they were read last; it is not reported again.
    pub erred_guards: Vec<ErredGuardRecord>,
    /// The blackboards that were written and are published at the end of the step.
    pub written: Vec<String>,
    /// What is counted to notice a chart that never rests.
    pub bound: BoundRecord,
    /// Who decides what the chart leaves open, and what it has decided.
    pub chooser: ChooserRecord,
}

/// A compound transition: its segments, each as `source -> target`, with a number (`#2`) from the second between the same nodes on.
pub type Way = Vec<String>;

/// A timer, by the node whose blackboard it lies on, and its name.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimerName {
    /// The region, or the root.
    pub region: String,
    /// Its name.
    pub name: String,
}

/// What a HISTORY remembers of the time when its composite was left last.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HistoryRecord {
    /// The HISTORY.
    pub history: String,
    /// Of a shallow one the child that was active (in an AND none, since all are), of a deep one all that was active inside.
    pub nodes: Vec<String>,
}

/// A timer that is set.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimerRecord {
    /// Which one.
    pub timer: TimerName,
    /// When it expires or has expired.
    pub deadline: Moment,
    /// Whether a step has noticed that it has expired.
    pub expired: bool,
    /// The state with whose end it is forgotten.
    pub owner: Option<String>,
}

/// The activity of an active state.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ActivityRecord {
    /// The BASIC state.
    pub state: String,
    /// The name of its activity.
    pub activity: String,
    /// Where it is.
    pub phase: ActivityPhase,
    /// The number of its [`Activation`](crate::Activation).
    pub number: u64,
    /// Whether it has been asked to return.
    pub cancelled: bool,
}

/// Where an activity is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ActivityPhase {
    /// Its state was entered; it starts when the step is over.
    Queued,
    /// It runs.
    Running,
    /// It waits to be called again.
    Ongoing,
    /// It returned with a failure.
    Failed,
    /// It has done its work.
    Done,
}

/// What an event is called.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventName {
    /// An event by its name; `?` is any that no expression of the chart names.
    Name(String),
    /// The arrival of a message on a topic, by what traces call it.
    Message(String),
}

/// An event that happened.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OccurrenceRecord {
    /// What happened.
    pub event: EventName,
    /// Counts the occurrences: less is older.
    pub number: u64,
    /// Whether an action raised it.
    pub raised: bool,
    /// The timer whose expiry it is.
    pub expiry: Option<TimerName>,
    /// The number that the host gave it.
    pub token: u64,
    /// Whether an expression names it as it was named.
    pub known: bool,
}

/// An event that waits for running activities.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeldRecord {
    /// The event.
    pub occurrence: OccurrenceRecord,
    /// The transitions that it would enable.
    pub ways: Vec<Way>,
    /// Whether an activity that was in the way has returned, so that it is offered again.
    pub offer: bool,
}

/// An interrupting transition that waits.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PendingRecord {
    /// The transition.
    pub way: Way,
    /// The event that it takes, if it has a trigger.
    pub event: Option<EventName>,
}

/// A guard that had no value.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ErredGuardRecord {
    /// Its segment.
    pub segment: String,
    /// The blackboard that it was read on.
    pub region: String,
    /// Whether a message that it reads has arrived since, which its blackboard has still to receive.
    pub stale: bool,
}

/// What is counted to notice a chart that never rests.
#[derive(Clone, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoundRecord {
    /// Micro-steps of the last step.
    pub micro_steps: u32,
    /// The moment of the last step.
    pub instant: Moment,
    /// Steps that did something at that moment.
    pub steps: u32,
    /// The transitions that were taken last, to name a cycle.
    pub recent: Vec<Way>,
}

/// Who decides what a chart leaves open.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ChooserRecord {
    /// [`Chooser::declared`](crate::Chooser::declared).
    Declared,
    /// [`Chooser::seeded`](crate::Chooser::seeded).
    Seeded {
        /// The seed.
        seed: u64,
        /// How many numbers it has drawn.
        drawn: u64,
    },
    /// [`Chooser::scripted`](crate::Chooser::scripted).
    Scripted {
        /// The options that it was given.
        choices: Vec<u32>,
        /// Which option it has taken, and of how many.
        made: Vec<(u32, u32)>,
    },
}

impl Snapshot {
    /// Whether a node is active, by its path.
    pub fn is_active(&self, path: &str) -> bool {
        self.configuration.iter().any(|active| active == path)
    }

    /// The activity of an active state, by its path.
    pub fn activity(&self, state: &str) -> Option<&ActivityRecord> {
        self.activities.iter().find(|activity| activity.state == state)
    }

    /// What a HISTORY remembers, by its path.
    pub fn history(&self, history: &str) -> Option<&[String]> {
        let record = self.history.iter().find(|record| record.history == history);
        record.map(|record| record.nodes.as_slice())
    }

    /// Has a HISTORY remember other nodes, or for the first time.
    pub fn set_history(&mut self, history: &str, nodes: &[&str]) {
        let nodes = nodes.iter().map(|&node| node.to_owned()).collect();
        match self.history.iter_mut().find(|record| record.history == history) {
            Some(record) => record.nodes = nodes,
            None => self.history.push(HistoryRecord { history: history.to_owned(), nodes }),
        }
    }

    /// A timer that is set, by the path of its region and its name.
    pub fn timer(&self, region: &str, name: &str) -> Option<&TimerRecord> {
        self.timers.iter().find(|record| record.timer.is(region, name))
    }

    /// Changes the deadline of a timer that is set, as setting it again would: an expiry of it that waits to be offered is forgotten. Says
    /// whether it was set.
    pub fn set_timer(&mut self, region: &str, name: &str, deadline: Moment) -> bool {
        let Some(record) = self.timers.iter_mut().find(|record| record.timer.is(region, name)) else {
            return false;
        };
        (record.deadline, record.expired) = (deadline, false);
        self.forget_expiry(region, name);
        true
    }

    /// Makes a timer one that was never set. Says whether it was set.
    pub fn unset_timer(&mut self, region: &str, name: &str) -> bool {
        let before = self.timers.len();
        self.timers.retain(|record| !record.timer.is(region, name));
        self.forget_expiry(region, name);
        self.timers.len() < before
    }

    fn forget_expiry(&mut self, region: &str, name: &str) {
        let other = |occurrence: &OccurrenceRecord| {
            !occurrence.expiry.as_ref().is_some_and(|timer| timer.is(region, name))
        };
        self.arrived.retain(other);
        self.deferred.retain(other);
        self.held.retain(|held| other(&held.occurrence));
    }
}

impl TimerName {
    fn is(&self, region: &str, name: &str) -> bool {
        self.region == region && self.name == name
    }
}
