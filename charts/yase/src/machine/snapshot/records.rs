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
    places: &BTreeSet<NodeIndex>,
) -> bool {
    let states = places.iter().all(|&place| is_state(kind(chart, place)));
    states && if history.is_deep { deep(chart, history, places) } else { shallow(chart, history, places) }
}

fn shallow(chart: &CompiledChart, history: &HistoryNode, places: &BTreeSet<NodeIndex>) -> bool {
    match kind(chart, history.owner) {
        NodeKind::Or => {
            let is_child = |place: &NodeIndex| chart.states[place.index()].parent == Some(history.owner);
            places.len() == 1 && places.iter().all(is_child)
        }
        _ => places.is_empty(),
    }
}

fn deep(chart: &CompiledChart, history: &HistoryNode, places: &BTreeSet<NodeIndex>) -> bool {
    let is_there = |place: NodeIndex| place == history.owner || places.contains(&place);
    let is_inside = |place: &NodeIndex| {
        chart.states[place.index()].parent.is_some_and(is_there) && *place != history.owner
    };
    let mut all = places.iter().chain(std::iter::once(&history.owner));
    places.iter().all(is_inside) && all.all(|&place| is_filled(chart, place, is_there))
}

/// Whether a node has the children that it must have.
fn is_filled(chart: &CompiledChart, place: NodeIndex, is_there: impl Fn(NodeIndex) -> bool) -> bool {
    let layout = &chart.layout;
    let children = chart.statechart().children(layout.node(place)).iter();
    let children: Vec<NodeIndex> = children.map(|&child| layout.place_of(child)).collect();
    let count = children.iter().filter(|&&child| is_there(child)).count();
    match kind(chart, place) {
        NodeKind::Or | NodeKind::And if count == 0 && can_be_vacated(chart) => true,
        NodeKind::Or => count == 1,
        NodeKind::And => chart.states[place.index()].parts.iter().all(|&region| is_there(region)),
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

fn kind(chart: &CompiledChart, place: NodeIndex) -> NodeKind {
    chart.states[place.index()].kind
}
