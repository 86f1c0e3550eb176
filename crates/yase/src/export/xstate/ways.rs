//! The ways from a state over connectors to where they come to rest.
//!
//! XState reads a guard when it stands before it; here the guards of all segments are read before anything happens. So CONDITION and JUNCTION
//! are no states there: each way over them is a transition of its own.

use super::super::lost::Lost;
use super::super::notation::kind_word;
use super::super::outline::sound_transitions;
use crate::expression::{Expression, ExpressionKind, Name, Place, TransitionExpression, Trigger};
use crate::statechart::{NodeId, NodeKind, Statechart, Transition};

/// No way is longer.
const MAX_SEGMENTS: usize = 64;
/// No chart has more ways, or a handful of connectors would make millions.
const MAX_WAYS: usize = 20_000;

/// One way: its segments, and where it comes to rest.
#[derive(Clone)]
pub(super) struct Way<'a> {
    /// The states it leaves together, if it leads over a join.
    pub(super) joined: Vec<NodeId>,
    pub(super) segments: Vec<&'a Transition>,
    pub(super) targets: Vec<NodeId>,
}

/// What a way does at a node.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Role {
    /// It goes on over one of the segments.
    Branch,
    /// It goes on over all segments.
    Fork,
    /// It waits for the others.
    Join,
    /// It ends.
    Rest,
}

/// What ways do at a node: points of entry and exit on the border of an AND are a fork and a join.
pub(super) fn role(chart: &Statechart, id: NodeId) -> Role {
    let node = chart.node(id);
    let on_and = node.parent.is_some_and(|parent| chart.node(parent).kind == NodeKind::And);
    match node.kind {
        NodeKind::EntryPoint if on_and => Role::Fork,
        NodeKind::ExitPoint if on_and => Role::Join,
        NodeKind::Condition | NodeKind::Junction | NodeKind::EntryPoint | NodeKind::ExitPoint => Role::Branch,
        NodeKind::Fork => Role::Fork,
        NodeKind::Join => Role::Join,
        _ => Role::Rest,
    }
}

/// All ways of a chart.
pub(super) struct Ways<'a> {
    chart: &'a Statechart,
    /// By node, the first to be tried first.
    outgoing: Vec<Vec<&'a Transition>>,
    left: usize,
}

impl<'a> Ways<'a> {
    pub(super) fn of(chart: &'a Statechart) -> Ways<'a> {
        let mut outgoing: Vec<Vec<&Transition>> = vec![Vec::new(); chart.nodes().len()];
        for (_, transition) in sound_transitions(chart) {
            outgoing[transition.source.0 as usize].push(transition);
        }
        for segments in &mut outgoing {
            segments.sort_by_key(|it| (std::cmp::Reverse(it.priority), it.expression.guard.is_none()));
        }
        Ways { chart, outgoing, left: MAX_WAYS }
    }

    pub(super) fn outgoing(&self, id: NodeId) -> &[&'a Transition] {
        &self.outgoing[id.0 as usize]
    }

    /// The ways out of a node, the first to be tried first, without those that lead into a join.
    pub(super) fn from(&mut self, id: NodeId, lost: &mut Lost<'_>) -> Vec<Way<'a>> {
        let mut found = Vec::new();
        let mut open: Vec<Vec<&Transition>> = self.outgoing(id).iter().rev().map(|&it| vec![it]).collect();
        while let Some(way) = open.pop() {
            let Some(&last) = way.last() else { continue };
            if self.left == 0 {
                lost.left_out(format!(
                    "there are too many ways; the one that ends with {}",
                    lost.arrow(last)
                ));
                continue;
            }
            self.left -= 1;
            let target = last.target;
            match role(self.chart, target) {
                Role::Rest => found.push(Way { joined: vec![], segments: way, targets: vec![target] }),
                Role::Branch if self.outgoing(target).is_empty() => {
                    lost.left_out(format!("{} leads nowhere", lost.arrow(last)));
                }
                Role::Branch if way.len() == MAX_SEGMENTS => {
                    lost.left_out(format!("{} is on a way that does not end", lost.arrow(last)));
                }
                Role::Branch => {
                    let next = self.outgoing(target).iter().rev();
                    open.extend(next.map(|&segment| [&way[..], &[segment]].concat()));
                }
                Role::Fork => found.extend(self.fork(way, target, lost)),
                Role::Join if way.len() == 1 && role(self.chart, id) == Role::Rest => {}
                Role::Join => {
                    lost.left_out(format!("{} leads from connector to connector", lost.arrow(last)))
                }
            }
        }
        found
    }

    fn fork(&self, way: Vec<&'a Transition>, fork: NodeId, lost: &mut Lost<'_>) -> Option<Way<'a>> {
        let (mut segments, mut targets) = (way, Vec::new());
        for &branch in self.outgoing(fork) {
            if role(self.chart, branch.target) == Role::Rest {
                segments.push(branch);
                targets.push(branch.target);
            } else {
                lost.left_out(format!("{} leads from connector to connector", lost.arrow(branch)));
            }
        }
        if targets.is_empty() {
            let word = kind_word(self.chart.node(fork).kind);
            lost.left_out(format!("no way leads on from {word} `{}`", self.chart.path(fork)));
            return None;
        }
        Some(Way { joined: vec![], segments, targets })
    }
}

impl Way<'_> {
    /// The connectors it leads over.
    pub(super) fn via(&self, chart: &Statechart) -> Vec<NodeId> {
        let sources = self.segments.iter().map(|segment| segment.source);
        let mut via: Vec<NodeId> = sources.filter(|&id| role(chart, id) != Role::Rest).collect();
        via.dedup();
        via
    }

    /// What must hold on all of it, with the trigger that XState has no word for.
    pub(super) fn guard(&self, chart: &Statechart) -> Option<String> {
        let joined = self.joined.iter().map(|&id| In(chart.path(id)).expression());
        let guards = self.segments.iter().filter_map(|segment| segment.expression.guard.clone());
        let operands: Vec<Expression> = joined.chain(guards).flat_map(operands).collect();
        let guard = match operands.as_slice() {
            [] => None,
            [only] => Some(only.clone()),
            _ => Some(Expression { kind: ExpressionKind::And(operands), place: Place::default() }),
        };
        match self.trigger() {
            Some(Trigger::Not(event)) => {
                let trigger = Some(Trigger::Not(event.clone()));
                Some(TransitionExpression { trigger, guard, actions: vec![] }.to_string())
            }
            _ => guard.map(|guard| guard.to_string()),
        }
    }

    pub(super) fn trigger(&self) -> Option<&Trigger> {
        self.segments.iter().find_map(|segment| segment.expression.trigger.as_ref())
    }

    /// Whether a guard on it says `false`.
    pub(super) fn is_never(&self) -> bool {
        self.segments.iter().any(|segment| segment.expression.is_never())
    }

    pub(super) fn has_guard(&self) -> bool {
        self.segments.iter().any(|segment| segment.expression.guard.is_some())
    }
}

/// That a state is active.
struct In(String);

impl In {
    fn expression(self) -> Expression {
        let name = Name { text: self.0, place: Place::default() };
        Expression { kind: ExpressionKind::In(name), place: Place::default() }
    }
}

/// The operands of an `&&`, or the expression alone.
fn operands(expression: Expression) -> Vec<Expression> {
    match expression.kind {
        ExpressionKind::And(operands) => operands,
        _ => vec![expression],
    }
}
