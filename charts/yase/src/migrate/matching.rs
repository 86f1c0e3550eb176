//! Matches the nodes of an old chart with those of a new one.

use std::collections::BTreeMap;

use crate::compile::{CompiledChart, NodeIndex};
use crate::machine::snapshot::PathTable;
use crate::statechart::{NodeId, NodeKind, Statechart, TransitionId};

/// The match of a node.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum NodeMatch {
    /// It has the same path.
    Kept(NodeId),
    /// It has another path, and is unambiguous.
    Moved(NodeId),
    /// The caller supplied the replacement.
    Replaced(NodeId),
    Gone(MismatchReason),
}

/// Why a node has no counterpart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum MismatchReason {
    /// The new chart has no similar node.
    Missing,
    /// There are several candidates.
    Ambiguous,
    /// The node at its path has another kind.
    OtherKind,
}

impl NodeMatch {
    pub(crate) fn node(self) -> Option<NodeId> {
        match self {
            NodeMatch::Kept(node) | NodeMatch::Moved(node) | NodeMatch::Replaced(node) => Some(node),
            NodeMatch::Gone(_) => None,
        }
    }
}

/// A chart with the names in it.
#[derive(Clone, Copy)]
pub(crate) struct NamedChart<'a> {
    pub(crate) chart: &'a CompiledChart,
    pub(crate) paths: &'a PathTable,
}

impl<'a> NamedChart<'a> {
    fn statechart(self) -> &'a Statechart {
        self.chart.statechart()
    }

    fn kind(self, node: NodeId) -> NodeKind {
        self.statechart().node(node).kind
    }

    fn parent(self, node: NodeId) -> Option<NodeId> {
        self.statechart().node(node).parent
    }

    /// The path below the root.
    fn below_root(self, node: NodeId) -> &'a str {
        self.below(node, Statechart::ROOT)
    }

    fn below(self, node: NodeId, outer: NodeId) -> &'a str {
        let outer = self.paths.node(outer);
        self.paths.node(node).strip_prefix(outer).unwrap_or_default()
    }
}

/// Finds the counterpart of every node, by its [`NodeId`], parents before children: the caller's
/// replacement; else the node with the same path below the counterpart of its parent; else the only
/// node of its name and kind inside the counterpart of the nearest enclosing composite.
pub(crate) fn nodes(
    old: NamedChart<'_>,
    new: NamedChart<'_>,
    replaced: &BTreeMap<NodeId, NodeId>,
) -> Vec<NodeMatch> {
    let mut order: Vec<NodeId> = old.statechart().nodes().map(|(id, _)| id).collect();
    let layout = &old.chart.layout;
    order.sort_by_key(|&node| layout.rank(layout.index_of(node)));
    let names = [by_name(old), by_name(new)];
    let mut matches = vec![NodeMatch::Gone(MismatchReason::Missing); order.len()];
    for node in order {
        matches[node.0 as usize] = match replaced.get(&node) {
            Some(&other) => NodeMatch::Replaced(other),
            None => find(old, new, node, &matches, &names),
        };
    }
    resolve_ambiguities(new, &mut matches);
    matches
}

/// The indices of named nodes, in order.
type NodesByName<'a> = BTreeMap<&'a str, Vec<NodeIndex>>;

