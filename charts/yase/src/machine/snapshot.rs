//! The complete state of a machine as data that can be stored, inspected, edited and restored.
//!
//! A [`Snapshot`] holds everything about a running [`Machine`](crate::Machine) that affects later
//! steps, by names that do not depend on the numbering of the chart: the paths of states, the names
//! of events and timers. It can be written as text (with serde), inspected, and edited: a timer
//! set, an event dropped, another state made active. [`Machine::restore`](crate::Machine::restore)
//! reads it, and rejects a snapshot that does not fit the chart or is inconsistent; it guesses
//! nothing.
//!
//! # Not included
//!
//! The host captures and restores what lies outside the machine:
//!
//! - the blackboards of all [scopes](crate::CompiledChart::regions): their values, undelivered
//!   messages, and assignments not yet published;
//! - the [activations](crate::Machine::activations) that are [running](ActivityPhase::Running)
//!   (their return will be reported), and those that wait for the next call
//!   ([ongoing](ActivityPhase::Ongoing), or [failed](ActivityPhase::Failed) if the host retries),
//!   with its time. The machine itself starts those that are [queued](ActivityPhase::Queued). A
//!   running activation that was requested to return is marked as
//!   [`cancelled`](ActivityRecord::cancelled); the machine does not repeat the request. For one
//!   that cannot be restored, the host reports a return, for example
//!   [failed](crate::Outcome::Failed), in the first call after
//!   [`restore`](crate::Machine::restore);
//! - publications not yet reported to the machine
//!   ([`message_arrived`](crate::Machine::message_arrived)).
//!
//! When restored on a chart compiled from an equal statechart, states, blackboards and activations
//! keep their numbers.
//!
//! # Example
//!
//! A lamp goes out after two seconds; it is captured as text while it is on, and restored with less
//! time left:
//!
//! ```
//! use std::sync::Arc;
//! use yase::expression::parse_transition;
//! use yase::snapshot::Snapshot;
//! use yase::{Activation, Host, Machine, Timestamp, Node, NodeKind, Statechart, Transition, TypeEnvironment};
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
//! /// A host without messages and activities.
//! struct Dark;
//! impl Host for Dark {
//!     fn start(&mut self, _: Activation) {}
//!     fn cancel(&mut self, _: Activation) {}
//!     fn stop(&mut self, _: Activation) {}
//! }
//!
//! let chart = Arc::new(lamp.compile(&TypeEnvironment::default()).expect("the chart is in order"));
//! let mut machine = Machine::new(chart.clone());
//! machine.start(Timestamp::ZERO, &mut Dark);
//! machine.dispatch_name("button");
//! machine.run_to_completion(Timestamp::ZERO, &mut Dark)?;
//!
//! let text = serde_json::to_string_pretty(&machine.snapshot())?;
//! let mut snapshot: Snapshot = serde_json::from_str(&text)?;
//! assert_eq!(snapshot.configuration, ["lamp", "lamp/on"]);
//! assert!(snapshot.set_timer("lamp", "enough", Timestamp::from_millis(500)));
//!
//! let mut machine = Machine::restore(chart.clone(), &snapshot)?;
//! machine.run_to_completion(Timestamp::from_millis(500), &mut Dark)?;
//! assert!(machine.is_active(off));
//!
//! // no state `dim`, and two states at once
//! snapshot.configuration.extend(["lamp/dim".to_owned(), "lamp/off".to_owned()]);
//! let error = Machine::restore(chart, &snapshot).expect_err("it does not fit");
//! assert_eq!(error.issues().len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod capture;
mod error;
mod paths;
mod records;
mod restore;
mod validate;

use serde::{Deserialize, Serialize};

use crate::machine::{Status, StepSummary};
use crate::semantics::Semantics;
use crate::timestamp::Timestamp;

pub use error::{RestoreError, RestoreIssue, RestoreIssueKind};
pub(crate) use paths::{PathTable, compounds_by_segments, event_name, find_event};
pub(crate) use records::can_remember;

/// The version of the format that this crate writes and reads.
pub const VERSION: u32 = 1;

