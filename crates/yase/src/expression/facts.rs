//! What a compiled expression asks while it is evaluated, and of whom.

use std::borrow::Cow;

use super::names::ScriptId;
use crate::statechart::NodeId;
use crate::vocabulary::{FieldId, FunctionId, TopicId, Value};

/// The world as a guard sees it: one blackboard, its timers, and the active states.
///
/// The answers of one evaluation must belong to one moment: a guard sees the data of the beginning of its
/// step.
pub trait Facts {
    /// A field of the latest message of a source; the path leads through nested messages. [`Value::Missing`]
    /// if no message has arrived.
    fn field(&self, source: &MessageSource, path: &[FieldId]) -> Value<'_>;

    /// The latest message of a source as a whole: [`Value::Message`], or [`Value::Missing`] if none has
    /// arrived.
    fn message(&self, source: &MessageSource) -> Value<'_>;

    /// The result of a function, which depends on its arguments only. None of them is [`Value::Missing`].
    ///
    /// # Errors
    /// Whatever the function itself cannot do; the guard then counts as false and raises an error event.
    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError>;

    /// How far a timer of this blackboard is.
    fn timer(&self, timer: TimerId) -> TimerState;

    /// Whether a state is active.
    fn is_active(&self, state: NodeId) -> bool;

    /// What a condition in the host's own language says.
    ///
    /// # Errors
    /// Whatever keeps it from having a value; without a body of its own, that there is no such language.
    fn script(&self, script: ScriptId) -> Result<bool, CallError> {
        let _ = script;
        Err(CallError::new("there are no scripts here"))
    }
}

/// Whose messages of a topic are meant.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct MessageSource {
    /// The topic.
    pub topic: TopicId,
    /// Where its messages come from.
    pub origin: Origin,
}

/// Where messages come from.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
#[non_exhaustive]
pub enum Origin {
    /// This host, whoever publishes: `Ball.distance`.
    Own,
    /// The host of that name, whoever publishes there: `striker.worldstate.State.Ball.distance`.
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

/// A timer, by the place of its name in [`Names::timers`](super::Names::timers).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct TimerId(pub u32);

/// How far a timer is.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum TimerState {
    /// It was never started.
    Unset,
    /// Its deadline is still to come.
    Running,
    /// Its deadline has been reached.
    Over,
}

/// Why a function gave no result.
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
