//! Mutants: removed actions and timers with another delay.

use std::time::Duration;

use yase::expression::{Action, ActionKind, Expression, ExpressionKind, TransitionExpression};
use yase::{Node, NodeId, Statechart, Transition, TransitionId};

use super::{MutantCollector, MutantDescription, MutationKind};

/// A list of actions with one of them changed or removed.
struct ActionVariant {
    description: MutantDescription,
    actions: Vec<Action>,
    /// The start of a timer that was removed.
    unstarted: Option<Action>,
}

/// All mutants of the actions of a transition.
pub(crate) fn of_transition(making: &mut MutantCollector<'_>, id: TransitionId) {
    let transition = making.chart.transition(id);
    if transition.expression.is_never() {
        return;
    }
    for ActionVariant { description, actions, unstarted } in variants(&transition.expression.actions) {
        making.changed(id, description, |chart| {
            chart.transition_mut(id).expression.actions = actions;
            unstarted.into_iter().for_each(|action| keep_known(chart, id, action));
        });
    }
}

/// Keeps a removed timer start in the chart, at a place that is never executed, because reading a
/// timer that nothing starts would not compile.
fn keep_known(chart: &mut Statechart, id: TransitionId, action: Action) {
    let Transition { source, target, .. } = *chart.transition(id);
    let never = Expression { kind: ExpressionKind::Bool(false), position: action.position };
    let expression = TransitionExpression { trigger: None, guard: Some(never), actions: vec![action] };
    chart.connect(Transition { expression, ..Transition::new(source, target) });
}

/// All mutants of the entry and exit actions of states. States have no span in a model's text.
pub(crate) fn of_states(making: &mut MutantCollector<'_>) {
    let ids: Vec<NodeId> = making.chart.nodes().map(|(id, _)| id).collect();
    for id in ids {
        of_node(making, id, "entry", |node| &mut node.entry);
        of_node(making, id, "exit", |node| &mut node.exit);
    }
}

fn of_node(
    making: &mut MutantCollector<'_>,
    id: NodeId,
    when: &str,
    actions: fn(&mut Node) -> &mut Vec<Action>,
) {
    let mut node = making.chart.node(id).clone();
    for ActionVariant { description, actions: changed, .. } in variants(actions(&mut node)) {
        let mut chart = making.chart.clone();
        let what = format!("{when} {} {changed:?}", id.0);
        *actions(chart.node_mut(id)) = changed;
        let names = &making.names;
        let element = (format!("{} {when}", names.name(id)), names.path(id));
        making.add(&what, element, yase::Span::default(), description, chart);
    }
}

fn variants(actions: &[Action]) -> Vec<ActionVariant> {
    let mut found = Vec::new();
    for (index, action) in actions.iter().enumerate() {
        if let ActionKind::StartTimeout { timer, delay, form } = &action.kind {
            for other in [*delay / 2, *delay * 2] {
                let mut changed = actions.to_vec();
                changed[index].kind =
                    ActionKind::StartTimeout { timer: timer.clone(), delay: other, form: *form };
                let description = timed(&timer.text(), *delay, other);
                found.push(ActionVariant { description, actions: changed, unstarted: None });
            }
        }
        let mut rest = actions.to_vec();
        rest.remove(index);
        found.push(gone(action, rest));
    }
    found
}

/// A variant with one action removed.
fn gone(action: &Action, rest: Vec<Action>) -> ActionVariant {
    let wanted = format!("an effect of `{action}`");
    match &action.kind {
        ActionKind::StartTimeout { timer, .. } => {
            let change = format!("`{timer}` is never started");
            let description = MutantDescription { kind: MutationKind::Timeout, change, wanted };
            ActionVariant { description, actions: rest, unstarted: Some(action.clone()) }
        }
        _ => {
            let change = format!("the action `{action}` is removed");
            let description = MutantDescription { kind: MutationKind::ActionRemoved, change, wanted };
            ActionVariant { description, actions: rest, unstarted: None }
        }
    }
}

/// Describes a timer with another delay.
fn timed(timer: &str, delay: Duration, other: Duration) -> MutantDescription {
    MutantDescription {
        kind: MutationKind::Timeout,
        change: format!("`{timer}` runs {other:?} instead of {delay:?}"),
        wanted: format!(
            "the behaviour between {:?} and {:?} after the start of `{timer}`",
            delay.min(other),
            delay.max(other)
        ),
    }
}
