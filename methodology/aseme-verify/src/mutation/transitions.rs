//! Mutants: transitions with another target, removed, or in another order.

use std::cmp::Reverse;

use yase::expression::{Expression, ExpressionKind, TextPosition};
use yase::{NodeId, NodeKind, Statechart, Transition, TransitionId};

use super::{MutantCollector, MutantDescription, MutationKind};
use crate::logic::{Claim, GuardSolver};

/// All mutants of the target, presence and order of a transition.
pub(crate) fn of_transition(making: &mut MutantCollector<'_>, id: TransitionId) {
    if making.chart.transition(id).expression.is_never() {
        return;
    }
    target(making, id);
    removed(making, id);
    priority(making, id);
}

fn target(making: &mut MutantCollector<'_>, id: TransitionId) {
    let chart = making.chart;
    let before = chart.transition(id).target;
    let Some(after) = sibling(chart, before) else { return };
    let (from, to) = (making.names.name(before), making.names.name(after));
    let mutation = MutantDescription {
        kind: MutationKind::Target,
        change: format!("the target is `{to}`"),
        wanted: format!("that `{from}` is entered and not `{to}`"),
    };
    making.transition(id, mutation, |it| it.target = after);
}

/// The next sibling state of a node in document order, cyclically; none if there is no other.
fn sibling(chart: &Statechart, node: NodeId) -> Option<NodeId> {
    let parent = chart.node(node).parent?;
    if chart.node(parent).kind == NodeKind::And {
        return None;
    }
    let is_state = |id: &NodeId| {
        let kind = chart.node(*id).kind;
        matches!(kind, NodeKind::Or | NodeKind::And | NodeKind::Basic | NodeKind::End)
    };
    let children = chart.children(parent);
    let index = children.iter().position(|&child| child == node)?;
    let after = children.iter().skip(index + 1).chain(children.iter().take(index));
    after.copied().find(is_state)
}

fn removed(making: &mut MutantCollector<'_>, id: TransitionId) {
    let mutation = MutantDescription {
        kind: MutationKind::TransitionRemoved,
        change: String::from("it is never taken"),
        wanted: String::from("a case in which it is taken"),
    };
    let never = Expression { kind: ExpressionKind::Bool(false), position: TextPosition::default() };
    making.transition(id, mutation, |it| it.expression.guard = Some(never));
}

/// Adds the mutant that tries the next transition before this one.
fn priority(making: &mut MutantCollector<'_>, id: TransitionId) {
    let chart = making.chart;
    let Some(later) = next(chart, id).filter(|later| matters(chart, id, *later)) else { return };
    let (first, second) = (making.arrow(id), making.arrow(later));
    let mutation = MutantDescription {
        kind: MutationKind::Priority,
        change: format!("`{second}` is tried before it"),
        wanted: format!("a case in which `{first}` and `{second}` are both enabled"),
    };
    let (high, low) = (chart.transition(id).priority, chart.transition(later).priority);
    let mut changed = chart.clone();
    match high == low {
        true => changed.transition_mut(later).priority = high.saturating_add(1),
        false => {
            changed.transition_mut(id).priority = low;
            changed.transition_mut(later).priority = high;
        }
    }
    let span = making.spans.get(id.0 as usize).copied().unwrap_or_default();
    making.add(
        &format!("priority {} {}", id.0, later.0),
        (first, making.names.transition_path(id)),
        span,
        mutation,
        changed,
    );
}

/// The next transition of the same node, for the same event, in selection order.
fn next(chart: &Statechart, id: TransitionId) -> Option<TransitionId> {
    let this = chart.transition(id);
    let is_beside = |it: &Transition| {
        it.source == this.source
            && it.expression.trigger == this.expression.trigger
            && it.weight.is_none()
            && this.weight.is_none()
            && !it.expression.is_never()
    };
    let rank = |id: TransitionId| {
        let it = chart.transition(id);
        (Reverse(it.priority), it.expression.guard.is_none(), id)
    };
    let siblings = chart.transitions().filter(|(_, it)| is_beside(it)).map(|(id, _)| id);
    siblings.filter(|&other| rank(other) > rank(id)).min_by_key(|&other| rank(other))
}

/// Whether the order of two transitions has an effect: both may be enabled and their effects
/// differ.
fn matters(chart: &Statechart, first: TransitionId, second: TransitionId) -> bool {
    let (first, second) = (chart.transition(first), chart.transition(second));
    let is_same = first.target == second.target && first.expression.actions == second.expression.actions;
    let exclude = match (&first.expression.guard, &second.expression.guard) {
        (Some(one), Some(other)) => {
            GuardSolver::new(&chart.constants).together(&[Claim::Holds(one), Claim::Holds(other)]).is_no()
        }
        _ => false,
    };
    !is_same && !exclude
}
