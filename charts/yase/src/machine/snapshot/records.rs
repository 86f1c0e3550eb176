//! The valid values of a HISTORY.

use std::collections::BTreeSet;

use crate::compile::{CompiledChart, HistoryNode, NodeIndex};
use crate::semantics::{ExitPointArrival, JoinMode, StructureRules, TransitionToAncestor};
use crate::statechart::NodeKind;

/// Whether these nodes can have been active in the HISTORY's composite: the child, or, for a deep
/// one, all nodes inside.
pub(crate) fn can_remember(
    chart: &CompiledChart,
    history: &HistoryNode,
    nodes: &BTreeSet<NodeIndex>,
) -> bool {
    let states = nodes.iter().all(|&node| is_state(kind(chart, node)));
    states && if history.is_deep { deep(chart, history, nodes) } else { shallow(chart, history, nodes) }
}

fn shallow(chart: &CompiledChart, history: &HistoryNode, nodes: &BTreeSet<NodeIndex>) -> bool {
    match kind(chart, history.owner) {
        NodeKind::Or => {
            let is_child = |node: &NodeIndex| chart.states[node.index()].parent == Some(history.owner);
            nodes.len() == 1 && nodes.iter().all(is_child)
        }
        _ => nodes.is_empty(),
    }
}

fn deep(chart: &CompiledChart, history: &HistoryNode, nodes: &BTreeSet<NodeIndex>) -> bool {
    let is_there = |node: NodeIndex| node == history.owner || nodes.contains(&node);
    let is_inside = |index: &NodeIndex| {
        chart.states[index.index()].parent.is_some_and(is_there) && *index != history.owner
    };
    let mut all = nodes.iter().chain(std::iter::once(&history.owner));
    nodes.iter().all(is_inside) && all.all(|&node| is_filled(chart, node, is_there))
}

/// Whether a node has the children that it must have.
fn is_filled(chart: &CompiledChart, node: NodeIndex, is_there: impl Fn(NodeIndex) -> bool) -> bool {
    let layout = &chart.layout;
    let children = chart.statechart().children(layout.node(node)).iter();
    let children: Vec<NodeIndex> = children.map(|&child| layout.index_of(child)).collect();
    let count = children.iter().filter(|&&child| is_there(child)).count();
    match kind(chart, node) {
        NodeKind::Or | NodeKind::And if count == 0 && can_be_vacated(chart) => true,
        NodeKind::Or => count == 1,
        NodeKind::And => chart.states[node.index()].parts.iter().all(|&region| is_there(region)),
        _ => true,
    }
}

/// Whether transitions may leave a composite without an active child.
fn can_be_vacated(chart: &CompiledChart) -> bool {
    let semantics = chart.semantics_ref();
    semantics.join == JoinMode::Each
        || semantics.exit_points == ExitPointArrival::All
        || semantics.ancestor == TransitionToAncestor::Completed
        || semantics.structure == StructureRules::Uml
}

fn is_state(kind: NodeKind) -> bool {
    use NodeKind::{And, Basic, End, Or, Start};
    matches!(kind, Or | And | Basic | Start | End)
}

fn kind(chart: &CompiledChart, node: NodeIndex) -> NodeKind {
    chart.states[node.index()].kind
}
