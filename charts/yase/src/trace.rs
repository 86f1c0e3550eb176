//! The record of a micro-step.

use std::fmt;

use crate::compile::CompiledChart;
use crate::expression::EventId;
use crate::ids::{ActionLocation, CompoundTransitionId};
use crate::statechart::{NodeId, TransitionId};
use crate::timestamp::Timestamp;

/// One micro-step: the transitions taken and preempted, the states left and entered, the actions.
///
/// A record borrows the machine's buffers; to keep it, copy its fields or its text
/// ([`display`](TraceRecord::display)).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TraceRecord<'a> {
    /// The time of the step.
    pub time: Timestamp,
    /// The cause of the micro-step.
    pub cause: MicroStepCause,
    /// The compound transitions taken, in the order of execution.
    pub selected: &'a [CompoundTransitionId],
    /// The transitions that lost a conflict.
    pub preempted: &'a [CompoundTransitionId],
    /// The transitions that wait for running activities: their event is held, or, if they
    /// interrupt, they fire later.
    pub held: &'a [CompoundTransitionId],
    /// The state that defers the event, if no transition took it.
    pub deferred: Option<NodeId>,
    /// The nodes left, in order.
    pub exits: &'a [NodeId],
    /// The actions executed, in order.
    pub effects: &'a [ActionLocation],
    /// The segments selected during the micro-step, in the order taken: those behind a CHOICE, out
    /// of HISTORY, and, where composites do not remain in START, out of START.
    pub taken: &'a [TransitionId],
    /// The nodes entered, in order.
    pub entries: &'a [NodeId],
    /// The guards evaluated, in order; `None` for a guard without a value.
    pub guards: &'a [(TransitionId, Option<bool>)],
}

/// The cause of a micro-step.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum MicroStepCause {
    /// The chart was started.
    Start,
    /// Transitions without a trigger.
    Eventless,
    /// The chart was replaced: new regions are entered.
    Swap,
    /// One occurrence of an event.
    Event(EventId),
    /// All states are left: the root has reached END, or the host stops the chart.
    Finish,
}

impl<'a> TraceRecord<'a> {
    /// The record in one line, with the short names of its chart.
    pub fn display(&self, chart: &'a CompiledChart) -> impl fmt::Display + 'a {
        self.display_with(chart, |node| chart.names().name(node).to_owned())
    }

    /// The record in one line, with node names supplied by the caller.
    pub fn display_with(
        &self,
        chart: &'a CompiledChart,
        name: impl Fn(NodeId) -> String + 'a,
    ) -> impl fmt::Display + 'a {
        TraceLine { record: *self, chart, name }
    }
}

struct TraceLine<'a, N> {
    record: TraceRecord<'a>,
    chart: &'a CompiledChart,
    name: N,
}

impl<N: Fn(NodeId) -> String> fmt::Display for TraceLine<'_, N> {
    /// `0.100 s kick: a -> b; exit a; do a -> b; enter b; read a -> b = true`; empty parts are
    /// omitted.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let record = &self.record;
        match record.cause {
            MicroStepCause::Start => write!(f, "{} start", record.time)?,
            MicroStepCause::Swap => write!(f, "{} swap", record.time)?,
            MicroStepCause::Eventless => write!(f, "{} -:", record.time)?,
            MicroStepCause::Finish => write!(f, "{} finish", record.time)?,
            MicroStepCause::Event(event) => {
                write!(f, "{} {}:", record.time, self.chart.events().name(event))?
            }
        }
        let compounds = |list: &[CompoundTransitionId]| join(list, |&compound| self.compound(compound));
        let nodes = |list: &[NodeId]| join(list, |&node| (self.name)(node));
        match record.selected.is_empty() {
            false => write!(f, " {}", compounds(record.selected))?,
            true if record.is_dropped() => write!(f, " dropped")?,
            true if matches!(
                record.cause,
                MicroStepCause::Start | MicroStepCause::Swap | MicroStepCause::Finish
            ) => {}
            true => write!(f, " nothing")?,
        }
        part(f, "preempt", &compounds(record.preempted))?;
        part(f, "hold", &compounds(record.held))?;
        part(f, "defer in", &record.deferred.map(&self.name).unwrap_or_default())?;
        part(f, "exit", &nodes(record.exits))?;
        part(f, "then", &self.chain(record.taken))?;
        part(f, "do", &join(record.effects, |&location| self.effect(location)))?;
        part(f, "enter", &nodes(record.entries))?;
        part(f, "read", &join(record.guards, |&(transition, value)| self.guard(transition, value)))
    }
}

impl TraceRecord<'_> {
    /// Whether an event was neither taken, held nor deferred.
    pub fn is_dropped(&self) -> bool {
        matches!(self.cause, MicroStepCause::Event(_))
            && self.selected.is_empty()
            && self.held.is_empty()
            && self.deferred.is_none()
    }
}

impl<N: Fn(NodeId) -> String> TraceLine<'_, N> {
    fn compound(&self, compound: CompoundTransitionId) -> String {
        self.chain(self.chart.segments(compound))
    }

    /// `a -> CONDITION -> b`; where a segment does not continue the previous one, `a -> FORK -> b +
    /// FORK -> c`.
    fn chain(&self, segments: &[TransitionId]) -> String {
        let statechart = self.chart.statechart();
        let mut text = String::new();
        let mut at = None;
        for &segment in segments {
            let transition = statechart.transition(segment);
            if at != Some(transition.source) {
                text += if text.is_empty() { "" } else { " + " };
                text += &(self.name)(transition.source);
            }
            text += " -> ";
            text += &(self.name)(transition.target);
            at = Some(transition.target);
        }
        text
    }

    fn segment(&self, id: TransitionId) -> String {
        let transition = self.chart.statechart().transition(id);
        format!("{} -> {}", (self.name)(transition.source), (self.name)(transition.target))
    }

    fn effect(&self, location: ActionLocation) -> String {
        let statechart = self.chart.statechart();
        let (actions, at) = match location {
            ActionLocation::Transition(id) => {
                (&statechart.transition(id).expression.actions, self.segment(id))
            }
            ActionLocation::Entry(id) => (&statechart.node(id).entry, format!("entry {}", (self.name)(id))),
            ActionLocation::Exit(id) => (&statechart.node(id).exit, format!("exit {}", (self.name)(id))),
        };
        format!("{} ({at})", join(actions, |action| action.to_string()))
    }

    fn guard(&self, id: TransitionId, value: Option<bool>) -> String {
        match value {
            Some(value) => format!("{} = {value}", self.segment(id)),
            None => format!("{} = error", self.segment(id)),
        }
    }
}

fn join<T>(list: &[T], text: impl Fn(&T) -> String) -> String {
    list.iter().map(text).collect::<Vec<_>>().join(", ")
}

fn part(f: &mut fmt::Formatter<'_>, title: &str, text: &str) -> fmt::Result {
    if text.is_empty() { Ok(()) } else { write!(f, "; {title} {text}") }
}
