//! Matching of the states of two charts.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use yase::{NodeId, NodeKind, Statechart};
use yase_export::notation::{depth_first, kind_word};

/// The matching states of two charts.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct NodePairs {
    later: Vec<Option<NodeId>>,
    earlier: Vec<Option<NodeId>>,
}

impl NodePairs {
    /// Matches states in this order: the roots; children of matched states with the same name;
    /// composites with the same parent and mostly the same states inside; states whose name
    /// disappeared from exactly one place and appeared in exactly one.
    pub(crate) fn between(before: &Statechart, after: &Statechart) -> NodePairs {
        let pairs =
            NodePairs { later: vec![None; before.nodes().len()], earlier: vec![None; after.nodes().len()] };
        let mut pairing = NodePairing { before, after, pairs, open: VecDeque::new() };
        pairing.join(Statechart::ROOT, Statechart::ROOT);
        loop {
            pairing.children();
            if !pairing.renamed() && !pairing.moved() {
                return pairing.pairs;
            }
        }
    }

    /// The state of the later chart.
    pub(crate) fn later(&self, id: NodeId) -> Option<NodeId> {
        self.later.get(id.0 as usize).copied().flatten()
    }

    /// The state of the earlier chart.
    pub(crate) fn earlier(&self, id: NodeId) -> Option<NodeId> {
        self.earlier.get(id.0 as usize).copied().flatten()
    }
}

struct NodePairing<'a> {
    before: &'a Statechart,
    after: &'a Statechart,
    pairs: NodePairs,
    /// Pairs whose children are not matched yet.
    open: VecDeque<(NodeId, NodeId)>,
}

impl NodePairing<'_> {
    fn join(&mut self, old: NodeId, new: NodeId) {
        self.pairs.later[old.0 as usize] = Some(new);
        self.pairs.earlier[new.0 as usize] = Some(old);
        self.open.push_back((old, new));
    }

    fn children(&mut self) {
        while let Some((old, new)) = self.open.pop_front() {
            let mut named: BTreeMap<(String, usize), NodeId> = keyed(self.before, &self.gone(old));
            for (key, child) in keyed(self.after, &self.come(new)) {
                if let Some(old) = named.remove(&key) {
                    self.join(old, child);
                }
            }
        }
    }

    /// The unmatched children of an earlier state.
    fn gone(&self, old: NodeId) -> Vec<NodeId> {
        self.before.children(old).iter().copied().filter(|&id| self.pairs.later(id).is_none()).collect()
    }

    fn come(&self, new: NodeId) -> Vec<NodeId> {
        self.after.children(new).iter().copied().filter(|&id| self.pairs.earlier(id).is_none()).collect()
    }

    /// Matches composites whose name changed with their formula. Returns whether there are any.
    fn renamed(&mut self) -> bool {
        let parents: Vec<(NodeId, NodeId)> =
            self.before.nodes().filter_map(|(id, _)| Some((id, self.pairs.later(id)?))).collect();
        let mut found = false;
        for (old_parent, new_parent) in parents {
            let (gone, come) = (self.gone(old_parent), self.come(new_parent));
            for new in come {
                let best = gone.iter().copied().filter(|&old| self.pairs.later(old).is_none());
                let best = best.map(|old| (self.shared(old, new), old));
                // of equally good candidates the first
                let best = best.max_by_key(|&(count, old)| (count, std::cmp::Reverse(old)));
                if let Some((_, old)) = best.filter(|&(count, _)| count > 0) {
                    self.join(old, new);
                    found = true;
                }
            }
        }
        found
    }

    /// The number of names that two composites of one kind share.
    fn shared(&self, old: NodeId, new: NodeId) -> usize {
        if self.before.node(old).kind != self.after.node(new).kind {
            return 0;
        }
        names_inside(self.before, old).intersection(&names_inside(self.after, new)).count()
    }

    /// Matches states that moved. Returns whether there are any.
    fn moved(&mut self) -> bool {
        let gone = depth_first(self.before).filter(|&id| self.pairs.later(id).is_none());
        let come = depth_first(self.after).filter(|&id| self.pairs.earlier(id).is_none());
        let come = by_name(self.after, come);
        let gone = by_name(self.before, gone);
        let one = |ids: &[NodeId]| <[NodeId; 1]>::try_from(ids).ok().map(|[id]| id);
        let found = gone.iter().filter_map(|(name, ids)| Some((one(ids)?, one(come.get(name)?)?)));
        // outermost first, since inner states may be matched as its children
        let Some((old, new)) = found.min() else { return false };
        self.join(old, new);
        true
    }
}

fn by_name(chart: &Statechart, ids: impl Iterator<Item = NodeId>) -> BTreeMap<&str, Vec<NodeId>> {
    let mut named: BTreeMap<&str, Vec<NodeId>> = BTreeMap::new();
    for id in ids.filter(|&id| !chart.node(id).name.is_empty()) {
        named.entry(chart.node(id).name.as_str()).or_default().push(id);
    }
    named
}

fn names_inside(chart: &Statechart, id: NodeId) -> BTreeSet<&str> {
    let mut names = BTreeSet::new();
    let mut open = vec![id];
    while let Some(id) = open.pop() {
        for &child in chart.children(id) {
            open.push(child);
            names.insert(chart.node(child).name.as_str());
        }
    }
    names.remove("");
    names
}

/// Children by name and index among equal names.
fn keyed(chart: &Statechart, children: &[NodeId]) -> BTreeMap<(String, usize), NodeId> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let mut keyed = BTreeMap::new();
    for &child in children {
        let key = key(chart, child);
        let count = counts.entry(key.clone()).or_default();
        keyed.insert((key, *count), child);
        *count += 1;
    }
    keyed
}

/// The name of a state among its siblings: a region has the name of its first state, a node without
/// a name that of its kind.
pub(crate) fn key(chart: &Statechart, id: NodeId) -> String {
    let node = chart.node(id);
    let first = || {
        let names = chart.children(id).iter().map(|&child| chart.node(child).name.as_str());
        names.into_iter().find(|name| !name.is_empty()).map(str::to_owned)
    };
    match (node.name.as_str(), node.kind) {
        ("", NodeKind::Or) => first().unwrap_or_default(),
        ("", kind) => kind_word(kind).to_owned(),
        (name, _) => name.to_owned(),
    }
}
