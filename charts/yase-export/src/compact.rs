//! Charts without what only formulas need: for drawings that are read as a whole.

use std::collections::BTreeMap;

use crate::outline::is_region;
use yase::statechart::{Node, NodeId, NodeKind, Statechart, Transition, TransitionId};

/// The chart without transitions that are never taken, without ENDs that nothing leads to then, and
/// without composites that only enclose another: the outer one has the content, and the name that
/// is a word rather than the text of a formula.
///
/// Only for drawings: paths, labels and completion differ from those of the chart. Given positions
/// are kept for states that stay in the same composite.
pub fn compact(chart: &Statechart) -> Statechart {
    CompactChart::of(chart).chart
}

/// A compact chart, and the elements of the whole chart that its parts represent.
pub(crate) struct CompactChart {
    pub(crate) chart: Statechart,
    /// The nodes of the whole chart, by the node that represents them in the compact chart.
    pub(crate) nodes: BTreeMap<NodeId, NodeId>,
    /// The transition of the whole chart, by index of the one that represents it.
    pub(crate) transitions: Vec<TransitionId>,
}

impl CompactChart {
    pub(crate) fn of(chart: &Statechart) -> CompactChart {
        let mut compaction = Compaction::new(chart);
        compaction.drop_unused_ends();
        // composites inside others first
        for id in chart.nodes().map(|(id, _)| id).collect::<Vec<_>>().into_iter().rev() {
            compaction.dissolve_child_of(id);
        }
        compaction.chart()
    }
}

struct Compaction<'a> {
    chart: &'a Statechart,
    nodes: Vec<Node>,
    children: Vec<Vec<NodeId>>,
    /// The remaining transitions, by their indices in the chart.
    transitions: BTreeMap<u32, &'a Transition>,
    /// By node: those at it.
    touching: Vec<Vec<u32>>,
}

