//! What a machine knows of its world.

use std::any::Any;

use crate::chart::{Chart, RegionId};
use crate::expression::{CallError, EventId, GuardError, MessageSource, ScriptId};
use crate::machine::{Performance, States};
use crate::statechart::{NodeId, TransitionId};
use crate::trace::TraceRecord;
use crate::vocabulary::{FieldId, FunctionId, TopicId, Value};

/// The world of a [`Machine`](crate::Machine): blackboards, activities and listeners.
///
/// The machine calls these methods during [`start`](crate::Machine::start), [`stop`](crate::Machine::stop) and
/// [`run_to_completion`](crate::Machine::run_to_completion), never otherwise, and always on the caller's thread. What has a body here
/// answers for a world without messages, functions or listeners; whoever has blackboards replaces all of it.
pub trait Host {
    /// A field of the latest message of a source on a blackboard; [`Value::Missing`] if none has arrived.
    ///
    /// A blackboard is also read while the activity of its region runs, to see whether an event is one to be held: it shows then what it
    /// showed when the activity began.
    fn field(&self, region: RegionId, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        let _ = (region, source, path);
        Value::Missing
    }

    /// The latest message of a source on a blackboard; [`Value::Missing`] if none has arrived.
    fn message(&self, region: RegionId, source: &MessageSource) -> Value<'_> {
        let _ = (region, source);
        Value::Missing
    }

    /// The result of a function, which depends on its arguments only.
    ///
    /// # Errors
    /// Whatever the function cannot do: the guard then counts as false.
    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        let _ = (function, arguments);
        Err(CallError::new("this host has no functions"))
    }

    /// What a condition in the host's own language says; asked only if the vocabulary says that there are
    /// [scripts](crate::Vocabulary::scripts). Its text is that of [`Chart::script`].
    ///
    /// # Errors
    /// Whatever keeps it from having a value: the guard then counts as false.
    fn condition(&self, script: ScriptId, region: RegionId, states: &States<'_>) -> Result<bool, CallError> {
        let _ = (script, region, states);
        Err(CallError::new("this host has no scripts"))
    }

    /// Does what an action in the host's own language says.
    ///
    /// # Errors
    /// Whatever keeps it from being done.
    fn perform(
        &mut self,
        script: ScriptId,
        region: RegionId,
        performance: &mut Performance<'_>,
    ) -> Result<(), CallError> {
        let _ = (script, region, performance);
        Err(CallError::new("this host has no scripts"))
    }

    /// An event is about to be offered to the configuration, before guards are read: once for each micro-step with an event. `is_known` is
    /// false if no expression names it: then it is the event of the first tokens of its name that one does name
    /// ([`EventMatching::TokenPrefix`](crate::EventMatching::TokenPrefix)), or `?`. The token is that of
    /// [`dispatch_with`](crate::Machine::dispatch_with) or [`Performance::raise`], 0 for whatever came otherwise.
    fn offered(&mut self, event: EventId, is_known: bool, token: u64) {
        let _ = (event, is_known, token);
    }

    /// Brings the messages that have arrived to a blackboard. At the beginning of a step this happens on every blackboard whose own region
    /// runs no activity; within a step only where an action says `process_messages`.
    fn deliver(&mut self, region: RegionId) {
        let _ = region;
    }

    /// A region is entered: its blackboard takes over the values of the one it lies in.
    fn inherit(&mut self, region: RegionId, from: RegionId) {
        let _ = (region, from);
    }

    /// Sets a field of the message that is to be published on a topic: of the newest message on the blackboard, or of the type's
    /// default if there is none. The blackboard itself shows it at once, others when it has been published and delivered.
    ///
    /// # Errors
    /// When the field cannot hold the value; nothing is changed then.
    fn assign(
        &mut self,
        region: RegionId,
        topic: TopicId,
        path: &[FieldId],
        value: Value<'_>,
    ) -> Result<(), CallError> {
        let _ = (region, topic, path, value);
        Err(CallError::new("this host has no messages"))
    }

    /// Changes the message that is to be published on a topic, as [`assign`](Host::assign) does, by a function of
    /// a [typed chart](crate::typed): it is given the message itself.
    ///
    /// # Errors
    /// What the function says; nothing is changed then.
    fn edit(
        &mut self,
        region: RegionId,
        topic: TopicId,
        change: &mut dyn FnMut(&mut dyn Any) -> Result<(), CallError>,
    ) -> Result<(), CallError> {
        let _ = (region, topic, change);
        Err(CallError::new("this host has no messages"))
    }

    /// Has the message of a topic published at the end of the step even if nothing was assigned.
    fn publish(&mut self, region: RegionId, topic: TopicId) {
        let _ = (region, topic);
    }

    /// Publishes what was assigned on a blackboard: at the end of a step, or where an action says `publish_all`. What is published
    /// arrives like any message: the host says so with [`message_arrived`](crate::Machine::message_arrived).
    fn publish_all(&mut self, region: RegionId) {
        let _ = region;
    }

    /// Begins to run an activity; its return is told with [`activity_returned`](crate::Machine::activity_returned), later and never from
    /// within. The machine calls this when the step that entered the state is over.
    fn start(&mut self, activation: Activation);

    /// Asks a running activity to return soon; its return is told as usual. After [`stop`](crate::Machine::stop) it is of no more
    /// interest.
    fn cancel(&mut self, activation: Activation);

    /// An activity that waited between two calls will not be called again, since its state is being left.
    fn stop(&mut self, activation: Activation);

    /// Whether [`trace`](Host::trace) is to be called; asked once a step.
    fn wants_trace(&self) -> bool {
        false
    }

    /// A micro-step has happened, or the chart has been started.
    fn trace(&mut self, chart: &Chart, record: &TraceRecord<'_>) {
        let _ = (chart, record);
    }

    /// Something happened that somebody should be told about.
    fn report(&mut self, chart: &Chart, report: Report<'_>) {
        let _ = (chart, report);
    }
}

