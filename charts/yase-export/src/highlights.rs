//! Highlighted parts of a chart: added, removed, changed, not covered or active.

use std::collections::BTreeMap;

use super::notation::inscription;
use yase::statechart::{Element, NodeId, Statechart, Transition};

/// Kind of highlighting.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Mark {
    /// Added: green.
    Added,
    /// Removed: red.
    Removed,
    /// Changed: orange.
    Changed,
    /// Not covered by any run: red.
    Missed,
    /// Active in a running machine: blue.
    Active,
}

impl Mark {
    pub(crate) const ALL: [Mark; 5] = [Mark::Added, Mark::Removed, Mark::Changed, Mark::Missed, Mark::Active];

    /// Its name, which is its class in SVG.
    pub const fn word(self) -> &'static str {
        match self {
            Mark::Added => "added",
            Mark::Removed => "removed",
            Mark::Changed => "changed",
            Mark::Missed => "missed",
            Mark::Active => "active",
        }
    }

    pub(crate) const fn colour(self) -> &'static str {
        match self {
            Mark::Added => "#1a7f37",
            Mark::Removed | Mark::Missed => "#c0261d",
            Mark::Changed => "#c46a00",
            Mark::Active => "#0b57d0",
        }
    }
}

/// The highlighted parts of a chart. Transitions with the same ends and the same text are one,
/// since a drawing cannot distinguish them.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Highlights {
    nodes: BTreeMap<NodeId, Mark>,
    transitions: BTreeMap<(NodeId, NodeId, String), Mark>,
}

impl Highlights {
    /// Highlights an element of a chart.
    pub fn set(&mut self, chart: &Statechart, element: Element, mark: Mark) {
        match element {
            Element::Node(id) => drop(self.nodes.insert(id, mark)),
            Element::Transition(id) => drop(self.transitions.insert(key(chart.transition(id)), mark)),
        }
    }

    /// Whether a node is highlighted.
    pub fn has(&self, id: NodeId) -> bool {
        self.nodes.contains_key(&id)
    }

    pub(crate) fn of_node(&self, id: NodeId) -> Option<Mark> {
        self.nodes.get(&id).copied()
    }

    pub(crate) fn of_transition(&self, transition: &Transition) -> Option<Mark> {
        if self.transitions.is_empty() { None } else { self.transitions.get(&key(transition)).copied() }
    }
}

fn key(transition: &Transition) -> (NodeId, NodeId, String) {
    (transition.source, transition.target, inscription(transition))
}
