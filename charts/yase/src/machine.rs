//! The execution of a chart.

mod actions;
mod activities;
mod branch_selection;
mod chooser;
mod completion;
mod enter;
mod errors;
mod fifo;
mod fire;
mod guard_value;
mod history;
mod leave;
mod livelock_limit;
mod machine_state;
mod queues;
mod regions_to_enter;
mod script;
mod select;
pub mod snapshot;
pub mod state_key;
mod step;
mod timers;
mod view;
mod walk;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::compile::{CompiledChart, NodeIndex};
use crate::expression::{EventId, EventInterner};
use crate::host::{Host, Outcome};
use crate::ids::{Activation, ScopeId};
use crate::semantics::Semantics;
use crate::statechart::{NodeId, TransitionId};
use crate::timestamp::Timestamp;
use crate::vocabulary::TopicId;

use machine_state::MachineState;
use queues::QueuedEvent;
use step::Macrostep;

pub use chooser::Chooser;
pub use guard_value::GuardValue;

/// One execution of a [`CompiledChart`].
///
/// External events are reported by [`dispatch`](Machine::dispatch),
/// [`message_arrived`](Machine::message_arrived) and
/// [`activity_returned`](Machine::activity_returned), which only queue them;
/// [`run_to_completion`](Machine::run_to_completion) then takes all enabled transitions. Between
/// two such steps the machine does nothing: [`needs_step`](Machine::needs_step) and
/// [`next_deadline`](Machine::next_deadline) return when the next one is due.
///
/// It reads no clock, starts no thread and, once its queues have reached their size, allocates
/// nothing during a step.
#[derive(Clone, Debug)]
pub struct Machine {
    chart: Arc<CompiledChart>,
    run: MachineState,
}

/// The status of a machine.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Status {
    /// It has not been started.
    Idle,
    /// It is running.
    Running,
    /// Its root has reached END; nothing happens until it is started again.
    Finished,
    /// It was stopped: by the host, by TERMINATE, or by the livelock limit.
    Stopped,
}

/// The summary of a run-to-completion step.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct StepSummary {
    /// The number of micro-steps: those that took a transition, and those that offered an event
    /// without effect.
    pub micro_steps: u32,
    /// The number of transitions taken.
    pub transitions: u32,
    /// The number of activities started.
    pub started: u32,
}

/// The result of [`Machine::micro_step`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum MicroStep {
    /// A micro-step was made: the run-to-completion step is in progress.
    Progressed,
    /// No transition is enabled any more: the step has ended, with this summary.
    Stable(StepSummary),
}

/// Why a machine stopped without a request.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{}", .0.text)]
pub struct MachineError(Box<ErrorDetails>);

/// The details of an error. Boxed, so that a successful step returns a small value.
#[derive(Clone, PartialEq, Eq, Debug)]
struct ErrorDetails {
    kind: MachineErrorKind,
    cycle: Box<[TransitionId]>,
    node: Option<NodeId>,
    text: String,
}

/// The kind of a [`MachineError`].
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[non_exhaustive]
pub enum MachineErrorKind {
    /// A step exceeded the number of micro-steps that [`Semantics::limit`] allows.
    NeverRests,
    /// The number of steps with an effect at one time exceeded [`Semantics::limit`].
    NeverAdvances,
    /// No transition out of a CHOICE was enabled when it was reached.
    NoBranch,
}

impl MachineError {
    /// The kind of the error.
    pub fn kind(&self) -> MachineErrorKind {
        self.0.kind
    }

    /// The CHOICE without an enabled transition.
    pub fn node(&self) -> Option<NodeId> {
        self.0.node
    }

    /// The segments of the cycle that was executed repeatedly.
    pub fn cycle(&self) -> &[TransitionId] {
        &self.0.cycle
    }
}

impl Machine {
    /// A machine that has not been started.
    pub fn new(chart: Arc<CompiledChart>) -> Machine {
        let run = MachineState::new(&chart);
        Machine { chart, run }
    }

    /// The chart that it executes.
    pub fn chart(&self) -> &Arc<CompiledChart> {
        &self.chart
    }

    /// The semantics of the chart.
    pub fn semantics(&self) -> Semantics {
        self.chart.semantics()
    }

    /// The chooser, which resolves nondeterminism.
    pub fn chooser(&self) -> &Chooser {
        &self.run.chooser
    }

    /// Replaces the chooser.
    pub fn set_chooser(&mut self, chooser: Chooser) {
        self.run.chooser = chooser;
    }

