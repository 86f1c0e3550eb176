//! Parts of a chart that a drawing sets apart: what was added, taken away or changed, or never met.

use std::collections::BTreeMap;

use super::notation::inscription;
use crate::statechart::{Element, NodeId, Statechart, Transition};

/// What a part is set apart as.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Mark {
    /// It is new: green.
    Added,
    /// It is no longer there: red.
    Removed,
    /// It is another than it was: orange.
    Changed,
    /// It is there, and nothing came by it: red.
    Missed,
    /// It is active in a machine that runs: blue.
    Active,
}

impl Mark {
    pub(super) const ALL: [Mark; 5] = [Mark::Added, Mark::Removed, Mark::Changed, Mark::Missed, Mark::Active];

    /// Its word, which is its class in SVG.
    pub const fn word(self) -> &'static str {
        match self {
            Mark::Added => "added",
            Mark::Removed => "removed",
            Mark::Changed => "changed",
            Mark::Missed => "missed",
            Mark::Active => "active",
        }
    }

    pub(super) const fn colour(self) -> &'static str {
        match self {
            Mark::Added => "#1a7f37",
            Mark::Removed | Mark::Missed => "#c0261d",
            Mark::Changed => "#c46a00",
            Mark::Active => "#0b57d0",
        }
    }
}

/// Which parts of a chart are set apart. Transitions that join the same nodes and say the same are one here: a drawing could not tell them apart.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Marks {
    nodes: BTreeMap<NodeId, Mark>,
    transitions: BTreeMap<(NodeId, NodeId, String), Mark>,
}

impl Marks {
    /// Sets a part of a chart apart.
    pub fn set(&mut self, chart: &Statechart, element: Element, mark: Mark) {
        match element {
            Element::Node(id) => drop(self.nodes.insert(id, mark)),
            Element::Transition(id) => drop(self.transitions.insert(key(chart.transition(id)), mark)),
        }
    }

    /// Whether a node is set apart.
    pub fn has(&self, id: NodeId) -> bool {
        self.nodes.contains_key(&id)
    }

    pub(super) fn of_node(&self, id: NodeId) -> Option<Mark> {
        self.nodes.get(&id).copied()
    }

    pub(super) fn of_transition(&self, transition: &Transition) -> Option<Mark> {
        if self.transitions.is_empty() { None } else { self.transitions.get(&key(transition)).copied() }
    }
}

fn key(transition: &Transition) -> (NodeId, NodeId, String) {
    (transition.source, transition.target, inscription(transition))
}
