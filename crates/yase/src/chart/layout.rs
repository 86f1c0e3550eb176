//! The order of the tree: where each node stands among all nodes.
//!
//! Nodes are numbered children before parents, so that everything inside a node, and the node itself last, are neighbours: a set of active
//! states is a row of bits, what lies inside a composite is a stretch of it, and going through the stretch forward leaves
//! the innermost first.

use crate::statechart::{NodeId, Statechart};

/// A node's place in the order children before parents, siblings as they were added.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct Place(pub(crate) u32);

impl Place {
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Where each node stands.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    places: Box<[Place]>,
    nodes: Box<[NodeId]>,
    firsts: Box<[Place]>,
    ranks: Box<[u32]>,
}

impl Layout {
    /// Numbers the nodes of a chart of whatever depth.
    pub(crate) fn new(chart: &Statechart) -> Layout {
        let count = chart.nodes().len();
        let mut layout = Layout {
            places: vec![Place(0); count].into(),
            nodes: Vec::with_capacity(count).into(),
            firsts: vec![Place(0); count].into(),
            ranks: vec![0; count].into(),
        };
        let mut nodes = Vec::with_capacity(count);
        let mut rank = 0;
        // on the way down: the node, and the place its subtree begins at; the children still to be visited
        let mut open = vec![(Statechart::ROOT, Place(0), 0)];
        let mut ranks = vec![0; count];
        while let Some((node, first, visited)) = open.pop() {
            if visited == 0 {
                ranks[node.0 as usize] = rank;
                rank += 1;
            }
            if let Some(&child) = chart.children(node).get(visited) {
                open.push((node, first, visited + 1));
                open.push((child, Place(nodes.len() as u32), 0));
            } else {
                let place = Place(nodes.len() as u32);
                layout.places[node.0 as usize] = place;
                layout.firsts[place.index()] = first;
                layout.ranks[place.index()] = ranks[node.0 as usize];
                nodes.push(node);
            }
        }
        layout.nodes = nodes.into();
        layout
    }

    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) fn root(&self) -> Place {
        Place(self.nodes.len() as u32 - 1)
    }

    /// Every place, in order.
    pub(crate) fn places(&self) -> impl DoubleEndedIterator<Item = Place> + use<> {
        (0..self.nodes.len() as u32).map(Place)
    }

    /// The place of a node, if it is one of the chart.
    pub(crate) fn place(&self, node: NodeId) -> Option<Place> {
        self.places.get(node.0 as usize).copied()
    }

    /// The place of a node of the chart.
    pub(crate) fn place_of(&self, node: NodeId) -> Place {
        self.places[node.0 as usize]
    }

    pub(crate) fn node(&self, place: Place) -> NodeId {
        self.nodes[place.index()]
    }

    /// The first place inside a node; its own is the last.
    pub(crate) fn first(&self, place: Place) -> Place {
        self.firsts[place.index()]
    }

    /// The node's number when parents are counted before children: the order of the document.
    pub(crate) fn rank(&self, place: Place) -> u32 {
        self.ranks[place.index()]
    }

    /// Whether `inner` lies in `outer` or is it.
    pub(crate) fn contains(&self, outer: Place, inner: Place) -> bool {
        self.first(outer) <= inner && inner <= outer
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statechart::{Node, NodeKind};

    #[test]
    fn children_stand_before_their_parent_and_siblings_as_added() {
        let mut chart = Statechart::new("c");
        let a = chart.add(Statechart::ROOT, Node::new(NodeKind::Or, "a"));
        let b = chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, "b"));
        let inner = chart.add(a, Node::new(NodeKind::Basic, "inner"));
        let layout = Layout::new(&chart);
        let order: Vec<NodeId> = layout.places().map(|place| layout.node(place)).collect();
        assert_eq!(order, [inner, a, b, Statechart::ROOT]);
        let place = |node| layout.place_of(node);
        assert_eq!(layout.first(place(a)), place(inner));
        assert!(layout.contains(place(a), place(inner)) && !layout.contains(place(a), place(b)));
        assert_eq!([Statechart::ROOT, a, inner, b].map(|node| layout.rank(place(node))), [0, 1, 2, 3]);
        assert_eq!(layout.place(NodeId(4)), None);
    }

    #[test]
    fn a_hundred_thousand_levels_do_not_overflow_the_stack() {
        let mut chart = Statechart::new("deep");
        let mut node = Statechart::ROOT;
        for _ in 0..100_000 {
            node = chart.add(node, Node::new(NodeKind::Or, "d"));
        }
        let layout = Layout::new(&chart);
        assert_eq!(layout.place_of(node), Place(0));
        assert_eq!(layout.root(), Place(100_000));
    }
}
