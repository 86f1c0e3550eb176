//! Compiles a syntax tree: resolves every name and checks every type once.

mod check;
mod event;
mod message;
mod name_context;

use std::time::Duration;

use super::eval_context::{Origin, TimerId};
use super::ir::{Guard, Operand};
use super::names::{EventId, EventInterner, NameScope, ScriptId};
use super::syntax::{Action, ActionKind, Expression, Path, TransitionExpression, Trigger};
use crate::diagnostic::Diagnostic;
use crate::vocabulary::{FieldId, TopicId};
use name_context::NameContext;

/// The compiled part, or all diagnostics.
type CompileResult<T> = Result<T, Vec<Diagnostic>>;

/// Minimum delay of a timer: a timer that expires at once would keep a chart from becoming stable.
const SHORTEST_DELAY: Duration = Duration::from_millis(1);

/// A compiled transition expression.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct CompiledTransition {
    /// The events that trigger it; `None` for a transition without trigger.
    pub trigger: Option<CompiledTrigger>,
    /// The condition that enables it.
    pub guard: Option<Guard>,
    /// The actions, in order.
    pub effects: Box<[Effect]>,
}

/// The events that trigger a transition.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum CompiledTrigger {
    /// Any event.
    Any,
    /// One of these events.
    OneOf(Box<[EventId]>),
    /// Any event except this one.
    Not(EventId),
}

impl CompiledTrigger {
    /// Whether an event matches the trigger.
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
    /// Sets a field of the message that is published on a topic at the end of the step.
    Assign {
        /// The topic.
        topic: TopicId,
        /// The field; the path leads through nested messages.
        field: Box<[FieldId]>,
        /// The new value.
        value: Operand,
    },
    /// Publishes the message of a topic, even if no field was assigned.
    Publish {
        /// The topic.
        topic: TopicId,
    },
    /// Delivers the messages that have arrived to this blackboard.
    ProcessMessages,
    /// Publishes all written messages immediately.
    PublishAll,
    /// Sets the deadline of a timer to now + `delay`.
    StartTimeout {
        /// The timer.
        timer: TimerId,
        /// At least one millisecond.
        delay: Duration,
    },
    /// Raises an event.
    Raise {
        /// The event.
        event: EventId,
    },
    /// Executes a script in the language of the host.
    Script {
        /// The text.
        script: ScriptId,
    },
}

impl TransitionExpression {
    /// Compiles the expression: resolves every name and checks every type.
    ///
    /// # Errors
    /// All errors found, each with its position.
    pub fn compile(&self, names: &mut NameScope<'_>) -> Result<CompiledTransition, Vec<Diagnostic>> {
        let scope = NameContext::new(names);
        let compiled = self.compile_in(&scope, names.events);
        scope.close(names);
        compiled
    }

    fn compile_in(
        &self,
        scope: &NameContext<'_>,
        events: &mut EventInterner,
    ) -> CompileResult<CompiledTransition> {
        let trigger =
            self.trigger.as_ref().map(|trigger| compile_trigger(trigger, scope, events)).transpose();
        let guard = self.guard.as_ref().map(|guard| compile_guard(guard, scope)).transpose();
        let effects = collect(self.actions.iter().map(|action| effect(action, scope, events)));
        let ((trigger, guard), effects) = both(both(trigger, guard), effects)?;
        Ok(CompiledTransition { trigger, guard, effects: effects.into() })
    }
}

/// Compiles the entry or exit actions of a state, as [`TransitionExpression::compile`] does for
/// those of a transition.
///
/// # Errors
/// All errors found, each with its position.
pub fn compile_actions(
    actions: &[Action],
    names: &mut NameScope<'_>,
) -> Result<Box<[Effect]>, Vec<Diagnostic>> {
    let scope = NameContext::new(names);
    let effects = collect(actions.iter().map(|action| effect(action, &scope, names.events)));
    scope.close(names);
    Ok(effects?.into())
}

fn compile_trigger(
    trigger: &Trigger,
    scope: &NameContext<'_>,
    events: &mut EventInterner,
) -> CompileResult<CompiledTrigger> {
    Ok(match trigger {
        Trigger::Any => CompiledTrigger::Any,
        Trigger::Not(event) => CompiledTrigger::Not(scope.event(event, events)?),
        Trigger::OneOf(alternatives) => {
            let alternatives = collect(alternatives.iter().map(|event| scope.event(event, events)))?;
            CompiledTrigger::OneOf(alternatives.into())
        }
    })
}

