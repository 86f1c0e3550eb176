//! What a transition encloses: the lowest OR around all its ends.

use crate::chart::{Layout, Place};
use crate::statechart::{NodeId, NodeKind, Statechart};

/// Neighbouring places that enclose some nodes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Hull {
    first: Place,
    last: Place,
}

impl Hull {
    pub(super) fn of(place: Place) -> Hull {
        Hull { first: place, last: place }
    }

    pub(super) fn with(self, other: Hull) -> Hull {
        Hull { first: self.first.min(other.first), last: self.last.max(other.last) }
    }
}

/// The lowest OR that properly contains a node and all that a hull encloses.
pub(super) fn lowest_or(chart: &Statechart, layout: &Layout, node: NodeId, hull: Hull) -> Option<NodeId> {
    let hull = hull.with(Hull::of(layout.place_of(node)));
    chart.ancestors(node).find(|&ancestor| {
        let place = layout.place_of(ancestor);
        chart.node(ancestor).kind == NodeKind::Or && layout.first(place) <= hull.first && hull.last < place
    })
}

/// The lowest node that contains all that a hull encloses, which may be one of these.
pub(super) fn lowest_node(chart: &Statechart, layout: &Layout, hull: Hull) -> NodeId {
    let last = layout.node(hull.last);
    let contains = |node: &NodeId| layout.first(layout.place_of(*node)) <= hull.first;
    std::iter::once(last).chain(chart.ancestors(last)).find(contains).unwrap_or(Statechart::ROOT)
}

/// Whether nodes lie in different regions of ANDs, each two of them.
pub(super) fn are_orthogonal(chart: &Statechart, layout: &Layout, nodes: &[NodeId]) -> bool {
    let mut places: Vec<Place> = nodes.iter().map(|&node| layout.place_of(node)).collect();
    places.sort_unstable();
    // of what is sorted, each two have one of the lowest common ancestors of neighbours
    places.windows(2).all(|pair| {
        let around = lowest_node(chart, layout, Hull::of(pair[0]).with(Hull::of(pair[1])));
        chart.node(around).kind == NodeKind::And && layout.place_of(around) > pair[1]
    })
}

/// The child of an ancestor on the way down to a node.
pub(super) fn child_towards(chart: &Statechart, ancestor: NodeId, node: NodeId) -> Option<NodeId> {
    std::iter::once(node)
        .chain(chart.ancestors(node))
        .find(|&on_way| chart.node(on_way).parent == Some(ancestor))
}