/// One run of an activity, from the entry of its state until it has returned for good.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Activation {
    /// The BASIC state.
    pub node: NodeId,
    /// The blackboard it works on.
    pub region: RegionId,
    /// Counts the activations of a machine, so that no two are equal.
    pub number: u64,
}

/// How an activity returned.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Outcome {
    /// It has done its work: the state is complete.
    Done,
    /// It wants to be called again: the state is not complete, but its region may step meanwhile. Each further call begins with
    /// [`activity_resumed`](crate::Machine::activity_resumed).
    Ongoing,
    /// It failed: the state is not complete, and `error.activity` is raised.
    Failed,
}

/// What [`Host::report`] tells.
#[derive(Clone, Copy, PartialEq, Debug)]
#[non_exhaustive]
pub enum Report<'a> {
    /// A guard has no value; it counts as false, and `error.guard` is raised. Told once until it has succeeded or what it reads has
    /// changed.
    GuardFailed {
        /// The segment.
        transition: TransitionId,
        /// Why.
        error: &'a GuardError,
    },
    /// An action could not be done; those after it are, and `error.action` is raised.
    ActionFailed {
        /// Where it stands.
        place: ActionPlace,
        /// Its number there, from 0.
        index: usize,
        /// Why.
        error: &'a ActionError,
    },
    /// No way out of a START is open: the composite waits at its beginning. Told once for each entry.
    StartWaits {
        /// The START.
        start: NodeId,
    },
}

/// Where actions stand.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum ActionPlace {
    /// On a segment of a transition.
    Transition(TransitionId),
    /// At the entry of a node.
    Entry(NodeId),
    /// At the exit of a node.
    Exit(NodeId),
}

/// Why an action could not be done.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ActionError {
    /// Its value has none.
    #[error(transparent)]
    Value(#[from] GuardError),
    /// Its value depends on a message that has not arrived.
    #[error("the value depends on a message that has not arrived")]
    Missing,
    /// The host refused the assignment.
    #[error("the value cannot be assigned: {0}")]
    Refused(#[from] CallError),
    /// The host could not do what a script says.
    #[error("the script failed: {0}")]
    Script(#[source] CallError),
}
