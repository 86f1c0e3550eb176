//! What is entered on a simple way, worked out in advance.

use smallvec::SmallVec;

use crate::chart::roles::is_state;
use crate::chart::{Layout, Place};
use crate::statechart::{NodeId, NodeKind, Statechart};

/// Longer lists are not worth their memory.
const LONGEST: usize = 64;

/// Most targets lie near: their lists need no memory of their own.
pub(super) type Few<T> = SmallVec<[T; 8]>;

/// The STARTs of the ORs of a chart, by [`NodeId`].
pub(super) fn starts(chart: &Statechart) -> Vec<Option<NodeId>> {
    let mut starts = vec![None; chart.nodes().len()];
    for (id, node) in chart.nodes() {
        if let (NodeKind::Start, Some(parent)) = (node.kind, node.parent) {
            starts[parent.0 as usize].get_or_insert(id);
        }
    }
    starts
}

/// The places to be entered, outermost first, on the way from a scope to a target inside it: where the way enters an AND, all its
/// other regions are entered too; where it ends, composites are entered up to their START. None if there are very many.
pub(super) fn between(
    chart: &Statechart,
    layout: &Layout,
    starts: &[Option<NodeId>],
    scope: NodeId,
    target: NodeId,
) -> Option<Few<Place>> {
    let mut way: Few<NodeId> =
        std::iter::once(target).chain(chart.ancestors(target)).take_while(|&node| node != scope).collect();
    let mut entered = Few::new();
    // what is still to be entered, the next one last, and whether it lies on the way
    let mut open: Few<(NodeId, bool)> = Few::new();
    push_children(chart, starts, scope, way.pop(), &mut open);
    while let Some((node, on_way)) = open.pop() {
        if entered.len() + open.len() >= LONGEST {
            return None;
        }
        entered.push(layout.place_of(node));
        let next = if on_way { way.pop() } else { None };
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
    open: &mut Few<(NodeId, bool)>,
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
