//! From a syntax tree to a program: every name is looked up and every type checked, once.

mod check;
mod event;
mod message;
mod scope;

use std::time::Duration;

use super::facts::{Origin, TimerId};
use super::names::{EventId, EventTable, Names, ScriptId};
use super::program::{Guard, Operand};
use super::syntax::{Action, ActionKind, Expression, Path, TransitionExpression, Trigger};
use crate::diagnostic::Diagnostic;
use crate::vocabulary::{FieldId, TopicId};
use scope::Scope;

/// What was compiled, or everything that is wrong with it.
type Checked<T> = Result<T, Vec<Diagnostic>>;

/// A timer must run at least this long: an instant one would keep a chart from coming to rest.
const SHORTEST_DELAY: Duration = Duration::from_millis(1);

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
    /// Do what a text in the host's own language says.
    Script {
        /// The text.
        script: ScriptId,
    },
}

impl TransitionExpression {
    /// Looks up every name, checks every type, and makes the expression ready to run.
    ///
    /// # Errors
    /// Everything that is wrong, each with its place.
    pub fn compile(&self, names: &mut Names<'_>) -> Result<CompiledTransition, Vec<Diagnostic>> {
        let scope = Scope::new(names);
        let compiled = self.compile_in(&scope, names.events);
        scope.close(names);
        compiled
    }

    fn compile_in(&self, scope: &Scope<'_>, events: &mut EventTable) -> Checked<CompiledTransition> {
        let trigger =
            self.trigger.as_ref().map(|trigger| compile_trigger(trigger, scope, events)).transpose();
        let guard = self.guard.as_ref().map(|guard| compile_guard(guard, scope)).transpose();
        let effects = collect(self.actions.iter().map(|action| effect(action, scope, events)));
        let ((trigger, guard), effects) = both(both(trigger, guard), effects)?;
        Ok(CompiledTransition { trigger, guard, effects: effects.into() })
    }
}

/// Compiles the actions of the entry or the exit of a state, as [`TransitionExpression::compile`] does those
/// of a transition.
///
/// # Errors
/// Everything that is wrong, each with its place.
pub fn compile_actions(actions: &[Action], names: &mut Names<'_>) -> Result<Box<[Effect]>, Vec<Diagnostic>> {
    let scope = Scope::new(names);
    let effects = collect(actions.iter().map(|action| effect(action, &scope, names.events)));
    scope.close(names);
    Ok(effects?.into())
}

fn compile_trigger(
    trigger: &Trigger,
    scope: &Scope<'_>,
    events: &mut EventTable,
) -> Checked<CompiledTrigger> {
    Ok(match trigger {
        Trigger::Any => CompiledTrigger::Any,
        Trigger::Not(event) => CompiledTrigger::Not(scope.event(event, events)?),
        Trigger::OneOf(alternatives) => {
            let alternatives = collect(alternatives.iter().map(|event| scope.event(event, events)))?;
            CompiledTrigger::OneOf(alternatives.into())
        }
    })
}

fn compile_guard(guard: &Expression, scope: &Scope<'_>) -> Checked<Guard> {
    Ok(Guard::new(scope.test(guard)?))
}

fn effect(action: &Action, scope: &Scope<'_>, events: &mut EventTable) -> Checked<Effect> {
    match &action.kind {
        ActionKind::Assign { target, value } => assign(target, value, scope),
        ActionKind::Publish(message) => publish(message, scope),
        ActionKind::ProcessMessages => Ok(Effect::ProcessMessages),
        ActionKind::PublishAll => Ok(Effect::PublishAll),
        ActionKind::StartTimeout { timer, delay, .. } => start_timeout(timer, *delay, action, scope),
        ActionKind::Raise(event) => Ok(Effect::Raise { event: scope.raised_event(event, events)? }),
        ActionKind::Script(text) => Ok(Effect::Script { script: scope.script(text, action.place.0)? }),
    }
}

fn assign(target: &Path, value: &Expression, scope: &Scope<'_>) -> Checked<Effect> {
    let (source, fields) = scope.message(target)?;
    refuse_foreign(target, &source.origin, "assigned")?;
    let (field, kind) = scope.fields(source.entry, fields)?;
    if field.is_empty() {
        let message = format!("`{target}` is a whole message; an assignment sets one field");
        let diagnostic = Diagnostic::error("E0145", target.place.0, message);
        return Err(vec![diagnostic.with_hint(scope.fields_hint(target, source.entry))]);
    }
    let value = scope.term_of(value, &kind)?;
    Ok(Effect::Assign { topic: source.entry.id, field, value: Operand::new(value) })
}

fn publish(message: &Path, scope: &Scope<'_>) -> Checked<Effect> {
    let (source, fields) = scope.message(message)?;
    refuse_foreign(message, &source.origin, "published")?;
    if let Some(field) = fields.first() {
        let text = format!("`{}` follows the message; a message is published as a whole", field.text);
        return Err(vec![
            Diagnostic::error("E0145", field.place.0, text).with_hint("assign the field first"),
        ]);
    }
    Ok(Effect::Publish { topic: source.entry.id })
}

/// Only this host's own messages are written.
fn refuse_foreign(path: &Path, origin: &Origin, verb: &str) -> Checked<()> {
    if *origin == Origin::Own {
        return Ok(());
    }
    let message = format!("`{path}` is another's variable and cannot be {verb} by a chart");
    let hint = "a chart writes its own messages only: leave out what stands before the message";
    Err(vec![Diagnostic::error("E0142", path.place.0, message).with_hint(hint)])
}

fn start_timeout(timer: &Path, delay: Duration, action: &Action, scope: &Scope<'_>) -> Checked<Effect> {
    if delay < SHORTEST_DELAY {
        let diagnostic =
            Diagnostic::error("E0143", action.place.0, format!("the delay of timer `{timer}` is too short"));
        return Err(vec![diagnostic.with_hint("a delay is at least `1ms`")]);
    }
    match scope.timer(timer) {
        Some(timer) => Ok(Effect::StartTimeout { timer, delay }),
        None => {
            let message = format!("the timer `{timer}` is not one of this blackboard");
            let hint = "a timer belongs to the blackboard of the transitions that start it";
            Err(vec![Diagnostic::error("E0141", timer.place.0, message).with_hint(hint)])
        }
    }
}

/// All results, or all that went wrong.
fn collect<T>(results: impl Iterator<Item = Checked<T>>) -> Checked<Vec<T>> {
    let mut values = Vec::new();
    let mut diagnostics = Vec::new();
    for result in results {
        match result {
            Ok(value) => values.push(value),
            Err(mut wrong) => diagnostics.append(&mut wrong),
        }
    }
    if diagnostics.is_empty() { Ok(values) } else { Err(diagnostics) }
}

/// Both results, or all that went wrong.
fn both<A, B>(first: Checked<A>, second: Checked<B>) -> Checked<(A, B)> {
    match (first, second) {
        (Ok(first), Ok(second)) => Ok((first, second)),
        (Err(mut first), Err(mut second)) => {
            first.append(&mut second);
            Err(first)
        }
        (Err(wrong), Ok(_)) | (Ok(_), Err(wrong)) => Err(wrong),
    }
}
