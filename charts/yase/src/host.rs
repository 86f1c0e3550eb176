//! The interface between a machine and its environment.

use std::any::Any;

use crate::compile::CompiledChart;
use crate::expression::{CallError, EventId, GuardError, MessageSource, ScriptId};
use crate::ids::{ActionLocation, Activation, ScopeId};
use crate::script::{ActiveStates, ScriptContext};
use crate::statechart::{NodeId, TransitionId};
use crate::trace::TraceRecord;
use crate::vocabulary::{FieldId, FunctionId, TopicId, Value};

/// The environment of a [`Machine`](crate::Machine): blackboards, activities and listeners.
///
/// The machine calls these methods only during [`start`](crate::Machine::start),
/// [`stop`](crate::Machine::stop) and [`run_to_completion`](crate::Machine::run_to_completion),
/// always on the caller's thread. The default implementations describe an environment without
/// messages, functions or listeners; a host with blackboards overrides all of them.
pub trait Host {
    /// A field of the latest message of a source on a blackboard; [`Value::Missing`] if none has
    /// arrived.
    ///
    /// A blackboard is also read while an activity of its scope runs, to decide whether an event is
    /// held: it then shows the values it had when the activity began.
    fn field(&self, region: ScopeId, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        let _ = (region, source, path);
        Value::Missing
    }

    /// The latest message of a source on a blackboard; [`Value::Missing`] if none has arrived.
    fn message(&self, region: ScopeId, source: &MessageSource) -> Value<'_> {
        let _ = (region, source);
        Value::Missing
    }

    /// The result of a function, which depends on its arguments only.
    ///
    /// # Errors
    /// When the function fails: the guard then counts as false.
    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        let _ = (function, arguments);
        Err(CallError::new("this host has no functions"))
    }

    /// Evaluates a condition in the host's own language; called only if the type environment
    /// declares [scripts](crate::TypeEnvironment::scripts). Its text is that of
    /// [`CompiledChart::script`].
    ///
    /// # Errors
    /// When the condition has no value: the guard then counts as false.
    fn condition(
        &self,
        script: ScriptId,
        region: ScopeId,
        states: &ActiveStates<'_>,
    ) -> Result<bool, CallError> {
        let _ = (script, region, states);
        Err(CallError::new("this host has no scripts"))
    }

    /// Executes an action in the host's own language.
    ///
    /// # Errors
    /// When the action fails.
    fn perform(
        &mut self,
        script: ScriptId,
        region: ScopeId,
        performance: &mut ScriptContext<'_>,
    ) -> Result<(), CallError> {
        let _ = (script, region, performance);
        Err(CallError::new("this host has no scripts"))
    }

    /// An event is about to be offered to the configuration, before guards are evaluated: once per
    /// micro-step with an event. `is_known` is false if no expression names the event: it is then
    /// the event that an expression names by its first tokens
    /// ([`EventMatching::TokenPrefix`](crate::EventMatching::TokenPrefix)), or `?`. The token is
    /// that of [`dispatch_with`](crate::Machine::dispatch_with) or [`ScriptContext::raise`], 0 for
    /// other events.
    fn event_taken_from_queue(&mut self, event: EventId, is_known: bool, token: u64) {
        let _ = (event, is_known, token);
    }

    /// Delivers arrived messages to a blackboard. At the beginning of a step this applies to every
    /// blackboard whose scope runs no activity; within a step only to those where an action calls
    /// `process_messages`.
    fn deliver(&mut self, region: ScopeId) {
        let _ = region;
    }

    /// A region is entered: its blackboard takes over the values of the enclosing one.
    fn inherit(&mut self, region: ScopeId, from: ScopeId) {
        let _ = (region, from);
    }

    /// Sets a field of the message to be published on a topic: of the newest message on the
    /// blackboard, or of the type's default if there is none. This blackboard shows the change at
    /// once, others after publication and delivery.
    ///
    /// # Errors
    /// When the field cannot hold the value; nothing is changed then.
    fn assign(
        &mut self,
        region: ScopeId,
        topic: TopicId,
        path: &[FieldId],
        value: Value<'_>,
    ) -> Result<(), CallError> {
        let _ = (region, topic, path, value);
        Err(CallError::new("this host has no messages"))
    }

    /// Changes the message to be published on a topic, as [`assign`](Host::assign) does, by a
    /// function of a generated chart that receives the message itself.
    ///
    /// # Errors
    /// The error of the function; nothing is changed then.
    fn edit(
        &mut self,
        region: ScopeId,
        topic: TopicId,
        change: &mut dyn FnMut(&mut dyn Any) -> Result<(), CallError>,
    ) -> Result<(), CallError> {
        let _ = (region, topic, change);
        Err(CallError::new("this host has no messages"))
    }

    /// Publishes the message of a topic at the end of the step even if nothing was assigned.
    fn publish(&mut self, region: ScopeId, topic: TopicId) {
        let _ = (region, topic);
    }

    /// Publishes the assignments of a blackboard: at the end of a step, or where an action calls
    /// `publish_all`. Published messages arrive like any other: the host reports them with
    /// [`message_arrived`](crate::Machine::message_arrived).
    fn publish_all(&mut self, region: ScopeId) {
        let _ = region;
    }

    /// Starts an activity. The host reports its return later with
    /// [`activity_returned`](crate::Machine::activity_returned), never from within this call. The
    /// machine calls this at the end of the step that entered the state.
    fn start(&mut self, activation: Activation);

    /// Requests a running activity to return soon; its return is reported as usual. After
    /// [`stop`](crate::Machine::stop) the return is ignored.
    fn cancel(&mut self, activation: Activation);

    /// An activity that waited between two calls is not called again, since its state is being
    /// left.
    fn stop(&mut self, activation: Activation);

    /// Whether [`trace`](Host::trace) is to be called; queried once per step.
    fn wants_trace(&self) -> bool {
        false
    }

    /// A micro-step has happened, or the chart was started already.
    fn trace(&mut self, chart: &CompiledChart, record: &TraceRecord<'_>) {
        let _ = (chart, record);
    }

    /// Reports a problem in the execution of the chart.
    fn report(&mut self, chart: &CompiledChart, report: Notice<'_>) {
        let _ = (chart, report);
    }
}

