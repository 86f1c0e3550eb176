//! Timers of a chart, and the blackboards they belong to.

use std::collections::BTreeMap;
use std::time::Duration;

use yase::expression::{Action, ActionKind};
use yase::{NodeId, NodeKind, Span, Statechart, TransitionId};

use super::CheckedModel;

/// A name on a blackboard, which is identified by the node of its scope.
pub(crate) type TimerKey = (NodeId, String);

/// The timers that actions start, each with the span of its first start.
pub(crate) fn started(model: &CheckedModel) -> BTreeMap<TimerKey, Span> {
    let mut started = BTreeMap::new();
    for (id, transition) in model.chart.transitions() {
        for (name, _) in starts(&transition.expression.actions) {
            started.entry((blackboard(model, id), name)).or_insert(model.spans.transition(id));
        }
    }
    for (id, node) in model.chart.nodes() {
        for (name, _) in starts(&node.entry).chain(starts(&node.exit)) {
            started.entry((region_of(model, id), name)).or_insert(model.spans.node(id));
        }
    }
    started
}

/// The node of the scope whose blackboard a transition uses.
pub(crate) fn blackboard(subject: &CheckedModel, id: TransitionId) -> NodeId {
    let transition = subject.transition(id);
    let holds = |&node: &NodeId| node != transition.target && subject.contains(node, transition.target);
    let around = subject.chart.ancestors(transition.source).filter(holds);
    let scope = around.into_iter().find(|&node| subject.kind(node) == NodeKind::Or);
    region_of(subject, scope.unwrap_or(Statechart::ROOT))
}

/// The innermost region that contains a node, or the root.
pub(crate) fn region_of(subject: &CheckedModel, node: NodeId) -> NodeId {
    let ancestors = std::iter::once(node).chain(subject.chart.ancestors(node));
    ancestors.into_iter().find(|&it| subject.is_region(it)).unwrap_or(Statechart::ROOT)
}

pub(crate) fn starts(actions: &[Action]) -> impl Iterator<Item = (String, Duration)> {
    actions.iter().filter_map(|action| match &action.kind {
        ActionKind::StartTimeout { timer, delay, .. } => Some((timer.text(), *delay)),
        _ => None,
    })
}
