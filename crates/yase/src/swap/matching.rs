//! Which node of a new chart each node of an old one is.

use std::collections::BTreeMap;

use crate::chart::{Chart, Place};
use crate::machine::snapshot::Paths;
use crate::statechart::{NodeId, NodeKind, Statechart, TransitionId};

/// What became of a node.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Match {
    /// It has the same path.
    Kept(NodeId),
    /// It has another path, and is without doubt the same.
    Moved(NodeId),
    /// The caller says what stands for it.
    Replaced(NodeId),
    Gone(Reason),
}

/// Why a node has no counterpart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Reason {
    /// The new chart has nothing like it.
    Missing,
    /// Several nodes could be it.
    Ambiguous,
    /// What is at its place is of another kind.
    OtherKind,
}

impl Match {
    pub(super) fn node(self) -> Option<NodeId> {
        match self {
            Match::Kept(node) | Match::Moved(node) | Match::Replaced(node) => Some(node),
            Match::Gone(_) => None,
        }
    }
}

/// A chart with the names in it.
#[derive(Clone, Copy)]
pub(super) struct Side<'a> {
    pub(super) chart: &'a Chart,
    pub(super) paths: &'a Paths,
}

impl<'a> Side<'a> {
    fn statechart(self) -> &'a Statechart {
        self.chart.statechart()
    }

    fn kind(self, node: NodeId) -> NodeKind {
        self.statechart().node(node).kind
    }

    fn parent(self, node: NodeId) -> Option<NodeId> {
        self.statechart().node(node).parent
    }

    /// The path from the root on, without the root's name.
    fn below_root(self, node: NodeId) -> &'a str {
        self.below(node, Statechart::ROOT)
    }

    fn below(self, node: NodeId, outer: NodeId) -> &'a str {
        let outer = self.paths.node(outer);
        self.paths.node(node).strip_prefix(outer).unwrap_or_default()
    }
}

/// Finds the counterpart of every node, by its [`NodeId`], parents before children: what the caller says; else what has the
/// same path from the counterpart of its parent; else the only node of its name and kind inside the counterpart of the nearest composite
/// around it.
pub(super) fn nodes(old: Side<'_>, new: Side<'_>, replaced: &BTreeMap<NodeId, NodeId>) -> Vec<Match> {
    let mut order: Vec<NodeId> = old.statechart().nodes().map(|(id, _)| id).collect();
    let layout = &old.chart.layout;
    order.sort_by_key(|&node| layout.rank(layout.place_of(node)));
    let names = [by_name(old), by_name(new)];
    let mut matches = vec![Match::Gone(Reason::Missing); order.len()];
    for node in order {
        matches[node.0 as usize] = match replaced.get(&node) {
            Some(&other) => Match::Replaced(other),
            None => find(old, new, node, &matches, &names),
        };
    }
    settle_contests(old, new, &mut matches);
    matches
}

/// The places of named nodes, in order.
type ByName<'a> = BTreeMap<&'a str, Vec<Place>>;

fn by_name(side: Side<'_>) -> ByName<'_> {
    let mut names = ByName::new();
    for (id, node) in side.statechart().nodes().filter(|(_, node)| !node.name.is_empty()) {
        names.entry(&node.name).or_default().push(side.chart.layout.place_of(id));
    }
    names.values_mut().for_each(|places| places.sort_unstable());
    names
}

fn find(old: Side<'_>, new: Side<'_>, node: NodeId, matches: &[Match], names: &[ByName<'_>; 2]) -> Match {
    let Some(parent) = old.parent(node) else { return Match::Kept(Statechart::ROOT) };
    let around = matches[parent.0 as usize].node();
    let follows = around.and_then(|around| {
        let path = format!("{}{}", new.paths.node(around), old.below(node, parent));
        new.paths.find_node(&path)
    });
    match follows {
        Some(found) if !are_alike(old.kind(node), new.kind(found)) => Match::Gone(Reason::OtherKind),
        Some(found) if old.below_root(node) == new.below_root(found) => Match::Kept(found),
        Some(found) => Match::Moved(found),
        None => moved(old, new, node, matches, names),
    }
}

/// A state may become a composite or the other way round.
fn are_alike(one: NodeKind, other: NodeKind) -> bool {
    let is_state = |kind| matches!(kind, NodeKind::Or | NodeKind::And | NodeKind::Basic);
    one == other || is_state(one) && is_state(other)
}

fn moved(
    old: Side<'_>,
    new: Side<'_>,
    node: NodeId,
    matches: &[Match],
    [old_names, new_names]: &[ByName<'_>; 2],
) -> Match {
    let name = old.statechart().node(node).name.as_str();
    let (Some(olds), Some(news)) = (old_names.get(name), new_names.get(name)) else {
        return Match::Gone(Reason::Missing);
    };
    for outer in old.statechart().ancestors(node) {
        let Some(counterpart) = matches[outer.0 as usize].node() else { continue };
        match (within(old, olds, outer), within(new, news, counterpart)) {
            (_, []) => {}
            ([_], [place]) => {
                let found = new.chart.layout.node(*place);
                let same_kind = old.kind(node) == new.kind(found);
                return if same_kind { Match::Moved(found) } else { Match::Gone(Reason::OtherKind) };
            }
            _ => return Match::Gone(Reason::Ambiguous),
        }
    }
    Match::Gone(Reason::Missing)
}

/// Those places that lie inside a node.
fn within<'p>(side: Side<'_>, places: &'p [Place], outer: NodeId) -> &'p [Place] {
    let layout = &side.chart.layout;
    let last = layout.place_of(outer);
    let start = places.partition_point(|&place| place < layout.first(last));
    let end = places.partition_point(|&place| place < last);
    &places[start..end]
}

/// A node that several would be is the one that has its path, or none of them. What the caller said is not contested.
fn settle_contests(old: Side<'_>, new: Side<'_>, matches: &mut [Match]) {
    let mut claims = vec![0_u32; new.statechart().nodes().len()];
    for found in matches.iter() {
        if let Match::Kept(node) | Match::Moved(node) = found {
            claims[node.0 as usize] += 1;
        }
    }
    for found in matches.iter_mut() {
        if let Match::Moved(node) = *found
            && claims[node.0 as usize] > 1
        {
            *found = Match::Gone(Reason::Ambiguous);
        }
    }
    debug_assert_eq!(matches.len(), old.statechart().nodes().len());
}

/// The counterpart of every segment: between the counterparts of its ends, with the same expression and the same marks; of several
/// such, the one at the same place among them.
pub(super) fn segments(old: &Chart, new: &Chart, matches: &[Match]) -> Vec<Option<TransitionId>> {
    type Ends = (NodeId, NodeId, bool, bool);
    let mut free: BTreeMap<(Ends, String), std::collections::VecDeque<TransitionId>> = BTreeMap::new();
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

/// Whether the new chart says the same as the old one, however its nodes are numbered.
pub(super) fn is_same(
    old: &Chart,
    new: &Chart,
    matches: &[Match],
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

fn is_same_node(one: &Statechart, other: &Statechart, id: NodeId, matches: &[Match]) -> bool {
    let Match::Kept(counterpart) = matches[id.0 as usize] else { return false };
    let children = one.children(id).iter().map(|child| matches[child.0 as usize].node());
    let mut node = one.node(id).clone();
    let found = other.node(counterpart);
    (node.parent, node.name) = (found.parent, found.name.clone()); // its path is the same
    node == *found && children.eq(other.children(counterpart).iter().copied().map(Some))
}

/// Transitions with one source are alike and in the same order.
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