    /// Starts the chart: enters the root and its START (with
    /// [`InitialState::SameStep`](crate::InitialState::SameStep), also the states behind it). A
    /// previous execution is [stopped](Machine::stop); timers and events are discarded. The first
    /// transitions are taken by the next [`run_to_completion`](Machine::run_to_completion).
    pub fn start(&mut self, now: Timestamp, host: &mut impl Host) {
        self.stop(host);
        self.run.reset(now);
        self.step(host).begin_run();
    }

    /// Stops without leaving any state: running activities receive a cancellation request, waiting
    /// ones are stopped. The configuration remains for inspection.
    pub fn stop(&mut self, host: &mut impl Host) {
        self.run.step_in_progress = None;
        if self.run.status == Status::Running {
            self.step(host).halt(Status::Stopped);
        }
    }

    /// Stops by leaving all states, innermost first, with their exit actions.
    pub fn leave(&mut self, host: &mut impl Host) {
        if self.run.status == Status::Running {
            self.step(host).leave_all(Status::Stopped);
        }
    }

    /// Queues an event. Events that enable no transition are dropped when they are offered; all
    /// events are dropped while the chart is not running.
    pub fn dispatch(&mut self, event: EventId) {
        self.arrive(event.into());
    }

    fn arrive(&mut self, event: QueuedEvent) {
        if self.run.status == Status::Running {
            self.run.queues.arrive(event);
        }
    }

    /// Queues an event by its name, and returns whether any expression of the chart names it. An
    /// event that none names can still be taken by `*` and `not e` (traces call it `?`), or by a
    /// trigger that names the first tokens of its name ([`CompiledChart::event`]).
    pub fn dispatch_name(&mut self, name: &str) -> bool {
        self.dispatch_with(name, 0)
    }

    /// Queues an event by its name like [`dispatch_name`](Machine::dispatch_name), with a token of
    /// the caller, which is passed to [`Host::event_taken_from_queue`] when the event is offered.
    #[inline(never)] // a search among names: callers who have an `EventId` beside it need not pay for its registers
    pub fn dispatch_with(&mut self, name: &str, token: u64) -> bool {
        let (event, is_known) = self.chart.event(name);
        self.arrive(QueuedEvent { event, expiry: None, token, is_known });
        is_known
    }

    /// Raises an event outside a step, as an action does within: the next step offers it before
    /// arrived events. The token is the caller's, as with
    /// [`dispatch_with`](Machine::dispatch_with).
    pub fn raise_with(&mut self, name: &str, token: u64) -> bool {
        let (event, is_known) = self.chart.event(name);
        if self.run.status == Status::Running {
            self.run.raise(&self.chart, event, is_known, token);
        }
        is_known
    }

    /// Reports that messages of the own host have arrived on a topic: each is one occurrence for
    /// triggers that name the message, and guards that read the topic are evaluated again.
    pub fn message_arrived(&mut self, topic: TopicId, count: usize) {
        self.arrived(topic, count, |events| events.message(topic));
    }

    /// The same for messages of another host: they are occurrences only for triggers that name that
    /// host.
    pub fn message_arrived_from(&mut self, host: &str, topic: TopicId, count: usize) {
        self.arrived(topic, count, |events| events.message_of(host, topic));
    }

    fn arrived(&mut self, topic: TopicId, count: usize, event: impl Fn(&EventInterner) -> Option<EventId>) {
        if self.run.status != Status::Running || count == 0 || !self.reads_topic(topic) {
            return;
        }
        self.run.needs_step = true;
        self.run.topic_changed(&self.chart, topic, None);
        if let Some(event) = event(self.chart.events()) {
            for _ in 0..count {
                self.run.queues.arrive(event.into());
            }
        }
    }

    /// Reports that an activity has returned, which unlocks its scope. Returns whether it was
    /// running: a return after [`stop`](Machine::stop) is ignored.
    pub fn activity_returned(&mut self, activation: Activation, outcome: Outcome) -> bool {
        self.run.activity_returned(&self.chart, activation, outcome)
    }

    /// Reports that an activity that was [`Ongoing`](Outcome::Ongoing) or [failed](Outcome::Failed)
    /// is called again, which locks its scope. Returns whether this is allowed: if its state has
    /// been left or is about to be, it must not be called again.
    pub fn activity_resumed(&mut self, activation: Activation) -> bool {
        self.run.activity_resumed(&self.chart, activation)
    }

