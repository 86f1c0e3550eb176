//! Where the scripts of a chart stand.

use crate::expression::{Action, ActionKind, Expression, ExpressionKind, ScriptId, ScriptTable};
use crate::host::ActionPlace;
use crate::statechart::{Statechart, TransitionId};

/// A script of a chart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ScriptEntry<'a> {
    /// Its number.
    pub id: ScriptId,
    /// Its text.
    pub text: &'a str,
    /// Where it stands.
    pub places: &'a [ScriptPlace],
}

/// Where a script stands.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum ScriptPlace {
    /// In the guard of a segment.
    Guard(TransitionId),
    /// In the value of an assignment, or as an action: where, and its number there, from 0.
    Action(ActionPlace, usize),
}

/// The places of each script, by its number: guards and actions of transitions, then those of nodes.
pub(super) fn places(chart: &Statechart, scripts: &ScriptTable) -> Box<[Box<[ScriptPlace]>]> {
    let mut places = vec![Vec::new(); scripts.len()];
    if scripts.is_empty() {
        return Box::default();
    }
    let mut note = |text: &str, place: ScriptPlace| {
        if let Some(list) = scripts.find(text).and_then(|id| places.get_mut(id.0 as usize))
            && list.last() != Some(&place)
        {
            list.push(place);
        }
    };
    for (id, transition) in chart.transitions() {
        let expression = &transition.expression;
        if let Some(guard) = &expression.guard {
            walk(guard, &mut |text| note(text, ScriptPlace::Guard(id)));
        }
        of_actions(&expression.actions, ActionPlace::Transition(id), &mut note);
    }
    for (id, node) in chart.nodes() {
        of_actions(&node.entry, ActionPlace::Entry(id), &mut note);
        of_actions(&node.exit, ActionPlace::Exit(id), &mut note);
    }
    places.into_iter().map(Vec::into_boxed_slice).collect()
}

fn of_actions(actions: &[Action], place: ActionPlace, note: &mut impl FnMut(&str, ScriptPlace)) {
    for (index, action) in actions.iter().enumerate() {
        let place = ScriptPlace::Action(place, index);
        match &action.kind {
            ActionKind::Script(text) => note(text, place),
            ActionKind::Assign { value, .. } => walk(value, &mut |text| note(text, place)),
            _ => {}
        }
    }
}

/// Finds the scripts in an expression.
fn walk(expression: &Expression, found: &mut dyn FnMut(&str)) {
    if let ExpressionKind::Script(text) = &expression.kind {
        found(text);
    }
    expression.parts().into_iter().for_each(|operand| walk(operand, found));
}
