//! Cone of influence: the regions of a chart that cannot influence a property.
//!
//! A region of an AND that is never left runs beside the others forever. If it raises no event that
//! others wait for, if no guard reads its states and the property does not mention it, then it does
//! not influence the behaviour of the others: its steps are stuttering steps for them. Such a
//! region is not explored, and results for the rest hold for the whole chart.
//!
//! The chart is an abstraction: its scripts stand for conditions on messages and for actions that
//! write messages.

use yase::expression::{Action, ActionKind, Expression, ExpressionKind, Trigger};
use yase::{NodeId, NodeKind, Statechart};

/// The regions that influence neither the mentioned regions nor their events.
pub(crate) fn idle_but(chart: &Statechart, is_spoken_of: &dyn Fn(NodeId) -> bool) -> Vec<NodeId> {
    if reads_active_states(chart) {
        return Vec::new();
    }
    let regions = chart.nodes().filter(|(_, node)| node.kind == NodeKind::And).flat_map(|(and, _)| {
        let is_left = is_left(chart, and);
        chart.children(and).iter().copied().filter(move |_| !is_left)
    });
    regions.filter(|&region| !is_spoken_of(region) && has_no_outside_effect(chart, region)).collect()
}

pub(crate) fn is_within(chart: &Statechart, node: NodeId, outer: NodeId) -> bool {
    node == outer || chart.ancestors(node).any(|ancestor| ancestor == outer)
}

/// Whether any guard reads active states.
fn reads_active_states(chart: &Statechart) -> bool {
    chart.transitions().any(|(_, it)| it.expression.guard.as_ref().is_some_and(mentions_states))
}

fn mentions_states(guard: &Expression) -> bool {
    guard.find_map(&mut |part| matches!(part.kind, ExpressionKind::In(_)).then_some(())).is_some()
}

/// Whether an AND, or a node around it, has an exit.
fn is_left(chart: &Statechart, and: NodeId) -> bool {
    chart.transitions().any(|(_, it)| {
        let leaves_outer = is_within(chart, and, it.source) && !it.expression.is_never();
        let leaves_inner = is_within(chart, it.source, and) && !is_within(chart, it.target, and);
        leaves_outer || (leaves_inner && it.source != and)
    })
}

/// Whether a region affects others only by messages, whose values are free inputs anyway.
fn has_no_outside_effect(chart: &Statechart, region: NodeId) -> bool {
    let is_inside = |node| is_within(chart, node, region);
    let transitions_stay = chart.transitions().all(|(_, it)| {
        let (from, to) = (is_inside(it.source), is_inside(it.target));
        from == to
            && (!from || (it.expression.trigger.is_none() && it.expression.actions.iter().all(is_quiet)))
    });
    let nodes_stay = chart.nodes().filter(|(id, _)| is_inside(*id)).all(|(_, node)| {
        let is_plain = !matches!(node.kind, NodeKind::Terminate | NodeKind::Fork | NodeKind::Join);
        is_plain && node.defer.is_empty() && node.entry.iter().chain(&node.exit).all(is_quiet)
    });
    transitions_stay && nodes_stay && !is_waited_for(chart, region)
}

fn is_quiet(action: &Action) -> bool {
    !matches!(action.kind, ActionKind::Raise(_))
}

/// Whether a trigger outside the region waits for one of its timers, or matches every event.
fn is_waited_for(chart: &Statechart, region: NodeId) -> bool {
    let inside = chart.transitions().filter(|(_, it)| is_within(chart, it.source, region));
    let nodes = chart.nodes().filter(|(id, _)| is_within(chart, *id, region));
    let actions = inside
        .flat_map(|(_, it)| &it.expression.actions)
        .chain(nodes.flat_map(|(_, node)| node.entry.iter().chain(&node.exit)));
    let timers: Vec<String> = actions
        .filter_map(|action| match &action.kind {
            ActionKind::StartTimeout { timer, .. } => Some(timer.text()),
            _ => None,
        })
        .collect();
    chart.transitions().any(|(_, it)| match &it.expression.trigger {
        None => false,
        Some(Trigger::OneOf(events)) => events.iter().any(|event| timers.contains(&event.text())),
        Some(Trigger::Any | Trigger::Not(_)) => true,
    })
}