/// The outcome of a call of an activity.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Outcome {
    /// It has finished: the state is complete.
    Done,
    /// It is to be called again: the state is not complete, but its scope may take transitions
    /// meanwhile. Each further call begins with
    /// [`activity_resumed`](crate::Machine::activity_resumed).
    Ongoing,
    /// It failed: the state is not complete, and `error.activity` is raised.
    Failed,
}

/// A problem passed to [`Host::report`].
#[derive(Clone, Copy, PartialEq, Debug)]
#[non_exhaustive]
pub enum Notice<'a> {
    /// A guard has no value; it counts as false, and `error.guard` is raised. Reported once until
    /// the guard has succeeded or its inputs have changed.
    GuardFailed {
        /// The segment.
        transition: TransitionId,
        /// The cause.
        error: &'a GuardError,
    },
    /// An action failed; the following ones are executed, and `error.action` is raised.
    ActionFailed {
        /// The location of the action list.
        location: ActionLocation,
        /// The index in that list, from 0.
        index: usize,
        /// The cause.
        error: &'a ActionError,
    },
    /// No transition out of a START is enabled: the composite remains there. Reported once per
    /// entry.
    StartWaits {
        /// The START.
        start: NodeId,
    },
}

/// Why an action failed.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ActionError {
    /// The expression has no value.
    #[error(transparent)]
    Value(#[from] GuardError),
    /// The value depends on a message that has not arrived.
    #[error("the value depends on a message that has not arrived")]
    Missing,
    /// The host refused the assignment.
    #[error("the value cannot be assigned: {0}")]
    Refused(#[from] CallError),
    /// The host could not execute a script.
    #[error("the script failed: {0}")]
    Script(#[source] CallError),
}
