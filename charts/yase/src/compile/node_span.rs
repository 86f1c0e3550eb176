//! The span of a transition: the lowest OR around all its ends.

use crate::compile::{NodeIndex, NodeOrder};
use crate::statechart::{NodeId, NodeKind, Statechart};

/// A contiguous range of node indices that contains some nodes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct NodeSpan {
    first: NodeIndex,
    last: NodeIndex,
}

impl NodeSpan {
    pub(crate) fn first(self) -> NodeIndex {
        self.first
    }

    pub(crate) fn last(self) -> NodeIndex {
        self.last
    }

    pub(crate) fn of(node: NodeIndex) -> NodeSpan {
        NodeSpan { first: node, last: node }
    }

    pub(crate) fn with(self, other: NodeSpan) -> NodeSpan {
        NodeSpan { first: self.first.min(other.first), last: self.last.max(other.last) }
    }
}

/// The lowest OR that properly contains a node and everything in a span.
pub(crate) fn lowest_or(
    chart: &Statechart,
    layout: &NodeOrder,
    node: NodeId,
    hull: NodeSpan,
) -> Option<NodeId> {
    let hull = hull.with(NodeSpan::of(layout.index_of(node)));
    chart.ancestors(node).find(|&ancestor| {
        let index = layout.index_of(ancestor);
        chart.node(ancestor).kind == NodeKind::Or && layout.first(index) <= hull.first && hull.last < index
    })
}

/// The lowest node that contains everything in a span, possibly one of its nodes.
pub(crate) fn lowest_node(chart: &Statechart, layout: &NodeOrder, hull: NodeSpan) -> NodeId {
    let last = layout.node(hull.last);
    let contains = |node: &NodeId| layout.first(layout.index_of(*node)) <= hull.first;
    std::iter::once(last).chain(chart.ancestors(last)).find(contains).unwrap_or(Statechart::ROOT)
}

/// Whether any two of the nodes lie in different regions of an AND.
pub(crate) fn are_orthogonal(chart: &Statechart, layout: &NodeOrder, nodes: &[NodeId]) -> bool {
    let mut indices: Vec<NodeIndex> = nodes.iter().map(|&node| layout.index_of(node)).collect();
    indices.sort_unstable();
    // in sorted order, the lowest common ancestor of any pair is that of some adjacent pair
    indices.windows(2).all(|pair| {
        let around = lowest_node(chart, layout, NodeSpan::of(pair[0]).with(NodeSpan::of(pair[1])));
        chart.node(around).kind == NodeKind::And && layout.index_of(around) > pair[1]
    })
}

/// The child of an ancestor on the path down to a node.
pub(crate) fn child_towards(chart: &Statechart, ancestor: NodeId, node: NodeId) -> Option<NodeId> {
    std::iter::once(node)
        .chain(chart.ancestors(node))
        .find(|&on_way| chart.node(on_way).parent == Some(ancestor))
}
