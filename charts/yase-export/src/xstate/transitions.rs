//! Transition paths from a state over connectors to the next states.
//!
//! XState evaluates a guard when it reaches it; YASE evaluates the guards of all segments before
//! any action. Therefore CONDITION and JUNCTION are not states in XState: each path over them is a
//! separate transition.

use super::super::loss_report::LossReport;
use super::super::notation::kind_word;
use super::super::outline::sound_transitions;
use yase::expression::{Expression, ExpressionKind, Name, TextPosition, TransitionExpression, Trigger};
use yase::statechart::{NodeId, NodeKind, Statechart, Transition};

/// Maximum length of a path.
const MAX_SEGMENTS: usize = 64;
/// Maximum number of paths of a chart; a few connectors could otherwise create millions.
const MAX_WAYS: usize = 20_000;

/// One path: its segments, and the nodes at its end.
#[derive(Clone)]
pub(crate) struct ResolvedTransition<'a> {
    /// The states that it exits together, if it contains a join.
    pub(crate) joined: Vec<NodeId>,
    pub(crate) segments: Vec<&'a Transition>,
    pub(crate) targets: Vec<NodeId>,
}

/// The role of a connector in a path.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum ConnectorRole {
    /// It continues over one of the segments.
    Branch,
    /// It continues over all segments.
    Fork,
    /// It waits for other segments.
    Join,
    /// It ends.
    Rest,
}

/// The role of a node in paths: entry and exit points on the border of an AND are a fork and a
/// join.
pub(crate) fn role(chart: &Statechart, id: NodeId) -> ConnectorRole {
    let node = chart.node(id);
    let on_and = node.parent.is_some_and(|parent| chart.node(parent).kind == NodeKind::And);
    match node.kind {
        NodeKind::EntryPoint if on_and => ConnectorRole::Fork,
        NodeKind::ExitPoint if on_and => ConnectorRole::Join,
        NodeKind::Condition | NodeKind::Junction | NodeKind::EntryPoint | NodeKind::ExitPoint => {
            ConnectorRole::Branch
        }
        NodeKind::Fork => ConnectorRole::Fork,
        NodeKind::Join => ConnectorRole::Join,
        _ => ConnectorRole::Rest,
    }
}

/// All transition paths of a chart.
pub(crate) struct TransitionResolver<'a> {
    chart: &'a Statechart,
    /// By node, in the order of selection.
    outgoing: Vec<Vec<&'a Transition>>,
    left: usize,
}

