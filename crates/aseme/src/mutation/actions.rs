//! Actions that are gone, and timers that run another time.

use std::time::Duration;

use yase::expression::{Action, ActionKind};
use yase::{Node, NodeId, TransitionId};

use super::{Kind, Making, Told};
use crate::path::shortest_path;

/// A list of actions with one of them changed or gone.
struct Variant {
    told: Told,
    actions: Vec<Action>,
}

/// All that can be done to what a transition does.
pub(super) fn of_transition(making: &mut Making<'_>, id: TransitionId) {
    let transition = making.chart.transition(id);
    if transition.expression.is_never() {
        return;
    }
    for Variant { told, actions } in variants(&transition.expression.actions) {
        making.transition(id, told, |it| it.expression.actions = actions);
    }
}

/// All that can be done to what states do when they are entered and left. A model's text has no place for a state of its own.
pub(super) fn of_states(making: &mut Making<'_>) {
    let ids: Vec<NodeId> = making.chart.nodes().map(|(id, _)| id).collect();
    for id in ids {
        of_node(making, id, "entry", |node| &mut node.entry);
        of_node(making, id, "exit", |node| &mut node.exit);
    }
}

fn of_node(making: &mut Making<'_>, id: NodeId, when: &str, actions: fn(&mut Node) -> &mut Vec<Action>) {
    let mut node = making.chart.node(id).clone();
    for Variant { told, actions: changed } in variants(actions(&mut node)) {
        let mut chart = making.chart.clone();
        let what = format!("{when} {} {changed:?}", id.0);
        *actions(chart.node_mut(id)) = changed;
        let place = format!("{} {when}", shortest_path(making.chart, id));
        making.add(&what, place, yase::Span::default(), told, chart);
    }
}

fn variants(actions: &[Action]) -> Vec<Variant> {
    let mut found = Vec::new();
    for (place, action) in actions.iter().enumerate() {
        if let ActionKind::StartTimeout { timer, delay, form } = &action.kind {
            for other in [*delay / 2, *delay * 2] {
                let mut changed = actions.to_vec();
                changed[place].kind =
                    ActionKind::StartTimeout { timer: timer.clone(), delay: other, form: *form };
                found.push(Variant { told: timed(&action.kind, *delay, other), actions: changed });
            }
        }
        let mut rest = actions.to_vec();
        rest.remove(place);
        let told = Told {
            kind: Kind::ActionRemoved,
            change: format!("the action `{action}` is removed"),
            wanted: format!("something that comes of `{action}`"),
        };
        found.push(Variant { told, actions: rest });
    }
    found
}

/// What is said of a timer that runs another time.
fn timed(kind: &ActionKind, delay: Duration, other: Duration) -> Told {
    let timer = match kind {
        ActionKind::StartTimeout { timer, .. } => timer.text(),
        _ => String::new(),
    };
    Told {
        kind: Kind::Timeout,
        change: format!("`{timer}` runs {other:?} in place of {delay:?}"),
        wanted: format!(
            "what is so between {:?} and {:?} after `{timer}` is started",
            delay.min(other),
            delay.max(other)
        ),
    }
}
