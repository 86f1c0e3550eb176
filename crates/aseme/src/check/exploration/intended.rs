//! What is meant never to happen: a guard `false` says so, the exit of what goes on forever in a formula is never taken, and so of all that only they would lead to.

use yase::{NodeId, NodeKind, TransitionId};

use super::completion;
use crate::check::subject::Subject;

/// What is meant never to happen.
pub(super) struct Intended {
    /// By node: it would only be reached, or only complete, through what never happens.
    cut_off: Vec<bool>,
    /// By transition.
    never: Vec<bool>,
}

impl Intended {
    pub(super) fn new(subject: &Subject) -> Intended {
        let chart = &subject.chart;
        let mut intended = Intended {
            cut_off: vec![false; chart.nodes().len()],
            never: vec![false; chart.transitions().len()],
        };
        let mut open: Vec<NodeId> = Vec::new();
        for (id, transition) in chart.transitions() {
            let exit = transition.expression.is_empty() && completion::is_forever(subject, transition.source);
            if transition.expression.is_never() || exit && transition.source != transition.target {
                intended.never[id.0 as usize] = true;
                open.push(transition.target);
            }
        }
        while let Some(node) = open.pop() {
            if !std::mem::replace(&mut intended.cut_off[node.0 as usize], true) {
                intended.follow(subject, node, &mut open);
            }
        }
        intended
    }

    /// What follows from a node not being reached: what it leads to, what is in it, and the end of what it is in.
    fn follow(&mut self, subject: &Subject, node: NodeId, open: &mut Vec<NodeId>) {
        for &id in subject.outgoing(node) {
            self.never[id.0 as usize] = true;
            open.push(subject.transition(id).target);
        }
        open.extend(subject.chart.children(node));
        if subject.kind(node) == NodeKind::End {
            self.not_completed(subject, subject.chart.node(node).parent, open);
        }
    }

    fn not_completed(&mut self, subject: &Subject, composite: Option<NodeId>, open: &mut Vec<NodeId>) {
        let Some(composite) = composite else { return };
        for &id in subject.outgoing(composite) {
            if completion::waits(subject, id) {
                self.never[id.0 as usize] = true;
                open.push(subject.transition(id).target);
            }
        }
        if subject.is_region(composite) {
            self.not_completed(subject, subject.chart.node(composite).parent, open);
        }
    }

    /// Whether a node is meant not to be reached by one of the ways to it.
    pub(super) fn is_cut_off(&self, node: NodeId) -> bool {
        self.cut_off[node.0 as usize]
    }

    /// Whether a transition is meant never to be taken, or follows from that.
    pub(super) fn is_never(&self, id: TransitionId) -> bool {
        self.never[id.0 as usize]
    }

    /// Whether some way out of a state, or of what is around it, is meant to be taken.
    pub(super) fn is_to_be_left(&self, subject: &Subject, node: NodeId) -> bool {
        if !matches!(subject.kind(node), NodeKind::Basic | NodeKind::Start) {
            return false;
        }
        subject.outgoing(node).iter().any(|&id| !self.is_never(id) && !subject.transition(id).internal)
    }
}
