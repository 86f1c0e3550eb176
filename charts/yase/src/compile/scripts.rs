//! The locations of the scripts of a chart.

use crate::expression::{Action, ActionKind, Expression, ExpressionKind, ScriptId, ScriptInterner};
use crate::ids::ActionLocation;
use crate::statechart::{Statechart, TransitionId};

/// A script of a chart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ScriptEntry<'a> {
    /// Its number.
    pub id: ScriptId,
    /// Its text.
    pub text: &'a str,
    /// Its locations.
    pub locations: &'a [ScriptLocation],
}

/// The location of a script.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum ScriptLocation {
    /// In the guard of a segment.
    Guard(TransitionId),
    /// In the value of an assignment, or as an action: the action list, and the index in it, from
    /// 0.
    Action(ActionLocation, usize),
}

/// The locations of each script, by its number: guards and actions of transitions, then those of
/// nodes.
pub(crate) fn script_locations(chart: &Statechart, scripts: &ScriptInterner) -> Box<[Box<[ScriptLocation]>]> {
    let mut locations = vec![Vec::new(); scripts.len()];
    if scripts.is_empty() {
        return Box::default();
    }
    let mut note = |text: &str, location: ScriptLocation| {
        if let Some(list) = scripts.find(text).and_then(|id| locations.get_mut(id.0 as usize))
            && list.last() != Some(&location)
        {
            list.push(location);
        }
    };
    for (id, transition) in chart.transitions() {
        let expression = &transition.expression;
        if let Some(guard) = &expression.guard {
            walk(guard, &mut |text| note(text, ScriptLocation::Guard(id)));
        }
        of_actions(&expression.actions, ActionLocation::Transition(id), &mut note);
    }
    for (id, node) in chart.nodes() {
        of_actions(&node.entry, ActionLocation::Entry(id), &mut note);
        of_actions(&node.exit, ActionLocation::Exit(id), &mut note);
    }
    locations.into_iter().map(Vec::into_boxed_slice).collect()
}

fn of_actions(actions: &[Action], location: ActionLocation, note: &mut impl FnMut(&str, ScriptLocation)) {
    for (index, action) in actions.iter().enumerate() {
        let here = ScriptLocation::Action(location, index);
        match &action.kind {
            ActionKind::Script(text) => note(text, here),
            ActionKind::Assign { value, .. } => walk(value, &mut |text| note(text, here)),
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
