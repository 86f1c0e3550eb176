//! Checks each transition.

use super::ChartValidator;
use crate::compile::node_roles::is_state;
use crate::statechart::{Element, NodeId, NodeKind, Statechart, Transition};

impl ChartValidator<'_> {
    /// Whether both ends of each transition are nodes of the chart.
    pub(crate) fn ends_exist(&mut self) -> bool {
        let (chart, before) = (self.chart, self.found.len());
        let missing = |node: NodeId| node.0 as usize >= chart.nodes().len();
        for (id, transition) in chart.transitions() {
            self.about = Some(Element::Transition(id));
            if missing(transition.source) || missing(transition.target) {
                self.error("M03", format!("transition {} names a node that does not exist", id.0));
            }
        }
        self.found.len() == before
    }

    pub(crate) fn transitions(&mut self) {
        for (id, transition) in self.chart.transitions() {
            self.about = Some(Element::Transition(id));
            self.direction(transition);
            self.trigger(transition);
            self.internal(transition);
            self.history(transition);
        }
        self.weights();
    }

    fn direction(&mut self, transition: &Transition) {
        let (source, target) = (transition.source, transition.target);
        let nowhere = match self.kind(source) {
            NodeKind::End | NodeKind::Terminate => Some("M02"),
            _ if source == Statechart::ROOT && !transition.internal => Some("M03"),
            _ => None,
        };
        if let Some(code) = nowhere {
            let message = format!("no transition can leave `{}`", self.path(source));
            self.error(code, message);
        }
        if self.kind(target) == NodeKind::Start {
            let message = format!("no transition can enter `{}`", self.path(target));
            self.error("M02", message).hint = Some("enter the composite: it begins at its START".into());
        } else if target == Statechart::ROOT && !transition.internal {
            let message = format!("no transition can enter the root `{}`", self.path(target));
            self.error("M03", message);
        }
    }

    fn trigger(&mut self, transition: &Transition) {
        if transition.expression.trigger.is_none() {
            return;
        }
        let source = transition.source;
        let code = match self.kind(source) {
            NodeKind::Fork | NodeKind::Join => "M04",
            kind if is_state(kind) => {
                if self.kind(transition.target) == NodeKind::Join {
                    let message = format!(
                        "a transition into JOIN `{}` waits for an event",
                        self.path(transition.target)
                    );
                    self.error("M04", message).hint =
                        Some("a JOIN waits until its sources have completed".into());
                }
                return;
            }
            _ => "M02",
        };
        let message = format!("a transition out of `{}` cannot wait for an event", self.path(source));
        self.error(code, message).hint = Some("write the trigger where the path begins".into());
    }

    fn internal(&mut self, transition: &Transition) {
        let (source, target) = (transition.source, transition.target);
        if transition.internal && is_state(self.kind(source)) && !self.contains(source, target) {
            let message = format!("`{}` does not lie in `{}`", self.path(target), self.path(source));
            self.error("M03", message).hint = Some("an internal transition stays inside its source".into());
        }
    }

    fn history(&mut self, transition: &Transition) {
        let (source, target) = (transition.source, transition.target);
        let Some(owner) = self.chart.node(source).parent else { return };
        let is_history = matches!(self.kind(source), NodeKind::ShallowHistory | NodeKind::DeepHistory);
        if is_history && (target == owner || !self.contains(owner, target)) {
            let message =
                format!("`{}` leads out of its composite, to `{}`", self.path(source), self.path(target));
            self.error("M03", message).hint =
                Some("it stands for what is in its composite, and so does what it leads to".into());
        }
    }

    /// Weights are probabilities: those on the segments that leave one node sum to 1.
    fn weights(&mut self) {
        let chart = self.chart;
        let mut sums = vec![None; chart.nodes().len()];
        for (id, transition) in chart.transitions() {
            self.about = Some(Element::Transition(id));
            let Some(weight) = transition.weight else { continue };
            if !(weight > 0.0 && weight <= 1.0) {
                let message =
                    format!("a transition out of `{}` has weight {weight}", self.path(transition.source));
                self.error("M23", message).hint = Some("a weight is more than 0 and at most 1".into());
            }
            *sums[transition.source.0 as usize].get_or_insert(0.0) += weight;
        }
        for ((node, _), sum) in chart.nodes().zip(sums) {
            self.about = Some(Element::Node(node));
            let Some(sum) = sum.filter(|sum: &f64| (sum - 1.0).abs() > 1e-6) else { continue };
            let message = format!("the weights of the transitions out of `{}` sum to {sum}", self.path(node));
            self.error("M23", message).hint = Some("they are shares, and sum to 1".into());
        }
    }
}
