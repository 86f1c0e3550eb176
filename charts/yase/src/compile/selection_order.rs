//! The selection order, where JOINs require another order than that of the node indices.
//!
//! A JOIN that takes its sources together is one of the paths of its first source, but it may only
//! be taken if nothing inside any of its sources is enabled: so the insides of the other sources
//! are examined before the first source. The other sources have higher indices than the first, and
//! so does everything that must be examined before their insides: the order is acyclic.

use crate::compile::{JoinNode, NodeIndex, NodeOrder};
use crate::semantics::{CompletionTrigger, JoinMode, Semantics};

/// The order; `None` if it is that of the node indices.
pub(crate) fn order(
    layout: &NodeOrder,
    joins: &[JoinNode],
    semantics: &Semantics,
) -> Option<Box<[NodeIndex]>> {
    let is_together = semantics.join == JoinMode::Together && semantics.eventless != CompletionTrigger::Once;
    let mut before: Vec<(NodeIndex, NodeIndex)> =
        joins.iter().filter(|_| is_together).flat_map(|join| join_precedence(layout, join)).collect();
    if before.is_empty() {
        return None;
    }
    before.sort_by_key(|&(first, _)| first); // those of one place stay in their order
    Some(SelectionOrderBuilder { layout, before: &before, visited: vec![false; layout.len()] }.all())
}

/// The first source of a JOIN, with each of the others that has children.
fn join_precedence<'a>(
    layout: &'a NodeOrder,
    join: &'a JoinNode,
) -> impl Iterator<Item = (NodeIndex, NodeIndex)> + 'a {
    let first = join.sources.iter().copied().min();
    let others = join.sources.iter().copied().filter(move |&source| Some(source) != first);
    others.filter(|&source| layout.first(source) < source).filter_map(move |source| Some((first?, source)))
}

struct SelectionOrderBuilder<'a> {
    layout: &'a NodeOrder,
    /// The nodes to be examined before a node: the insides of other sources.
    before: &'a [(NodeIndex, NodeIndex)],
    visited: Vec<bool>,
}

/// A range of node indices: the next to be examined, and the end.
type NodeRange = (u32, u32);

impl SelectionOrderBuilder<'_> {
    /// Nodes have higher indices than those inside them, so that only JOINs delay a node. Delayed
    /// nodes are kept on a separate stack.
    fn all(mut self) -> Box<[NodeIndex]> {
        let mut order = Vec::with_capacity(self.layout.len());
        let mut open: Vec<NodeRange> = vec![(0, self.layout.len() as u32)];
        while let Some((next, end)) = open.pop() {
            if next == end {
                continue;
            }
            let node = NodeIndex(next);
            let waits = if self.visited[node.index()] { &[] } else { self.waits_for(node) };
            let unseen = |&&(_, other): &&(NodeIndex, NodeIndex)| !self.visited[other.index() - 1];
            if let Some(&(_, other)) = waits.iter().find(unseen) {
                open.push((next, end));
                open.push((self.layout.first(other).0, other.0));
                continue;
            }
            open.push((next + 1, end));
            if !std::mem::replace(&mut self.visited[node.index()], true) {
                order.push(node);
            }
        }
        order.into()
    }

    fn waits_for(&self, node: NodeIndex) -> &[(NodeIndex, NodeIndex)] {
        let start = self.before.partition_point(|&(first, _)| first < node);
        let end = self.before.partition_point(|&(first, _)| first <= node);
        &self.before[start..end]
    }
}