fn compile_guard(guard: &Expression, scope: &NameContext<'_>) -> CompileResult<Guard> {
    Ok(Guard::new(scope.test(guard)?))
}

fn effect(action: &Action, scope: &NameContext<'_>, events: &mut EventInterner) -> CompileResult<Effect> {
    match &action.kind {
        ActionKind::Assign { target, value } => assign(target, value, scope),
        ActionKind::Publish(message) => publish(message, scope),
        ActionKind::ProcessMessages => Ok(Effect::ProcessMessages),
        ActionKind::PublishAll => Ok(Effect::PublishAll),
        ActionKind::StartTimeout { timer, delay, .. } => start_timeout(timer, *delay, action, scope),
        ActionKind::Raise(event) => Ok(Effect::Raise { event: scope.raised_event(event, events)? }),
        ActionKind::Script(text) => Ok(Effect::Script { script: scope.script(text, action.position.0)? }),
    }
}

fn assign(target: &Path, value: &Expression, scope: &NameContext<'_>) -> CompileResult<Effect> {
    let (source, fields) = scope.message(target)?;
    refuse_foreign(target, &source.origin, "assigned")?;
    let (field, kind) = scope.fields(source.entry, fields)?;
    if field.is_empty() {
        let message = format!("`{target}` is a whole message; an assignment sets one field");
        let diagnostic = Diagnostic::error("E0145", target.position.0, message);
        return Err(vec![diagnostic.with_hint(scope.fields_hint(target, source.entry))]);
    }
    let value = scope.term_of(value, &kind)?;
    Ok(Effect::Assign { topic: source.entry.id, field, value: Operand::new(value) })
}

fn publish(message: &Path, scope: &NameContext<'_>) -> CompileResult<Effect> {
    let (source, fields) = scope.message(message)?;
    refuse_foreign(message, &source.origin, "published")?;
    if let Some(field) = fields.first() {
        let text = format!("`{}` follows the message; a message is published as a whole", field.text);
        return Err(vec![
            Diagnostic::error("E0145", field.position.0, text).with_hint("assign the field first"),
        ]);
    }
    Ok(Effect::Publish { topic: source.entry.id })
}

/// Only messages of the own host can be written.
fn refuse_foreign(path: &Path, origin: &Origin, verb: &str) -> CompileResult<()> {
    if *origin == Origin::Own {
        return Ok(());
    }
    let message = format!("`{path}` is a variable of another publisher and cannot be {verb} by a chart");
    let hint = "a chart writes only its own messages: remove the prefix of the message";
    Err(vec![Diagnostic::error("E0142", path.position.0, message).with_hint(hint)])
}

fn start_timeout(
    timer: &Path,
    delay: Duration,
    action: &Action,
    scope: &NameContext<'_>,
) -> CompileResult<Effect> {
    if delay < SHORTEST_DELAY {
        let diagnostic = Diagnostic::error(
            "E0143",
            action.position.0,
            format!("the delay of timer `{timer}` is too short"),
        );
        return Err(vec![diagnostic.with_hint("a delay is at least `1ms`")]);
    }
    match scope.timer(timer) {
        Some(timer) => Ok(Effect::StartTimeout { timer, delay }),
        None => {
            let message = format!("the timer `{timer}` is not one of this blackboard");
            let hint = "a timer belongs to the blackboard of the transitions that start it";
            Err(vec![Diagnostic::error("E0141", timer.position.0, message).with_hint(hint)])
        }
    }
}

/// All results, or all diagnostics.
fn collect<T>(results: impl Iterator<Item = CompileResult<T>>) -> CompileResult<Vec<T>> {
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

/// Both results, or all diagnostics.
fn both<A, B>(first: CompileResult<A>, second: CompileResult<B>) -> CompileResult<(A, B)> {
    match (first, second) {
        (Ok(first), Ok(second)) => Ok((first, second)),
        (Err(mut first), Err(mut second)) => {
            first.append(&mut second);
            Err(first)
        }
        (Err(wrong), Ok(_)) | (Ok(_), Err(wrong)) => Err(wrong),
    }
}
