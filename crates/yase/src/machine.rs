//! A chart that runs.

mod act;
mod activities;
mod bound;
mod chooser;
mod completion;
mod direct;
mod draw;
mod enter;
mod errors;
pub(crate) mod explored;
mod fifo;
mod fire;
mod history;
mod leap;
mod leave;
mod newcomers;
mod queues;
mod run;
mod script;
mod select;
pub mod snapshot;
mod step;
mod timers;
mod view;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::chart::{Chart, RegionId};
use crate::expression::{EventId, EventTable};
use crate::host::{Activation, Host, Outcome};
use crate::moment::Moment;
use crate::semantics::Semantics;
use crate::statechart::{NodeId, TransitionId};
use crate::vocabulary::TopicId;

use queues::Incoming;
use run::Run;
use step::Step;

pub use chooser::Chooser;
pub use script::{Performance, States};

/// A [`Chart`] that runs.
///
/// What happens in the world is told by [`dispatch`](Machine::dispatch), [`message_arrived`](Machine::message_arrived) and
/// [`activity_returned`](Machine::activity_returned), which only take note;
/// [`run_to_completion`](Machine::run_to_completion) then takes every transition that has become possible. Between two such steps the machine
/// does nothing: [`needs_step`](Machine::needs_step) and [`next_deadline`](Machine::next_deadline) say when the next one is due.
///
/// It reads no clock, starts no thread and, once its queues have grown to their size, allocates nothing while it steps.
#[derive(Clone, Debug)]
pub struct Machine {
    chart: Arc<Chart>,
    run: Run,
}

/// What a machine is doing.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Status {
    /// It has not been started.
    Idle,
    /// It steps.
    Running,
    /// Its root has reached END; nothing happens until it is started again.
    Finished,
    /// It was stopped: from outside, by TERMINATE, or because it never came to rest.
    Stopped,
}

/// What a run-to-completion step did.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct StepSummary {
    /// How many micro-steps were made: those that took a transition, and those that offered an event in vain.
    pub micro_steps: u32,
    /// How many transitions were taken.
    pub transitions: u32,
    /// How many activities were started.
    pub started: u32,
}

/// What [`Machine::micro_step`] did.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum MicroStep {
    /// It made a micro-step: the run-to-completion step is under way.
    Made,
    /// There was nothing to be taken any more: the step has ended, and did this in all.
    AtRest(StepSummary),
}

/// Why a machine stopped by itself.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{}", .0.text)]
pub struct MachineError(Box<Fatality>);

/// What is known of it. It stands apart, so that a step that goes well hands back little.
#[derive(Clone, PartialEq, Eq, Debug)]
struct Fatality {
    kind: MachineErrorKind,
    cycle: Box<[TransitionId]>,
    node: Option<NodeId>,
    text: String,
}

/// What kind of [`MachineError`] it is.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[non_exhaustive]
pub enum MachineErrorKind {
    /// A step had more micro-steps than [`Semantics::limit`] allows.
    NeverRests,
    /// More steps did something at one moment than [`Semantics::limit`] allows.
    NeverAdvances,
    /// No way out of a CHOICE was open when it was reached.
    NoBranch,
}

impl MachineError {
    /// What kind of error it is.
    pub fn kind(&self) -> MachineErrorKind {
        self.0.kind
    }

    /// The CHOICE without an open way.
    pub fn node(&self) -> Option<NodeId> {
        self.0.node
    }

    /// The segments that were taken again and again.
    pub fn cycle(&self) -> &[TransitionId] {
        &self.0.cycle
    }
}

impl Machine {
    /// A machine that has not been started.
    pub fn new(chart: Arc<Chart>) -> Machine {
        let run = Run::new(&chart);
        Machine { chart, run }
    }

    /// The chart it runs.
    pub fn chart(&self) -> &Arc<Chart> {
        &self.chart
    }

    /// How it reads the chart.
    pub fn semantics(&self) -> Semantics {
        self.chart.semantics()
    }

    /// Who decides what the chart leaves open.
    pub fn chooser(&self) -> &Chooser {
        &self.run.chooser
    }

    /// Lets another decide what the chart leaves open.
    pub fn set_chooser(&mut self, chooser: Chooser) {
        self.run.chooser = chooser;
    }

    /// Enters the root and its START (with [`StartRest::SameStep`](crate::StartRest::SameStep), what that leads to), from scratch: what ran
    /// before is [stopped](Machine::stop), timers and events are forgotten. The first transitions are those of the next
    /// [`run_to_completion`](Machine::run_to_completion).
    pub fn start(&mut self, now: Moment, host: &mut impl Host) {
        self.stop(host);
        self.run.reset(now);
        self.step(host).begin_run();
    }