impl<'a> Compaction<'a> {
    fn new(chart: &'a Statechart) -> Compaction<'a> {
        let count = chart.nodes().len();
        let mut touching = vec![Vec::new(); count];
        let mut transitions = BTreeMap::new();
        let exists = |node: NodeId| (node.0 as usize) < count;
        for (id, transition) in chart.transitions() {
            let Transition { source, target, .. } = *transition;
            if !transition.expression.is_never() && exists(source) && exists(target) {
                transitions.insert(id.0, transition);
                touching[source.0 as usize].push(id.0);
                if source != target {
                    touching[target.0 as usize].push(id.0);
                }
            }
        }
        Compaction {
            chart,
            nodes: chart.nodes().map(|(_, node)| node.clone()).collect(),
            children: chart.nodes().map(|(id, _)| chart.children(id).to_vec()).collect(),
            transitions,
            touching,
        }
    }

    fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.0 as usize]
    }

    fn at(&self, id: NodeId) -> impl Iterator<Item = (u32, &'a Transition)> {
        self.touching[id.0 as usize].iter().filter_map(|index| Some((*index, *self.transitions.get(index)?)))
    }

    fn drop_unused_ends(&mut self) {
        for index in 0..self.children.len() {
            let mut children = std::mem::take(&mut self.children[index]);
            children.retain(|&id| self.node(id).kind != NodeKind::End || self.at(id).next().is_some());
            self.children[index] = children;
        }
    }

    /// Gives a composite the content of its only child.
    fn dissolve_child_of(&mut self, outer: NodeId) {
        let Some((inner, dropped)) = self.only_child(outer) else { return };
        let Some(name) = self.joint_name(outer, inner) else { return };
        for index in dropped {
            self.transitions.remove(&index);
        }
        let Node { kind, entry, exit, defer, .. } = self.node(inner).clone();
        let node = &mut self.nodes[outer.0 as usize];
        node.entry.extend(entry);
        node.exit.splice(0..0, exit);
        node.defer.extend(defer);
        (node.kind, node.name) = (kind, name);
        let children = std::mem::take(&mut self.children[inner.0 as usize]);
        for &child in &children {
            self.nodes[child.0 as usize].parent = Some(outer);
        }
        self.children[outer.0 as usize] = children;
    }

    /// The composite that is the only content of another, with the transitions that only lead into
    /// it and out of it.
    fn only_child(&self, outer: NodeId) -> Option<(NodeId, Vec<u32>)> {
        if self.node(outer).kind != NodeKind::Or {
            return None;
        }
        let children = &self.children[outer.0 as usize];
        let of_kind = |kinds: &[NodeKind]| -> Vec<NodeId> {
            children.iter().copied().filter(|&id| kinds.contains(&self.node(id).kind)).collect()
        };
        let [inner] = of_kind(&[NodeKind::Or, NodeKind::And])[..] else { return None };
        let around = of_kind(&[NodeKind::Start, NodeKind::End]);
        // a region is an OR
        let may_be = self.node(inner).kind == NodeKind::Or || !is_region(self.chart, outer);
        if around.len() + 1 != children.len() || !may_be || self.at(inner).any(|(_, it)| !is_plain(it)) {
            return None;
        }
        let dropped: Vec<u32> =
            around.iter().chain([&inner]).flat_map(|&id| self.at(id)).map(|it| it.0).collect();
        let is_between = |index: &u32| {
            self.transitions.get(index).is_some_and(|it| {
                is_plain(it)
                    && it.source != it.target
                    && [it.source, it.target].iter().all(|end| *end == inner || around.contains(end))
            })
        };
        dropped.iter().all(is_between).then_some((inner, dropped))
    }

    /// The name of two composites that become one; none if both are words.
    fn joint_name(&self, outer: NodeId, inner: NodeId) -> Option<String> {
        let [outer, inner] = [outer, inner].map(|id| self.node(id).name.as_str());
        let is_word = |name: &str| !name.contains(|c: char| !c.is_alphanumeric() && c != '_');
        match (is_word(outer) && !outer.is_empty(), is_word(inner)) {
            (true, true) if !inner.is_empty() && inner != outer => None,
            (false, _) if !inner.is_empty() && (outer.is_empty() || is_word(inner)) => Some(inner.to_owned()),
            _ => Some(outer.to_owned()),
        }
    }

    fn chart(self) -> CompactChart {
        let mut transitions = Vec::with_capacity(self.transitions.len());
        let mut compact = Statechart::new(self.chart.name.clone());
        compact.constants.clone_from(&self.chart.constants);
        *compact.node_mut(Statechart::ROOT) = self.node(Statechart::ROOT).clone();
        let mut nodes = BTreeMap::from([(Statechart::ROOT, Statechart::ROOT)]);
        let mut open: Vec<NodeId> = self.children[0].iter().rev().copied().collect();
        while let Some(id) = open.pop() {
            let parent = self.node(id).parent.and_then(|parent| nodes.get(&parent).copied());
            let new = compact.add(parent.unwrap_or(Statechart::ROOT), self.node(id).clone());
            nodes.insert(id, new);
            let frame = self.chart.layout.frames.get(&id);
            if let Some(frame) = frame.filter(|_| self.node(id).parent == self.chart.node(id).parent) {
                compact.layout.frames.insert(new, *frame);
            }
            open.extend(self.children[id.0 as usize].iter().rev());
        }
        for (index, transition) in &self.transitions {
            let ends = [transition.source, transition.target].map(|end| nodes.get(&end).copied());
            let [Some(source), Some(target)] = ends else { continue };
            let id = compact.connect(Transition { source, target, ..(*transition).clone() });
            transitions.push(TransitionId(*index));
            if let Some(bends) = self.chart.layout.bends.get(&TransitionId(*index)) {
                compact.layout.bends.insert(id, bends.clone());
            }
        }
        CompactChart { chart: compact, nodes, transitions }
    }
}

/// Whether a transition has nothing but its ends.
fn is_plain(transition: &Transition) -> bool {
    *transition == Transition::new(transition.source, transition.target)
}
