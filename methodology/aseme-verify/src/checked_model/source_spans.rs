//! Positions of the nodes and transitions of a chart in its file.

use yase::{Element, NodeId, Span, TransitionId};

/// A span for each node and each transition; the beginning of the file if it has none.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(crate) struct SourceSpans {
    /// By node.
    pub(crate) nodes: Vec<Span>,
    /// By transition.
    pub(crate) transitions: Vec<Span>,
    /// The span of the guard of each transition, if it has one of its own.
    pub(crate) guards: Vec<Option<Span>>,
}

impl SourceSpans {
    pub(crate) fn node(&self, node: NodeId) -> Span {
        self.nodes.get(node.0 as usize).copied().unwrap_or_default()
    }

    pub(crate) fn transition(&self, transition: TransitionId) -> Span {
        self.transitions.get(transition.0 as usize).copied().unwrap_or_default()
    }

    /// The span of a transition's guard, or of the transition if the guard has none.
    pub(crate) fn guard(&self, transition: TransitionId) -> Span {
        let guard = self.guards.get(transition.0 as usize).copied().flatten();
        guard.unwrap_or_else(|| self.transition(transition))
    }

    pub(crate) fn element(&self, element: Option<Element>) -> Span {
        match element {
            Some(Element::Node(node)) => self.node(node),
            Some(Element::Transition(transition)) => self.transition(transition),
            None => Span::default(),
        }
    }
}