/// The state of a machine; see the [module](self) documentation.
///
/// Nodes are written as their paths (`chart/outer/inner`); among nodes with equal paths, those
/// after the first have their number appended (`chart/CONDITION#2`).
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Snapshot {
    /// The version of the format: [`VERSION`].
    pub version: u32,
    /// The name of the chart.
    pub chart: String,
    /// The semantics of the chart.
    pub semantics: Semantics,
    /// The status of the machine.
    pub status: Status,
    /// The time of its last step.
    pub now: Timestamp,
    /// Whether a step is due for reasons other than events and timers.
    pub due: bool,
    /// The summary so far of a step [in progress](crate::Machine::micro_step): a restored machine
    /// continues it.
    pub step: Option<StepSummary>,
    /// The active nodes in document order, composites before their children.
    pub configuration: Vec<String>,
    /// Regions of active ANDs that are entered when the next step begins, since a
    /// [migration](crate::migrate) added them.
    pub to_enter: Vec<String>,
    /// Active regions whose blackboard is filled when the next step begins, since a
    /// [migration](crate::migrate) added them.
    pub to_inherit: Vec<String>,
    /// The active STARTs that have been reported as waiting.
    pub waiting_starts: Vec<String>,
    /// Active composites that were left without an active child, and count as complete.
    pub vacated: Vec<String>,
    /// Transitions into JOINs that were taken individually and wait for the others.
    pub joined: Vec<TransitionPath>,
    /// Completed states whose completion transitions have not been examined yet, oldest first,
    /// where that happens once.
    pub completions: Vec<String>,
    /// Whether the root has reached its END, and is left at the end of the step.
    pub ending: bool,
    /// The CHOICE without an enabled transition that prevented the start; the first step reports
    /// it.
    pub no_branch: Option<String>,
    /// The values of HISTORYs.
    pub history: Vec<HistoryRecord>,
    /// The timers that are set.
    pub timers: Vec<TimerRecord>,
    /// The number of activities started or queued so far.
    pub activations: u64,
    /// The activities of active states.
    pub activities: Vec<ActivityRecord>,
    /// The number of events so far.
    pub occurrences: u64,
    /// Events that actions raised, oldest first.
    pub raised: Vec<OccurrenceRecord>,
    /// Events from outside, oldest first.
    pub arrived: Vec<OccurrenceRecord>,
    /// Events that a state has deferred, oldest first.
    pub deferred: Vec<OccurrenceRecord>,
    /// Events that wait for running activities, oldest first.
    pub held: Vec<HeldEventRecord>,
    /// Interrupting transitions that wait for activities requested to return, oldest first.
    pub pending: Vec<PendingInterruptRecord>,
    /// Guards that had no value in their last evaluation; this is not reported again.
    pub erred_guards: Vec<FailedGuardRecord>,
    /// The blackboards that were written and are published at the end of the step.
    pub written: Vec<String>,
    /// The counters of the livelock limit.
    pub bound: LivelockRecord,
    /// The chooser, with the choices it has made.
    pub chooser: ChooserRecord,
}

/// A compound transition: its segments, each as `source -> target`, with a number (`#2`) from the
/// second between the same nodes on.
pub type TransitionPath = Vec<String>;

/// A timer, by the node of its scope and its name.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimerName {
    /// The region, or the root.
    pub region: String,
    /// Its name.
    pub name: String,
}

/// The value of a HISTORY: the nodes active when its composite was left last.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HistoryRecord {
    /// The HISTORY.
    pub history: String,
    /// For a shallow one the child that was active (in an AND none, since all are), for a deep one
    /// all active nodes inside.
    pub nodes: Vec<String>,
}

/// A timer that is set.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimerRecord {
    /// The timer.
    pub timer: TimerName,
    /// The time at which it expires or has expired.
    pub deadline: Timestamp,
    /// Whether a step has processed the expiry.
    pub expired: bool,
    /// The state on whose exit it is discarded.
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
    /// The phase of the activity.
    pub phase: ActivityPhase,
    /// The number of its [`Activation`](crate::Activation).
    pub number: u64,
    /// Whether it has been requested to return.
    pub cancelled: bool,
}