    /// Ends everything without leaving any state: running activities get a cancellation request, waiting ones are stopped.
    /// The configuration stays to be looked at.
    pub fn stop(&mut self, host: &mut impl Host) {
        self.run.under_way = None;
        if self.run.status == Status::Running {
            self.step(host).halt(Status::Stopped);
        }
    }

    /// Ends everything by leaving all states, innermost first, with their exit actions.
    pub fn leave(&mut self, host: &mut impl Host) {
        if self.run.status == Status::Running {
            self.step(host).leave_all(Status::Stopped);
        }
    }

    /// Notes an event. Events that nobody takes are dropped when their turn comes; so are all while the chart does not run.
    pub fn dispatch(&mut self, event: EventId) {
        self.arrive(event.into());
    }

    fn arrive(&mut self, event: Incoming) {
        if self.run.status == Status::Running {
            self.run.queues.arrive(event);
        }
    }

    /// Notes an event by its name, and says whether any expression of the chart names it. One that none names can still be taken by
    /// `*` and `not e` (traces call it `?`), or by what names the first tokens of its name ([`Chart::event`]).
    pub fn dispatch_name(&mut self, name: &str) -> bool {
        self.dispatch_with(name, 0)
    }

    /// Notes an event by its name like [`dispatch_name`](Machine::dispatch_name), with a number of the caller's own, which
    /// [`Host::offered`] is told when the event's turn has come.
    #[inline(never)] // a search among names: callers who have an `EventId` beside it need not pay for its registers
    pub fn dispatch_with(&mut self, name: &str, token: u64) -> bool {
        let (event, is_known) = self.chart.event(name);
        self.arrive(Incoming { event, expiry: None, token, is_known });
        is_known
    }

    /// Raises an event from outside a step, as an action does within: the next step offers it before what has arrived. The number is the
    /// caller's own, as with [`dispatch_with`](Machine::dispatch_with).
    pub fn raise_with(&mut self, name: &str, token: u64) -> bool {
        let (event, is_known) = self.chart.event(name);
        if self.run.status == Status::Running {
            self.run.is_settled = false;
            self.run.raise(&self.chart, event, is_known, token);
        }
        is_known
    }

    /// Notes that messages of the own host have arrived on a topic: each is one occurrence for triggers that name the message, and guards
    /// that read the topic will be read again.
    pub fn message_arrived(&mut self, topic: TopicId, count: usize) {
        self.arrived(topic, count, |events| events.message(topic));
    }

    /// The same for messages of another host: they are occurrences for triggers that name that host, and for no others.
    pub fn message_arrived_from(&mut self, host: &str, topic: TopicId, count: usize) {
        self.arrived(topic, count, |events| events.message_of(host, topic));
    }

    fn arrived(&mut self, topic: TopicId, count: usize, event: impl Fn(&EventTable) -> Option<EventId>) {
        if self.run.status != Status::Running || count == 0 || !self.reads_topic(topic) {
            return;
        }
        self.run.due = true;
        self.run.topic_changed(&self.chart, topic, None);
        if let Some(event) = event(self.chart.events()) {
            for _ in 0..count {
                self.run.queues.arrive(event.into());
            }
        }
    }

    /// Notes that an activity has returned, which frees its region. Says whether it was running: a return after
    /// [`stop`](Machine::stop) is not for this run.
    pub fn activity_returned(&mut self, activation: Activation, outcome: Outcome) -> bool {
        self.run.is_settled = false;
        self.run.activity_returned(&self.chart, activation, outcome)
    }

    /// Notes that an activity that was [`Ongoing`](Outcome::Ongoing) or [failed](Outcome::Failed) is called again, which locks its region. Says
    /// whether it may: if its state has been left or is about to be, it must not be called again.
    pub fn activity_resumed(&mut self, activation: Activation) -> bool {
        self.run.is_settled = false;
        self.run.activity_resumed(&self.chart, activation)
    }

    /// Makes one run-to-completion step: delivers messages; takes transitions until none is enabled, first those without a trigger, then
    /// those of raised events, then those of one arrived event after the other; publishes what was written; starts the
    /// activities of the states that were entered. A machine that is not running does nothing.
    ///
    /// A clock that runs backwards stands still for the machine.
    ///
    /// # Errors
    /// When the chart never comes to rest, or cannot go on at a CHOICE ([`MachineErrorKind`]). It is stopped then, and shows the
    /// configuration before the micro-step that went wrong or would have been one too many.
    pub fn run_to_completion(
        &mut self,
        now: Moment,
        host: &mut impl Host,
    ) -> Result<StepSummary, MachineError> {
        if self.run.is_settled {
            self.run.now = self.run.now.max(now);
            direct::run(&self.chart, &mut self.run, host)
        } else if self.advance_to(now) {
            self.step(host).run()
        } else {
            Ok(StepSummary::default())
        }
    }

