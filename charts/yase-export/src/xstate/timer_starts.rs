//! Timers bound to one state, which XState writes as `after`.
//!
//! In YASE a timer is a deadline on a blackboard; it outlives states, and any expression may read
//! it. A timer that starts on every entry of one state and never otherwise measures the time since
//! that entry.

use std::collections::BTreeMap;
use std::time::Duration;

use super::super::outline::sound_transitions;
use super::transitions::ResolvedTransition;
use yase::expression::{Action, ActionKind, ExpressionKind, TransitionExpression, Trigger};
use yase::statechart::{NodeId, NodeKind, Statechart, Transition};

/// The element at which a timer starts.
enum TimerStart<'a> {
    Entry(NodeId),
    Exit,
    Segment(&'a Transition),
}

/// The timers of a chart, with the place and delay of their starts.
pub(crate) struct TimerStarts<'a> {
    chart: &'a Statechart,
    beginnings: BTreeMap<String, Vec<(TimerStart<'a>, Duration)>>,
    /// The segments into each node.
    incoming: Vec<Vec<&'a Transition>>,
    has_history: bool,
}

impl<'a> TimerStarts<'a> {
    pub(crate) fn of(chart: &'a Statechart) -> TimerStarts<'a> {
        let mut beginnings: BTreeMap<String, Vec<(TimerStart<'_>, Duration)>> = BTreeMap::new();
        let mut begin = |actions: &[Action], make: &dyn Fn() -> TimerStart<'a>| {
            for action in actions {
                if let ActionKind::StartTimeout { timer, delay, .. } = &action.kind {
                    beginnings.entry(timer.text()).or_default().push((make(), *delay));
                }
            }
        };
        for (id, node) in chart.nodes() {
            begin(&node.entry, &|| TimerStart::Entry(id));
            begin(&node.exit, &|| TimerStart::Exit);
        }
        let mut incoming = vec![Vec::new(); chart.nodes().len()];
        for (_, transition) in sound_transitions(chart) {
            begin(&transition.expression.actions, &|| TimerStart::Segment(transition));
            incoming[transition.target.0 as usize].push(transition);
        }
        let is_history = |kind| matches!(kind, NodeKind::ShallowHistory | NodeKind::DeepHistory);
        let has_history = chart.nodes().any(|(_, node)| is_history(node.kind));
        TimerStarts { chart, beginnings, incoming, has_history }
    }

    /// The delay after the entry of its source at which a path is taken, if it waits for nothing
    /// else.
    pub(crate) fn delay(&self, state: NodeId, transition: &ResolvedTransition<'_>) -> Option<Duration> {
        let node = self.chart.node(state);
        let first = transition.segments.first()?;
        let alone = transition.segments.iter().skip(1).all(|segment| segment.expression.guard.is_none());
        if node.kind != NodeKind::Basic || node.activity.is_some() || first.internal || !alone {
            return None;
        }
        self.since_entry(state, &awaited(&first.expression)?)
    }

    /// The delay of a timer that starts on every entry of a state and never otherwise.
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
                    TimerStart::Entry(id) => *id == state,
                    TimerStart::Segment(segment) => into_state(segment),
                    TimerStart::Exit => false,
                }
        });
        let on_entry = beginnings.iter().any(|(it, _)| matches!(it, TimerStart::Entry(_)));
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