impl<'a> TransitionResolver<'a> {
    pub(crate) fn of(chart: &'a Statechart) -> TransitionResolver<'a> {
        let mut outgoing: Vec<Vec<&Transition>> = vec![Vec::new(); chart.nodes().len()];
        for (_, transition) in sound_transitions(chart) {
            outgoing[transition.source.0 as usize].push(transition);
        }
        for segments in &mut outgoing {
            segments.sort_by_key(|it| (std::cmp::Reverse(it.priority), it.expression.guard.is_none()));
        }
        TransitionResolver { chart, outgoing, left: MAX_WAYS }
    }

    pub(crate) fn outgoing(&self, id: NodeId) -> &[&'a Transition] {
        &self.outgoing[id.0 as usize]
    }

    /// The paths out of a node in the order of selection, without those that lead into a join.
    pub(crate) fn from(&mut self, id: NodeId, lost: &mut LossReport<'_>) -> Vec<ResolvedTransition<'a>> {
        let mut found = Vec::new();
        let mut open: Vec<Vec<&Transition>> = self.outgoing(id).iter().rev().map(|&it| vec![it]).collect();
        while let Some(transitions) = open.pop() {
            let Some(&last) = transitions.last() else { continue };
            if self.left == 0 {
                lost.report_omitted(format!(
                    "there are too many paths; the one that ends with {}",
                    lost.arrow(last)
                ));
                continue;
            }
            self.left -= 1;
            let target = last.target;
            match role(self.chart, target) {
                ConnectorRole::Rest => found.push(ResolvedTransition {
                    joined: vec![],
                    segments: transitions,
                    targets: vec![target],
                }),
                ConnectorRole::Branch if self.outgoing(target).is_empty() => {
                    lost.report_omitted(format!("{} leads nowhere", lost.arrow(last)));
                }
                ConnectorRole::Branch if transitions.len() == MAX_SEGMENTS => {
                    lost.report_omitted(format!("{} is on a path that does not end", lost.arrow(last)));
                }
                ConnectorRole::Branch => {
                    let next = self.outgoing(target).iter().rev();
                    open.extend(next.map(|&segment| [&transitions[..], &[segment]].concat()));
                }
                ConnectorRole::Fork => found.extend(self.fork(transitions, target, lost)),
                ConnectorRole::Join
                    if transitions.len() == 1 && role(self.chart, id) == ConnectorRole::Rest => {}
                ConnectorRole::Join => {
                    lost.report_omitted(format!("{} leads from connector to connector", lost.arrow(last)))
                }
            }
        }
        found
    }

    fn fork(
        &self,
        transitions: Vec<&'a Transition>,
        fork: NodeId,
        lost: &mut LossReport<'_>,
    ) -> Option<ResolvedTransition<'a>> {
        let (mut segments, mut targets) = (transitions, Vec::new());
        for &branch in self.outgoing(fork) {
            if role(self.chart, branch.target) == ConnectorRole::Rest {
                segments.push(branch);
                targets.push(branch.target);
            } else {
                lost.report_omitted(format!("{} leads from connector to connector", lost.arrow(branch)));
            }
        }
        if targets.is_empty() {
            let word = kind_word(self.chart.node(fork).kind);
            lost.report_omitted(format!("no path continues from {word} `{}`", self.chart.path(fork)));
            return None;
        }
        Some(ResolvedTransition { joined: vec![], segments, targets })
    }
}

impl ResolvedTransition<'_> {
    /// The connectors on its path.
    pub(crate) fn via(&self, chart: &Statechart) -> Vec<NodeId> {
        let sources = self.segments.iter().map(|segment| segment.source);
        let mut via: Vec<NodeId> = sources.filter(|&id| role(chart, id) != ConnectorRole::Rest).collect();
        via.dedup();
        via
    }

    /// The conjunction of all guards, including triggers that XState cannot express.
    pub(crate) fn guard(&self, chart: &Statechart) -> Option<String> {
        let joined = self.joined.iter().map(|&id| In(chart.path(id)).expression());
        let guards = self.segments.iter().filter_map(|segment| segment.expression.guard.clone());
        let operands: Vec<Expression> = joined.chain(guards).flat_map(operands).collect();
        let guard = match operands.as_slice() {
            [] => None,
            [only] => Some(only.clone()),
            _ => Some(Expression { kind: ExpressionKind::And(operands), position: TextPosition::default() }),
        };
        match self.trigger() {
            Some(Trigger::Not(event)) => {
                let trigger = Some(Trigger::Not(event.clone()));
                Some(TransitionExpression { trigger, guard, actions: vec![] }.to_string())
            }
            _ => guard.map(|guard| guard.to_string()),
        }
    }

    pub(crate) fn trigger(&self) -> Option<&Trigger> {
        self.segments.iter().find_map(|segment| segment.expression.trigger.as_ref())
    }

    /// Whether one of its guards is `false`.
    pub(crate) fn is_never(&self) -> bool {
        self.segments.iter().any(|segment| segment.expression.is_never())
    }

    pub(crate) fn has_guard(&self) -> bool {
        self.segments.iter().any(|segment| segment.expression.guard.is_some())
    }
}

/// Condition that a state is active.
struct In(String);

impl In {
    fn expression(self) -> Expression {
        let name = Name { text: self.0, position: TextPosition::default() };
        Expression { kind: ExpressionKind::In(name), position: TextPosition::default() }
    }
}

/// The operands of an `&&`, or the expression alone.
fn operands(expression: Expression) -> Vec<Expression> {
    match expression.kind {
        ExpressionKind::And(operands) => operands,
        _ => vec![expression],
    }
}