fn by_name(side: NamedChart<'_>) -> NodesByName<'_> {
    let mut names = NodesByName::new();
    for (id, node) in side.statechart().nodes().filter(|(_, node)| !node.name.is_empty()) {
        names.entry(&node.name).or_default().push(side.chart.layout.index_of(id));
    }
    names.values_mut().for_each(|nodes| nodes.sort_unstable());
    names
}

fn find(
    old: NamedChart<'_>,
    new: NamedChart<'_>,
    node: NodeId,
    matches: &[NodeMatch],
    names: &[NodesByName<'_>; 2],
) -> NodeMatch {
    let Some(parent) = old.parent(node) else { return NodeMatch::Kept(Statechart::ROOT) };
    let around = matches[parent.0 as usize].node();
    let follows = around.and_then(|around| {
        let path = format!("{}{}", new.paths.node(around), old.below(node, parent));
        new.paths.find_node(&path)
    });
    match follows {
        Some(found) if !kinds_are_compatible(old.kind(node), new.kind(found)) => {
            NodeMatch::Gone(MismatchReason::OtherKind)
        }
        Some(found) if old.below_root(node) == new.below_root(found) => NodeMatch::Kept(found),
        Some(found) => NodeMatch::Moved(found),
        None => moved(old, new, node, matches, names),
    }
}

/// A state may become a composite or vice versa.
fn kinds_are_compatible(one: NodeKind, other: NodeKind) -> bool {
    let is_state = |kind| matches!(kind, NodeKind::Or | NodeKind::And | NodeKind::Basic);
    one == other || is_state(one) && is_state(other)
}

fn moved(
    old: NamedChart<'_>,
    new: NamedChart<'_>,
    node: NodeId,
    matches: &[NodeMatch],
    [old_names, new_names]: &[NodesByName<'_>; 2],
) -> NodeMatch {
    let name = old.statechart().node(node).name.as_str();
    let (Some(olds), Some(news)) = (old_names.get(name), new_names.get(name)) else {
        return NodeMatch::Gone(MismatchReason::Missing);
    };
    for outer in old.statechart().ancestors(node) {
        let Some(counterpart) = matches[outer.0 as usize].node() else { continue };
        match (within(old, olds, outer), within(new, news, counterpart)) {
            (_, []) => {}
            ([_], [index]) => {
                let found = new.chart.layout.node(*index);
                let same_kind = old.kind(node) == new.kind(found);
                return if same_kind {
                    NodeMatch::Moved(found)
                } else {
                    NodeMatch::Gone(MismatchReason::OtherKind)
                };
            }
            _ => return NodeMatch::Gone(MismatchReason::Ambiguous),
        }
    }
    NodeMatch::Gone(MismatchReason::Missing)
}

/// The indices that lie inside a node.
fn within<'p>(side: NamedChart<'_>, nodes: &'p [NodeIndex], outer: NodeId) -> &'p [NodeIndex] {
    let layout = &side.chart.layout;
    let last = layout.index_of(outer);
    let start = nodes.partition_point(|&node| node < layout.first(last));
    let end = nodes.partition_point(|&index| index < last);
    &nodes[start..end]
}

/// A node claimed by several old nodes is matched with the one that has its path, or with none.
/// Replacements supplied by the caller take precedence.
fn resolve_ambiguities(new: NamedChart<'_>, matches: &mut [NodeMatch]) {
    let mut claims = vec![0_u32; new.statechart().nodes().len()];
    for found in matches.iter() {
        if let NodeMatch::Kept(node) | NodeMatch::Moved(node) = found {
            claims[node.0 as usize] += 1;
        }
    }
    for found in matches.iter_mut() {
        if let NodeMatch::Moved(node) = *found
            && claims[node.0 as usize] > 1
        {
            *found = NodeMatch::Gone(MismatchReason::Ambiguous);
        }
    }
}

/// The counterpart of every segment: between the counterparts of its ends, with an equal expression
/// and equal attributes; among several, the one in the same position.
pub(crate) fn segments(
    old: &CompiledChart,
    new: &CompiledChart,
    matches: &[NodeMatch],
) -> Vec<Option<TransitionId>> {
    type TransitionKey = (NodeId, NodeId, bool, bool);
    let mut free: BTreeMap<(TransitionKey, String), std::collections::VecDeque<TransitionId>> =
        BTreeMap::new();
    for (id, transition) in new.statechart().transitions() {
        let ends = (transition.source, transition.target, transition.interrupts, transition.internal);
        free.entry((ends, transition.expression.to_string())).or_default().push_back(id);
    }
    let counterpart = |node: NodeId| matches[node.0 as usize].node();
    old.statechart()
        .transitions()
        .map(|(_, transition)| {
            let ends = (counterpart(transition.source)?, counterpart(transition.target)?);
            let ends = (ends.0, ends.1, transition.interrupts, transition.internal);
            free.get_mut(&(ends, transition.expression.to_string()))?.pop_front()
        })
        .collect()
}

/// Whether the charts are equivalent apart from the numbering of nodes.
pub(crate) fn is_same(
    old: &CompiledChart,
    new: &CompiledChart,
    matches: &[NodeMatch],
    segments: &[Option<TransitionId>],
) -> bool {
    let (one, other) = (old.statechart(), new.statechart());
    one.constants == other.constants
        && one.nodes().len() == other.nodes().len()
        && one.transitions().len() == other.transitions().len()
        && old.reads() == new.reads()
        && one.nodes().all(|(id, _)| is_same_node(one, other, id, matches))
        && is_same_order(one, other, segments)
}

fn is_same_node(one: &Statechart, other: &Statechart, id: NodeId, matches: &[NodeMatch]) -> bool {
    let NodeMatch::Kept(counterpart) = matches[id.0 as usize] else { return false };
    let children = one.children(id).iter().map(|child| matches[child.0 as usize].node());
    let mut node = one.node(id).clone();
    let found = other.node(counterpart);
    (node.parent, node.name) = (found.parent, found.name.clone()); // its path is the same
    node == *found && children.eq(other.children(counterpart).iter().copied().map(Some))
}

/// Whether transitions with one source are equal and in the same order.
fn is_same_order(one: &Statechart, other: &Statechart, segments: &[Option<TransitionId>]) -> bool {
    let mut last: BTreeMap<NodeId, TransitionId> = BTreeMap::new();
    one.transitions().zip(segments).all(|((_, transition), found)| {
        let Some(found) = *found else { return false };
        let counterpart = other.transition(found);
        let before = last.insert(counterpart.source, found);
        before.is_none_or(|before| before < found)
            && (transition.priority, transition.weight) == (counterpart.priority, counterpart.weight)
    })
}
