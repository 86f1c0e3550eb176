//! Elements that are dead on purpose: transitions with guard `false`, exits of endless formulas,
//! and everything reachable only through them.

use yase::{NodeId, NodeKind, TransitionId};

use super::completion;
use crate::checked_model::CheckedModel;

/// Nodes and transitions that are dead on purpose.
pub(crate) struct DeadByDesign {
    /// By node: it can only be reached, or complete, through transitions that are never taken.
    cut_off: Vec<bool>,
    /// By transition: it is never taken.
    never: Vec<bool>,
}

impl DeadByDesign {
    pub(crate) fn new(subject: &CheckedModel) -> DeadByDesign {
        let chart = &subject.chart;
        let mut intended = DeadByDesign {
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
        for id in completion::never_taken(subject) {
            intended.never[id.0 as usize] = true;
            open.push(subject.transition(id).target);
        }
        while let Some(node) = open.pop() {
            if !std::mem::replace(&mut intended.cut_off[node.0 as usize], true) {
                intended.follow(subject, node, &mut open);
            }
        }
        intended
    }

    /// Propagates that a node is unreachable: to the targets of its transitions, its children and
    /// the completion of its parent.
    fn follow(&mut self, subject: &CheckedModel, node: NodeId, open: &mut Vec<NodeId>) {
        for &id in subject.outgoing(node) {
            self.never[id.0 as usize] = true;
            open.push(subject.transition(id).target);
        }
        open.extend(subject.chart.children(node));
        if subject.kind(node) == NodeKind::End {
            self.not_completed(subject, subject.chart.node(node).parent, open);
        }
    }

    fn not_completed(&mut self, subject: &CheckedModel, composite: Option<NodeId>, open: &mut Vec<NodeId>) {
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

    /// Whether a node is unreachable by design on at least one path.
    pub(crate) fn is_cut_off(&self, node: NodeId) -> bool {
        self.cut_off[node.0 as usize]
    }

    /// Whether a transition is dead by design, directly or as a consequence.
    pub(crate) fn is_never(&self, id: TransitionId) -> bool {
        self.never[id.0 as usize]
    }

    /// Whether some exit of a state, or of a state around it, is meant to be taken.
    pub(crate) fn must_be_exited(&self, subject: &CheckedModel, node: NodeId) -> bool {
        if !matches!(subject.kind(node), NodeKind::Basic | NodeKind::Start) {
            return false;
        }
        subject.outgoing(node).iter().any(|&id| !self.is_never(id) && !subject.transition(id).internal)
    }
}
