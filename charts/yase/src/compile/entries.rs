//! Precomputed entry lists of simple transitions.

use smallvec::SmallVec;

use crate::compile::node_roles::is_state;
use crate::compile::{NodeIndex, NodeOrder};
use crate::statechart::{NodeId, NodeKind, Statechart};

/// Longer lists are computed during entry, to limit memory.
const MAX_STORED_ENTRIES: usize = 64;

/// Most targets are close: their lists need no allocation.
pub(crate) type InlineVec<T> = SmallVec<[T; 8]>;

/// The STARTs of the ORs of a chart, by [`NodeId`].
pub(crate) fn starts(chart: &Statechart) -> Vec<Option<NodeId>> {
    let mut starts = vec![None; chart.nodes().len()];
    for (id, node) in chart.nodes() {
        if let (NodeKind::Start, Some(parent)) = (node.kind, node.parent) {
            starts[parent.0 as usize].get_or_insert(id);
        }
    }
    starts
}

/// The nodes to be entered, outermost first, from a scope to a target inside it: where the path
/// enters an AND, all its other regions are entered too; at its end, composites are entered up to
/// their START. `None` if the list is too long, or a composite has no START.
pub(crate) fn between(
    chart: &Statechart,
    layout: &NodeOrder,
    starts: &[Option<NodeId>],
    scope: NodeId,
    target: NodeId,
) -> Option<InlineVec<NodeIndex>> {
    let mut nodes: InlineVec<NodeId> =
        std::iter::once(target).chain(chart.ancestors(target)).take_while(|&node| node != scope).collect();
    let mut entered = InlineVec::new();
    // the nodes still to be entered, the next one last, and whether each is on the path
    let mut open: InlineVec<(NodeId, bool)> = InlineVec::new();
    push_children(chart, starts, scope, nodes.pop(), &mut open);
    while let Some((node, on_way)) = open.pop() {
        if entered.len() + open.len() >= MAX_STORED_ENTRIES {
            return None;
        }
        entered.push(layout.index_of(node));
        let next = if on_way { nodes.pop() } else { None };
        if next.is_none() && chart.node(node).kind == NodeKind::Or && starts[node.0 as usize].is_none() {
            return None;
        }
        push_children(chart, starts, node, next, &mut open);
    }
    Some(entered)
}

/// Pushes the children of an entered node that are entered with it, the first one last.
fn push_children(
    chart: &Statechart,
    starts: &[Option<NodeId>],
    node: NodeId,
    next: Option<NodeId>,
    open: &mut InlineVec<(NodeId, bool)>,
) {
    match chart.node(node).kind {
        NodeKind::And => {
            let regions =
                chart.children(node).iter().rev().filter(|&&child| is_state(chart.node(child).kind));
            open.extend(regions.map(|&child| (child, Some(child) == next)));
        }
        NodeKind::Or => match next {
            Some(next) => open.push((next, true)),
            None => open.extend(starts[node.0 as usize].map(|start| (start, false))),
        },
        _ => {}
    }
}
