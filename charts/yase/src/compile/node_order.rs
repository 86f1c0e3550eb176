//! The order of the tree: the index of each node.
//!
//! Nodes are numbered children before parents, so that the indices of a node and everything inside
//! it are contiguous, with the node itself last: a set of active states is a bit set, the inside of
//! a composite is an interval of it, and a forward scan of the interval visits the innermost nodes
//! first.

use crate::statechart::{NodeId, Statechart};

/// A node's index in the order children before parents, siblings as they were added.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct NodeIndex(pub(crate) u32);

impl NodeIndex {
    #[inline]
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// The index of each node.
#[derive(Clone, Debug)]
pub(crate) struct NodeOrder {
    indices: Box<[NodeIndex]>,
    nodes: Box<[NodeId]>,
    firsts: Box<[NodeIndex]>,
    ranks: Box<[u32]>,
}

impl NodeOrder {
    /// Numbers the nodes of a chart of any depth.
    pub(crate) fn new(chart: &Statechart) -> NodeOrder {
        let count = chart.nodes().len();
        let mut layout = NodeOrder {
            indices: vec![NodeIndex(0); count].into(),
            nodes: Vec::with_capacity(count).into(),
            firsts: vec![NodeIndex(0); count].into(),
            ranks: vec![0; count].into(),
        };
        let mut nodes = Vec::with_capacity(count);
        let mut rank = 0;
        // on the current path: the node, the first index of its subtree, and the children still to
        // be visited
        let mut open = vec![(Statechart::ROOT, NodeIndex(0), 0)];
        let mut ranks = vec![0; count];
        while let Some((node, first, visited)) = open.pop() {
            if visited == 0 {
                ranks[node.0 as usize] = rank;
                rank += 1;
            }
            if let Some(&child) = chart.children(node).get(visited) {
                open.push((node, first, visited + 1));
                open.push((child, NodeIndex(nodes.len() as u32), 0));
            } else {
                let index = NodeIndex(nodes.len() as u32);
                layout.indices[node.0 as usize] = index;
                layout.firsts[index.index()] = first;
                layout.ranks[index.index()] = ranks[node.0 as usize];
                nodes.push(node);
            }
        }
        layout.nodes = nodes.into();
        layout
    }

    #[inline]
    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    #[inline]
    pub(crate) fn root(&self) -> NodeIndex {
        NodeIndex(self.nodes.len() as u32 - 1)
    }

    /// All indices, in order.
    pub(crate) fn indices(&self) -> impl DoubleEndedIterator<Item = NodeIndex> + use<> {
        (0..self.nodes.len() as u32).map(NodeIndex)
    }

    /// The index of a node, if it belongs to the chart.
    #[inline]
    pub(crate) fn find_index(&self, node: NodeId) -> Option<NodeIndex> {
        self.indices.get(node.0 as usize).copied()
    }

    /// The index of a node of the chart.
    pub(crate) fn index_of(&self, node: NodeId) -> NodeIndex {
        self.indices[node.0 as usize]
    }

    #[inline]
    pub(crate) fn node(&self, node: NodeIndex) -> NodeId {
        self.nodes[node.index()]
    }

    /// The first index inside a node; its own is the last.
    #[inline]
    pub(crate) fn first(&self, node: NodeIndex) -> NodeIndex {
        self.firsts[node.index()]
    }

    /// The node's number when parents are counted before children: document order.
    #[inline]
    pub(crate) fn rank(&self, node: NodeIndex) -> u32 {
        self.ranks[node.index()]
    }

    /// Whether `inner` is inside `outer` or is it.
    #[inline]
    pub(crate) fn contains(&self, outer: NodeIndex, inner: NodeIndex) -> bool {
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
        let layout = NodeOrder::new(&chart);
        let order: Vec<NodeId> = layout.indices().map(|index| layout.node(index)).collect();
        assert_eq!(order, [inner, a, b, Statechart::ROOT]);
        let index = |node| layout.index_of(node);
        assert_eq!(layout.first(index(a)), index(inner));
        assert!(layout.contains(index(a), index(inner)) && !layout.contains(index(a), index(b)));
        assert_eq!([Statechart::ROOT, a, inner, b].map(|node| layout.rank(index(node))), [0, 1, 2, 3]);
        assert_eq!(layout.find_index(NodeId(4)), None);
    }

    #[test]
    fn a_hundred_thousand_levels_do_not_overflow_the_stack() {
        let mut chart = Statechart::new("deep");
        let mut node = Statechart::ROOT;
        for _ in 0..100_000 {
            node = chart.add(node, Node::new(NodeKind::Or, "d"));
        }
        let layout = NodeOrder::new(&chart);
        assert_eq!(layout.index_of(node), NodeIndex(0));
        assert_eq!(layout.root(), NodeIndex(100_000));
    }
}
