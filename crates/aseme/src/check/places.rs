//! Where the nodes and transitions of a chart stand in the file that describes it.

use yase::{Element, NodeId, Span, TransitionId};

/// A span for each node and each transition; the beginning of the file for what stands nowhere.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(super) struct Places {
    /// By node.
    pub(super) nodes: Vec<Span>,
    /// By transition.
    pub(super) transitions: Vec<Span>,
    /// The guard of each transition, where that has a place of its own.
    pub(super) guards: Vec<Option<Span>>,
}

impl Places {
    pub(super) fn node(&self, node: NodeId) -> Span {
        self.nodes.get(node.0 as usize).copied().unwrap_or_default()
    }

    pub(super) fn transition(&self, transition: TransitionId) -> Span {
        self.transitions.get(transition.0 as usize).copied().unwrap_or_default()
    }

    /// The guard of a transition, else all of it.
    pub(super) fn guard(&self, transition: TransitionId) -> Span {
        let guard = self.guards.get(transition.0 as usize).copied().flatten();
        guard.unwrap_or_else(|| self.transition(transition))
    }

    pub(super) fn element(&self, element: Option<Element>) -> Span {
        match element {
            Some(Element::Node(node)) => self.node(node),
            Some(Element::Transition(transition)) => self.transition(transition),
            None => Span::default(),
        }
    }
}
