//! Targets of transitions.

use super::states::actions;
use super::{DocumentReader, PendingTransition, TargetReference};
use crate::guard::native;
use yase::diagnostic::Diagnostic;
use yase::expression::{Expression, ExpressionKind, TextPosition, TransitionExpression};
use yase::statechart::{Node, NodeId, NodeKind, Statechart, Transition};

/// Maximum number of targets of a transition: each is compared with every other.
const MAX_TARGETS: usize = 256;

impl DocumentReader<'_> {
    /// Resolves the targets of all transitions and adds the transitions to the chart.
    pub(crate) fn connect(&mut self) {
        for mut pending in std::mem::take(&mut self.pending) {
            let targets = std::mem::take(&mut pending.targets);
            let Some(targets) = self.resolve(&pending, &targets) else { continue };
            if self.check_targets(&pending, &targets) {
                self.connect_one(&pending, &targets);
            }
        }
    }

    fn resolve(&mut self, pending: &PendingTransition, targets: &[TargetReference]) -> Option<Vec<NodeId>> {
        if let (true, Some(composite)) = (targets.is_empty(), pending.within) {
            return self.first_state(composite).map(|first| vec![first]);
        }
        let mut nodes = Vec::new();
        for target in targets {
            match self.ids.get(&target.name) {
                Some(node) if nodes.contains(node) => {}
                Some(node) => nodes.push(*node),
                None => {
                    let message = format!("there is no state `{}`", target.name);
                    let diagnostic = Diagnostic::error("E0606", target.span, message);
                    let known = self.ids.keys().map(String::as_str);
                    let found = diagnostic.with_suggestion(&self.suggestions, &target.name, known);
                    self.report(found);
                }
            }
        }
        targets.iter().all(|target| self.ids.contains_key(&target.name)).then_some(nodes)
    }

    fn first_state(&self, composite: NodeId) -> Option<NodeId> {
        use NodeKind::{And, Basic, End, Or};
        let is_state = |child: &&NodeId| matches!(self.statechart.node(**child).kind, And | Basic | End | Or);
        self.statechart.children(composite).iter().find(is_state).copied()
    }

    fn check_targets(&mut self, pending: &PendingTransition, targets: &[NodeId]) -> bool {
        if targets.len() > MAX_TARGETS {
            let message = format!("the transition has more than {MAX_TARGETS} targets");
            self.error("E0607", pending.span, message);
            return false;
        }
        let outside = targets
            .iter()
            .find(|&&target| pending.within.is_some_and(|composite| !self.lies_in(target, composite)));
        if let Some(&outside) = outside {
            let message = format!("`{}` does not lie inside", self.name(outside));
            self.error("E0606", pending.span, message).hint =
                Some("an initial state, like a history's default, is one of the composite".into());
            return false;
        }
        let shallow = self.statechart.node(pending.source).kind == NodeKind::ShallowHistory;
        let grandchild =
            targets.iter().find(|&&target| self.statechart.node(target).parent != pending.within);
        if let (true, Some(&grandchild)) = (shallow, grandchild) {
            let message = format!(
                "`{}` is not a child of the history's state; the default of a shallow history is meant to be one",
                self.name(grandchild)
            );
            self.report(Diagnostic::warning("E0606", pending.span, message));
        }
        for (index, &first) in targets.iter().enumerate() {
            for &second in &targets[index + 1..] {
                if !self.are_orthogonal(first, second) {
                    let message = format!(
                        "`{}` and `{}` cannot be entered together",
                        self.name(first),
                        self.name(second)
                    );
                    self.error("E0607", pending.span, message).hint =
                        Some("several targets lie in different regions of one `parallel`".into());
                    return false;
                }
            }
        }
        true
    }

    fn name(&self, node: NodeId) -> &str {
        &self.statechart.node(node).name
    }

    fn lies_in(&self, node: NodeId, composite: NodeId) -> bool {
        self.statechart.ancestors(node).any(|ancestor| ancestor == composite)
    }

    fn are_orthogonal(&self, first: NodeId, second: NodeId) -> bool {
        if self.lies_in(first, second) || self.lies_in(second, first) {
            return false;
        }
        let common = self.statechart.ancestors(first).find(|&ancestor| self.lies_in(second, ancestor));
        common.is_some_and(|common| self.statechart.node(common).kind == NodeKind::And)
    }

    fn connect_one(&mut self, pending: &PendingTransition, targets: &[NodeId]) {
        let source = pending.source;
        let composite = self.statechart.node(source).kind == NodeKind::Or;
        let inside = targets.iter().all(|&target| self.lies_in(target, source));
        let internal = targets.is_empty() || (pending.internal && composite && inside);
        let expression = self.expression_of(pending);
        let target = match targets {
            [] => source,
            [target] => *target,
            several => self.fork(pending, several, internal),
        };
        self.statechart.connect(Transition { expression, internal, ..Transition::new(source, target) });
        if targets.len() > 1 {
            for &branch in targets {
                self.statechart.connect(Transition::new(target, branch));
            }
        }
    }

    fn expression_of(&self, pending: &PendingTransition) -> TransitionExpression {
        let guard = pending.condition.as_ref().map(|(code, span)| {
            let position = TextPosition(*span);
            let native =
                code.compiled().and_then(|script| native(script, &|name| self.is_found(name), position));
            let script = || Expression { kind: ExpressionKind::Script(code.text.clone()), position };
            native.unwrap_or_else(script)
        });
        TransitionExpression {
            trigger: pending.trigger.clone(),
            guard,
            actions: actions(&pending.block, pending.span),
        }
    }

    /// Whether a chart finds the state by its name, and no other node.
    fn is_found(&self, name: &str) -> bool {
        let connector = ["START", "END", "CONDITION"].contains(&name);
        self.ids.contains_key(name) && !connector && self.name(Statechart::ROOT) != name
    }

    /// A FORK in the composite that contains the source and all targets.
    fn fork(&mut self, pending: &PendingTransition, targets: &[NodeId], internal: bool) -> NodeId {
        let parent = match pending.within {
            Some(composite) => composite,
            None if internal => pending.source,
            None => self.scope(pending.source, targets),
        };
        self.statechart.add(parent, Node::new(NodeKind::Fork, ""))
    }

    fn scope(&self, source: NodeId, targets: &[NodeId]) -> NodeId {
        let holds_all = |ancestor: &NodeId| {
            self.statechart.node(*ancestor).kind == NodeKind::Or
                && targets.iter().all(|&target| self.lies_in(target, *ancestor))
        };
        self.statechart.ancestors(source).find(holds_all).unwrap_or(Statechart::ROOT)
    }
}