/// The phase of an activity.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ActivityPhase {
    /// Its state was entered; it starts at the end of the step.
    Queued,
    /// It is running.
    Running,
    /// It waits for the next call.
    Ongoing,
    /// It has failed.
    Failed,
    /// It has finished.
    Done,
}

/// The name of an event.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EventName {
    /// An event by its name; `?` is any that no expression of the chart names.
    Name(String),
    /// The arrival of a message on a topic, by its name in traces.
    Message(String),
}

/// An occurrence of an event.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OccurrenceRecord {
    /// The event.
    pub event: EventName,
    /// The number of the occurrence: lower is older.
    pub number: u64,
    /// Whether an action raised it.
    pub raised: bool,
    /// The timer whose expiry it is.
    pub expiry: Option<TimerName>,
    /// The token supplied by the host.
    pub token: u64,
    /// Whether an expression uses exactly this name.
    pub known: bool,
}

/// An event that waits for running activities.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HeldEventRecord {
    /// The event.
    pub occurrence: OccurrenceRecord,
    /// The transitions that it would enable.
    pub ways: Vec<TransitionPath>,
    /// Whether a blocking activity has returned, so that the event is offered again.
    pub offer: bool,
}

/// An interrupting transition that waits for activities.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PendingInterruptRecord {
    /// The transition.
    pub way: TransitionPath,
    /// The event that triggers it, if it has a trigger.
    pub event: Option<EventName>,
}

/// A guard that had no value.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FailedGuardRecord {
    /// Its segment.
    pub segment: String,
    /// The scope in which it was evaluated.
    pub region: String,
    /// Whether a message that it reads has arrived since, but is not delivered to its blackboard
    /// yet.
    pub stale: bool,
}

/// The counters of the livelock limit.
#[derive(Clone, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LivelockRecord {
    /// The number of micro-steps of the last step.
    pub micro_steps: u32,
    /// The time of the last step.
    pub instant: Timestamp,
    /// The number of steps with an effect at that time.
    pub steps: u32,
    /// The most recent transitions, to identify a cycle.
    pub recent: Vec<TransitionPath>,
}

/// The state of a chooser.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ChooserRecord {
    /// [`Chooser::declared`](crate::Chooser::declared).
    Declared,
    /// [`Chooser::seeded`](crate::Chooser::seeded).
    Seeded {
        /// The seed.
        seed: u64,
        /// The number of random numbers drawn.
        drawn: u64,
    },
    /// [`Chooser::scripted`](crate::Chooser::scripted).
    Scripted {
        /// The options it was given.
        choices: Vec<u32>,
        /// The options taken, each with the number of options.
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

    /// The value of a HISTORY, by its path.
    pub fn history(&self, history: &str) -> Option<&[String]> {
        let record = self.history.iter().find(|record| record.history == history);
        record.map(|record| record.nodes.as_slice())
    }

    /// Sets the value of a HISTORY, or gives it one.
    pub fn set_history(&mut self, history: &str, nodes: &[&str]) {
        let nodes = nodes.iter().map(|&node| node.to_owned()).collect();
        match self.history.iter_mut().find(|record| record.history == history) {
            Some(record) => record.nodes = nodes,
            None => self.history.push(HistoryRecord { history: history.to_owned(), nodes }),
        }
    }

    /// A timer that is set, by the path of its scope and its name.
    pub fn timer(&self, region: &str, name: &str) -> Option<&TimerRecord> {
        self.timers.iter().find(|record| record.timer.is(region, name))
    }

    /// Changes the deadline of a timer that is set, as setting it again would: a pending expiry is
    /// discarded. Returns whether the timer was set.
    pub fn set_timer(&mut self, region: &str, name: &str, deadline: Timestamp) -> bool {
        let Some(record) = self.timers.iter_mut().find(|record| record.timer.is(region, name)) else {
            return false;
        };
        (record.deadline, record.expired) = (deadline, false);
        self.forget_expiry(region, name);
        true
    }

    /// Removes a timer, as if it had never been set. Returns whether it was set.
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