    /// Notes an event and makes the step: [`dispatch`](Machine::dispatch) and [`run_to_completion`](Machine::run_to_completion) in one,
    /// and quicker, since an event for which nothing else is in the way need not wait in a queue.
    ///
    /// # Errors
    /// As [`run_to_completion`](Machine::run_to_completion).
    pub fn handle(
        &mut self,
        event: EventId,
        now: Moment,
        host: &mut impl Host,
    ) -> Result<StepSummary, MachineError> {
        if self.run.is_settled {
            self.run.now = self.run.now.max(now);
            return direct::handle(&self.chart, &mut self.run, host, event);
        }
        self.dispatch(event);
        self.run_to_completion(now, host)
    }

    /// Makes one micro-step of a run-to-completion step: the first, or the next of the step that is under way. The call that finds
    /// nothing more to be taken ends the step. So a step is
    /// `while machine.micro_step(now, host)? == MicroStep::Made {}`, and [`run_to_completion`](Machine::run_to_completion) takes what is left
    /// of one in one go.
    ///
    /// Time stands still while a step is under way: only the first call's `now` counts. It is meant for debuggers, which look at the
    /// machine between the calls; events and returns of activities are better told to it when the step has ended.
    ///
    /// # Errors
    /// As [`run_to_completion`](Machine::run_to_completion).
    pub fn micro_step(&mut self, now: Moment, host: &mut impl Host) -> Result<MicroStep, MachineError> {
        match self.advance_to(now) {
            true => self.step(host).run_one(),
            false => Ok(MicroStep::AtRest(StepSummary::default())),
        }
    }

    /// Whether a step has begun with [`micro_step`](Machine::micro_step) and not ended.
    pub fn is_mid_step(&self) -> bool {
        self.run.under_way.is_some()
    }

    /// Brings the time of a new step to the machine; says whether there is a step to be made.
    fn advance_to(&mut self, now: Moment) -> bool {
        if self.is_mid_step() {
            return true;
        }
        if self.run.status != Status::Running {
            return false;
        }
        self.run.now = self.run.now.max(now);
        true
    }

    /// Whether a step now could do anything.
    pub fn needs_step(&self, now: Moment) -> bool {
        if self.is_mid_step() {
            return true;
        }
        let due = || {
            self.run.due
                || self.run.queues.is_waiting()
                || !self.run.completions.is_empty()
                || self.next_deadline().is_some_and(|next| next <= now)
        };
        self.run.status == Status::Running && due()
    }

    /// When the next timer expires, if one is set.
    pub fn next_deadline(&self) -> Option<Moment> {
        if self.run.status == Status::Running { self.run.timers.next_deadline() } else { None }
    }

    /// When a timer of a blackboard is over, or since when it is; none if it is not set.
    pub fn deadline(&self, region: RegionId, timer: &str) -> Option<Moment> {
        let place = self.chart.timers().position(|(board, name)| board == region && name == timer)?;
        self.run.timers.slots.get(place).copied().flatten().map(|deadline| deadline.moment)
    }

    /// Whether a message on that topic can change what the chart does: then it must be told of each
    /// ([`message_arrived`](Machine::message_arrived)).
    pub fn reads_topic(&self, topic: TopicId) -> bool {
        self.chart.reads().binary_search(&topic).is_ok()
    }

    /// What it is doing.
    pub fn status(&self) -> Status {
        self.run.status
    }

    /// Whether the root has reached its END.
    pub fn is_finished(&self) -> bool {
        self.run.status == Status::Finished
    }

    /// The active nodes in the order of the document, composites before what is in them.
    pub fn configuration(&self) -> Vec<NodeId> {
        let layout = &self.chart.layout;
        let mut places: Vec<_> =
            layout.places().filter(|&place| self.run.active.contains(place.index())).collect();
        places.sort_by_key(|&place| layout.rank(place));
        places.into_iter().map(|place| layout.node(place)).collect()
    }

    /// Whether a node is active.
    pub fn is_active(&self, node: NodeId) -> bool {
        self.chart.layout.place(node).is_some_and(|place| self.run.active.contains(place.index()))
    }

    /// Whether a region itself holds a running activity: then it does not step, and nothing is delivered to its blackboard.
    pub fn is_running(&self, region: RegionId) -> bool {
        self.run.running_regions.contains(region.index())
    }

    fn step<'a, H: Host>(&'a mut self, host: &'a mut H) -> Step<'a, H> {
        Step::new(&self.chart, &mut self.run, host)
    }
}