    /// Executes one run-to-completion step: delivers messages; takes transitions until none is
    /// enabled, first those without a trigger, then those of raised events, then those of arrived
    /// events one by one; publishes outputs; starts the activities of the states that were entered.
    /// A machine that is not running does nothing.
    ///
    /// If `now` is earlier than in the previous step, time stands still.
    ///
    /// # Errors
    /// When the livelock limit is exceeded, or no transition out of a CHOICE is enabled
    /// ([`MachineErrorKind`]). The machine is then stopped, in the configuration before the
    /// micro-step that failed or exceeded the limit.
    pub fn run_to_completion(
        &mut self,
        now: Timestamp,
        host: &mut impl Host,
    ) -> Result<StepSummary, MachineError> {
        match self.advance_to(now) {
            true => self.step(host).run(),
            false => Ok(StepSummary::default()),
        }
    }

    /// Executes one micro-step of a run-to-completion step: the first, or the next of the step in
    /// progress. The call that finds no enabled transition ends the step.
    /// [`run_to_completion`](Machine::run_to_completion) repeats this until the result is
    /// [`MicroStep::Stable`], or completes a step in progress.
    ///
    /// Time stands still while a step is in progress: only the first call's `now` counts. This
    /// method is meant for debuggers, which inspect the machine between the calls; events and
    /// returns of activities should be reported after the step has ended.
    ///
    /// # Errors
    /// As [`run_to_completion`](Machine::run_to_completion).
    pub fn micro_step(&mut self, now: Timestamp, host: &mut impl Host) -> Result<MicroStep, MachineError> {
        match self.advance_to(now) {
            true => self.step(host).run_micro_step(),
            false => Ok(MicroStep::Stable(StepSummary::default())),
        }
    }

    /// Whether a step has begun with [`micro_step`](Machine::micro_step) and not ended.
    pub fn is_mid_step(&self) -> bool {
        self.run.step_in_progress.is_some()
    }

    /// Advances the time for a new step; returns whether a step is due.
    fn advance_to(&mut self, now: Timestamp) -> bool {
        if self.is_mid_step() {
            return true;
        }
        if self.run.status != Status::Running {
            return false;
        }
        self.run.now = self.run.now.max(now);
        true
    }

    /// Whether a step at `now` could have an effect.
    pub fn needs_step(&self, now: Timestamp) -> bool {
        if self.is_mid_step() {
            return true;
        }
        let due = || {
            self.run.needs_step
                || self.run.queues.is_waiting()
                || !self.run.completions.is_empty()
                || self.next_deadline().is_some_and(|next| next <= now)
        };
        self.run.status == Status::Running && due()
    }

    /// The deadline of the next timer, if one is set.
    pub fn next_deadline(&self) -> Option<Timestamp> {
        if self.run.status == Status::Running { self.run.timers.next_deadline() } else { None }
    }

    /// The deadline of a timer of a scope, past or future; none if it is not set.
    pub fn deadline(&self, region: ScopeId, timer: &str) -> Option<Timestamp> {
        let index = self.chart.timers().position(|(board, name)| board == region && name == timer)?;
        self.run.timers.slot(index).map(|deadline| deadline.moment)
    }

    /// Whether a message on that topic can affect the chart: each must then be reported with
    /// [`message_arrived`](Machine::message_arrived).
    pub fn reads_topic(&self, topic: TopicId) -> bool {
        self.chart.reads().binary_search(&topic).is_ok()
    }

    /// The status of the machine.
    pub fn status(&self) -> Status {
        self.run.status
    }

    /// Whether the root has reached its END.
    pub fn is_finished(&self) -> bool {
        self.run.status == Status::Finished
    }

    /// The active nodes in document order, composites before their children.
    pub fn configuration(&self) -> Vec<NodeId> {
        let layout = &self.chart.layout;
        let mut nodes: Vec<_> = self.run.active.members().map(|index| NodeIndex(index as u32)).collect();
        nodes.sort_by_key(|&node| layout.rank(node));
        nodes.into_iter().map(|index| layout.node(index)).collect()
    }

    /// Whether a node is active.
    pub fn is_active(&self, node: NodeId) -> bool {
        self.chart.layout.find_index(node).is_some_and(|index| self.run.active.contains(index.index()))
    }

    /// Whether a scope itself has a running activity: it then takes no transition, and nothing is
    /// delivered to its blackboard.
    pub fn is_running(&self, region: ScopeId) -> bool {
        self.run.running_regions.contains(region.index())
    }

    fn step<'a, H: Host>(&'a mut self, host: &'a mut H) -> Macrostep<'a, H> {
        Macrostep::new(&self.chart, &mut self.run, host)
    }
}
