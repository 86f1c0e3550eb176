//! Timers of one state, which XState writes as `after`.
//!
//! A timer here is a deadline on a blackboard; it outlives states, and anything may read it. If it starts whenever one certain state is entered
//! and never otherwise, it is the time since then.

use std::collections::BTreeMap;
use std::time::Duration;

use super::super::outline::sound_transitions;
use super::ways::Way;
use crate::expression::{Action, ActionKind, ExpressionKind, TransitionExpression, Trigger};
use crate::statechart::{NodeId, NodeKind, Statechart, Transition};

/// Where a timer starts.
enum Beginning<'a> {
    Entry(NodeId),
    Exit,
    Segment(&'a Transition),
}

/// The timers of a chart: for each where it starts, and for how long.
pub(super) struct Timers<'a> {
    chart: &'a Statechart,
    beginnings: BTreeMap<String, Vec<(Beginning<'a>, Duration)>>,
    /// The segments into each node.
    incoming: Vec<Vec<&'a Transition>>,
    has_history: bool,
}

impl<'a> Timers<'a> {
    pub(super) fn of(chart: &'a Statechart) -> Timers<'a> {
        let mut beginnings: BTreeMap<String, Vec<(Beginning<'_>, Duration)>> = BTreeMap::new();
        let mut begin = |actions: &[Action], make: &dyn Fn() -> Beginning<'a>| {
            for action in actions {
                if let ActionKind::StartTimeout { timer, delay, .. } = &action.kind {
                    beginnings.entry(timer.text()).or_default().push((make(), *delay));
                }
            }
        };
        for (id, node) in chart.nodes() {
            begin(&node.entry, &|| Beginning::Entry(id));
            begin(&node.exit, &|| Beginning::Exit);
        }
        let mut incoming = vec![Vec::new(); chart.nodes().len()];
        for (_, transition) in sound_transitions(chart) {
            begin(&transition.expression.actions, &|| Beginning::Segment(transition));
            incoming[transition.target.0 as usize].push(transition);
        }
        let is_history = |kind| matches!(kind, NodeKind::ShallowHistory | NodeKind::DeepHistory);
        let has_history = chart.nodes().any(|(_, node)| is_history(node.kind));
        Timers { chart, beginnings, incoming, has_history }
    }

    /// How long after its source was entered a way is taken, if that is all it waits for.
    pub(super) fn delay(&self, state: NodeId, way: &Way<'_>) -> Option<Duration> {
        let node = self.chart.node(state);
        let first = way.segments.first()?;
        let alone = way.segments.iter().skip(1).all(|segment| segment.expression.guard.is_none());
        if node.kind != NodeKind::Basic || node.activity.is_some() || first.internal || !alone {
            return None;
        }
        self.since_entry(state, &awaited(&first.expression)?)
    }

    /// The delay of a timer that starts whenever a state is entered, and never otherwise.
    fn since_entry(&self, state: NodeId, timer: &str) -> Option<Duration> {
        let beginnings = self.beginnings.get(timer)?;
        let (_, delay) = beginnings.first()?;
        let parent = self.chart.node(state).parent;
        let into_state = |it: &Transition| {
            it.target == state && !it.internal && self.chart.node(it.source).parent == parent
        };
        let only_here = beginnings.iter().all(|(beginning, other)| {
            other == delay
                && match beginning {
                    Beginning::Entry(id) => *id == state,
                    Beginning::Segment(segment) => into_state(segment),
                    Beginning::Exit => false,
                }
        });
        let on_entry = beginnings.iter().any(|(it, _)| matches!(it, Beginning::Entry(_)));
        let starts = |it: &&Transition| it.expression.started_timers().any(|started| started == timer);
        let on_every_way = !self.has_history && self.incoming[state.0 as usize].iter().all(starts);
        (only_here && (on_entry || on_every_way)).then_some(*delay)
    }
}

/// The timer an expression waits for, if it waits for nothing else.
fn awaited(expression: &TransitionExpression) -> Option<String> {
    match (&expression.trigger, &expression.guard) {
        (None, Some(guard)) => match &guard.kind {
            ExpressionKind::Variable(path) | ExpressionKind::TimeoutCheck(path) => Some(path.text()),
            _ => None,
        },
        (Some(Trigger::OneOf(events)), None) => match events.as_slice() {
            [event] => Some(event.text()),
            _ => None,
        },
        _ => None,
    }
}
