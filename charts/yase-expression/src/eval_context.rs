//! The values that a compiled expression reads during evaluation.

use std::borrow::Cow;

use super::names::ScriptId;
use crate::node_id::NodeId;
use crate::vocabulary::{FieldId, FunctionId, TopicId, Value};

/// The data that a guard reads: one blackboard, its timers and the active states.
///
/// All values of one evaluation must be consistent: a guard reads the data as it was at the
/// beginning of its step.
pub trait EvalContext {
    /// A field of the latest message of a source; the path leads through nested messages.
    /// [`Value::Missing`] if no message has arrived.
    fn field(&self, source: &MessageSource, path: &[FieldId]) -> Value<'_>;

    /// The latest message of a source as a whole: [`Value::Message`], or [`Value::Missing`] if none
    /// has arrived.
    fn message(&self, source: &MessageSource) -> Value<'_>;

    /// The result of a function, which depends only on its arguments. No argument is
    /// [`Value::Missing`].
    ///
    /// # Errors
    /// The error of the function; the guard then counts as false and raises an error event.
    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError>;

    /// The state of a timer of this blackboard.
    fn timer(&self, timer: TimerId) -> TimerState;

    /// Whether a state is active.
    fn is_active(&self, state: NodeId) -> bool;

    /// The value of a condition in the language of the host.
    ///
    /// # Errors
    /// The error of the script. The default implementation always fails, since there is no such
    /// language.
    fn script(&self, script: ScriptId) -> Result<bool, CallError> {
        let _ = script;
        Err(CallError::new("there are no scripts here"))
    }
}

/// A topic and the origin of its messages.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct MessageSource {
    /// The topic.
    pub topic: TopicId,
    /// The origin of its messages.
    pub origin: Origin,
}

/// Origin of messages.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
#[non_exhaustive]
pub enum Origin {
    /// Any publisher of this host: `Ball.distance`.
    Own,
    /// Any publisher of the host with this name: `striker.worldstate.State.Ball.distance`.
    Host(Box<str>),
    /// A publisher of this host, an activity or the path of a state: `Vision.Ball.distance`.
    Publisher(Box<str>),
    /// A publisher of another host: `striker.Vision.Ball.distance`.
    HostPublisher {
        /// The other host's name.
        host: Box<str>,
        /// The publisher's name there.
        publisher: Box<str>,
    },
}

/// A timer, the index of its name in [`NameScope::timers`](super::NameScope::timers).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TimerId(pub u32);

/// State of a timer.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum TimerState {
    /// It was never started.
    Unset,
    /// Its deadline is in the future.
    Running,
    /// Its deadline has been reached.
    Over,
}

/// Why a function returned no result.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("{reason}")]
pub struct CallError {
    reason: Cow<'static, str>,
}

impl CallError {
    /// A failed call and its reason: lower case, without a full stop.
    pub fn new(reason: impl Into<Cow<'static, str>>) -> CallError {
        CallError { reason: reason.into() }
    }
}
