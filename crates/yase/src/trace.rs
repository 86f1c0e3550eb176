//! What happened in a micro-step.

use std::fmt;

use crate::chart::{Chart, CompoundId};
use crate::expression::EventId;
use crate::host::ActionPlace;
use crate::moment::Moment;
use crate::statechart::{NodeId, TransitionId};

/// One micro-step, as it happened: what was taken, what lost, what was left, done and entered.
///
/// A record borrows the machine's buffers; whoever wants to keep it copies what is needed, or its text
/// ([`display`](TraceRecord::display)).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TraceRecord<'a> {
    /// When.
    pub time: Moment,
    /// What the micro-step was about.
    pub occasion: Occasion,
    /// The compound transitions that were taken, in the order of their firing.
    pub selected: &'a [CompoundId],
    /// Those that lost a conflict.
    pub preempted: &'a [CompoundId],
    /// Those that wait for running activities: their event is held, or, if they interrupt, they will fire.
    pub held: &'a [CompoundId],
    /// The state that defers the event, if nobody took it.
    pub deferred: Option<NodeId>,
    /// The nodes that were left, in order.
    pub exits: &'a [NodeId],
    /// The actions that were done, in order.
    pub effects: &'a [ActionPlace],
    /// The segments that were decided on only while the micro-step happened, in the order in which they were taken: those behind a CHOICE,
    /// out of HISTORY, and, where composites do not rest there, out of START.
    pub taken: &'a [TransitionId],
    /// The nodes that were entered, in order.
    pub entries: &'a [NodeId],
    /// The guards that were read, in order; none for one that has no value.
    pub guards: &'a [(TransitionId, Option<bool>)],
}

/// What a micro-step is about.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Occasion {
    /// The chart was started.
    Start,
    /// Transitions without a trigger.
    Eventless,
    /// The chart was swapped: regions that are new are entered.
    Swap,
    /// One occurrence of an event.
    Event(EventId),
    /// Everything is left: the root has reached END, or the chart is ended from outside.
    Finish,
}

impl<'a> TraceRecord<'a> {
    /// The record in one line, with the names of its chart.
    pub fn display(&self, chart: &'a Chart) -> impl fmt::Display + 'a {
        self.display_with(chart, |node| chart.short_path(node))
    }

    /// The record in one line, with names of the caller's choice for the nodes.
    pub fn display_with(
        &self,
        chart: &'a Chart,
        name: impl Fn(NodeId) -> String + 'a,
    ) -> impl fmt::Display + 'a {
        Line { record: *self, chart, name }
    }
}

struct Line<'a, N> {
    record: TraceRecord<'a>,
    chart: &'a Chart,
    name: N,
}

impl<N: Fn(NodeId) -> String> fmt::Display for Line<'_, N> {
    /// `0.100 s kick: a -> b; exit a; do a -> b; enter b; read a -> b = true`; what is empty is left out.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let record = &self.record;
        match record.occasion {
            Occasion::Start => write!(f, "{} start", record.time)?,
            Occasion::Swap => write!(f, "{} swap", record.time)?,
            Occasion::Eventless => write!(f, "{} -:", record.time)?,
            Occasion::Finish => write!(f, "{} finish", record.time)?,
            Occasion::Event(event) => write!(f, "{} {}:", record.time, self.chart.events().name(event))?,
        }
        let compounds = |list: &[CompoundId]| join(list, |&compound| self.compound(compound));
        let nodes = |list: &[NodeId]| join(list, |&node| (self.name)(node));
        match record.selected.is_empty() {
            false => write!(f, " {}", compounds(record.selected))?,
            true if record.is_dropped() => write!(f, " dropped")?,
            true if matches!(record.occasion, Occasion::Start | Occasion::Swap | Occasion::Finish) => {}
            true => write!(f, " nothing")?,
        }
        part(f, "preempt", &compounds(record.preempted))?;
        part(f, "hold", &compounds(record.held))?;
        part(f, "defer in", &record.deferred.map(&self.name).unwrap_or_default())?;
        part(f, "exit", &nodes(record.exits))?;
        part(f, "then", &self.chain(record.taken))?;
        part(f, "do", &join(record.effects, |&place| self.effect(place)))?;
        part(f, "enter", &nodes(record.entries))?;
        part(f, "read", &join(record.guards, |&(transition, value)| self.guard(transition, value)))
    }
}

impl TraceRecord<'_> {
    /// Whether an event found nobody who takes it, now or later.
    pub fn is_dropped(&self) -> bool {
        matches!(self.occasion, Occasion::Event(_))
            && self.selected.is_empty()
            && self.held.is_empty()
            && self.deferred.is_none()
    }
}

impl<N: Fn(NodeId) -> String> Line<'_, N> {
    fn compound(&self, compound: CompoundId) -> String {
        self.chain(self.chart.segments(compound))
    }

    /// `a -> CONDITION -> b`; where a segment does not go on from the one before, `a -> FORK -> b + FORK -> c`.
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

    fn effect(&self, place: ActionPlace) -> String {
        let statechart = self.chart.statechart();
        let (actions, at) = match place {
            ActionPlace::Transition(id) => (&statechart.transition(id).expression.actions, self.segment(id)),
            ActionPlace::Entry(id) => (&statechart.node(id).entry, format!("entry {}", (self.name)(id))),
            ActionPlace::Exit(id) => (&statechart.node(id).exit, format!("exit {}", (self.name)(id))),
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
