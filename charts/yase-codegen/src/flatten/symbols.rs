//! The conditions and actions of a chart as numbered scripts without meaning.

use crate::flatten::FlatEvent;
use yase::diagnostic::{Diagnostic, Span};
use yase::expression::{Action, ActionKind, Expression, ExpressionKind, Trigger};
use yase::statechart::{Statechart, TransitionId};

const CONDITION: &str = "condition ";
const ACTION: &str = "action ";

/// A chart of numbered scripts, and the texts of the scripts.
pub(crate) struct SymbolTable {
    pub(crate) chart: Statechart,
    pub(crate) events: Vec<FlatEvent>,
    pub(crate) conditions: Vec<String>,
    pub(crate) actions: Vec<String>,
}

/// The meaning of a script of such a chart.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Symbol {
    Condition(usize),
    Action(usize),
}

impl Symbol {
    pub(crate) fn of(script: &str) -> Option<Symbol> {
        let number = |prefix| script.strip_prefix(prefix).and_then(|number| number.parse().ok());
        number(CONDITION).map(Symbol::Condition).or_else(|| number(ACTION).map(Symbol::Action))
    }
}

impl SymbolTable {
    pub(crate) fn of(chart: &Statechart) -> SymbolTable {
        let mut words = SymbolTable {
            chart: chart.clone(),
            events: events(chart),
            conditions: Vec::new(),
            actions: Vec::new(),
        };
        for (id, transition) in chart.transitions() {
            let mut expression = transition.expression.clone();
            expression.guard.iter_mut().for_each(|guard| words.condition(guard));
            expression.actions.iter_mut().for_each(|action| words.action(action));
            words.chart.transition_mut(id).expression = expression;
        }
        for (id, node) in chart.nodes() {
            let (mut entry, mut exit) = (node.entry.clone(), node.exit.clone());
            entry.iter_mut().chain(&mut exit).for_each(|action| words.action(action));
            let changed = words.chart.node_mut(id);
            (changed.entry, changed.exit) = (entry, exit);
        }
        words
    }

    /// Keeps tests for states and the operators around them. A condition that can be unknown, since
    /// it reads a message that may not have arrived, becomes a separate script for its negation:
    /// neither holds while it is unknown.
    fn condition(&mut self, guard: &mut Expression) {
        let speaks_of_states = reads_states(guard);
        match &mut guard.kind {
            ExpressionKind::Bool(_) | ExpressionKind::In(_) => {}
            ExpressionKind::Or(parts) | ExpressionKind::And(parts) if speaks_of_states => {
                parts.iter_mut().for_each(|part| self.condition(part));
            }
            ExpressionKind::Not(operand) if has_two_values(operand) => self.condition(operand),
            ExpressionKind::Not(operand) if speaks_of_states && !reads_conditions(operand) => {
                guard.kind = negated(operand);
                self.condition(guard);
            }
            kind => {
                let text = match kind {
                    ExpressionKind::Script(text) => text.clone(),
                    _ => guard.to_string(),
                };
                guard.kind = ExpressionKind::Script(numbered(CONDITION, &mut self.conditions, text));
            }
        }
    }

    fn action(&mut self, action: &mut Action) {
        let text = match &action.kind {
            ActionKind::Raise(_) => return,
            ActionKind::Script(text) => text.clone(),
            _ => action.to_string(),
        };
        action.kind = ActionKind::Script(numbered(ACTION, &mut self.actions, text));
    }
}

fn reads_states(expression: &Expression) -> bool {
    expression.find_map(&mut |part| matches!(part.kind, ExpressionKind::In(_)).then_some(())).is_some()
}

/// Whether a state is tested inside of anything other than `!`, `&&` and `||`: there it is part of
/// a value.
fn reads_conditions(condition: &Expression) -> bool {
    match &condition.kind {
        ExpressionKind::In(_) => false,
        ExpressionKind::Or(parts) | ExpressionKind::And(parts) => parts.iter().any(reads_conditions),
        ExpressionKind::Not(operand) => reads_conditions(operand),
        _ => reads_states(condition),
    }
}

/// Whether a condition is always true or false.
fn has_two_values(condition: &Expression) -> bool {
    match &condition.kind {
        ExpressionKind::Bool(_) | ExpressionKind::In(_) | ExpressionKind::Script(_) => true,
        ExpressionKind::Not(operand) => has_two_values(operand),
        ExpressionKind::Or(parts) | ExpressionKind::And(parts) => parts.iter().all(has_two_values),
        _ => false,
    }
}

/// The negation by De Morgan's laws, which also hold in Kleene's logic.
fn negated(condition: &Expression) -> ExpressionKind {
    let not = |part: &Expression| Expression {
        kind: ExpressionKind::Not(Box::new(part.clone())),
        position: part.position,
    };
    match &condition.kind {
        ExpressionKind::Or(parts) => ExpressionKind::And(parts.iter().map(not).collect()),
        ExpressionKind::And(parts) => ExpressionKind::Or(parts.iter().map(not).collect()),
        ExpressionKind::Not(operand) => operand.kind.clone(),
        _ => not(condition).kind,
    }
}

/// The script of a text, added if it is new.
fn numbered(prefix: &str, known: &mut Vec<String>, text: String) -> String {
    let number = known.iter().position(|it| *it == text).unwrap_or_else(|| {
        known.push(text);
        known.len() - 1
    });
    format!("{prefix}{number}")
}

fn events(chart: &Statechart) -> Vec<FlatEvent> {
    let mut events = Vec::new();
    let (mut others, mut waits) = (false, false);
    let mut note = |name: String| {
        let event = FlatEvent::Named(name);
        if !events.contains(&event) {
            events.push(event);
        }
    };
    for (_, transition) in chart.transitions() {
        match &transition.expression.trigger {
            Some(Trigger::OneOf(names)) => names.iter().for_each(|name| note(name.text())),
            Some(Trigger::Not(name)) => {
                note(name.text());
                others = true;
            }
            Some(Trigger::Any) => others = true,
            None => waits |= transition.expression.guard.is_some() && !transition.expression.is_never(),
        }
    }
    events.extend(others.then_some(FlatEvent::Other));
    events.extend(waits.then_some(FlatEvent::Nothing));
    events
}

/// The features of a chart that depend on more than events and conditions.
pub(crate) fn not_known_beforehand(chart: &Statechart) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for (id, node) in chart.nodes() {
        let what = [
            (node.activity.is_some(), "has an activity"),
            (node.duration.is_some(), "has a duration"),
            (!node.defer.is_empty(), "defers events"),
            (node.entry.iter().chain(&node.exit).any(starts_timer), "starts a timer"),
            (node.entry.iter().chain(&node.exit).any(writes_state), "writes whether a state is active"),
        ];
        found.extend(report_unsupported(&what, || format!("`{}`", chart.path(id))));
    }
    for (id, transition) in chart.transitions() {
        let expression = &transition.expression;
        let looks_at_timer =
            |part: &Expression| matches!(part.kind, ExpressionKind::TimeoutCheck(_)).then_some(());
        let guard =
            expression.guard.as_ref().and_then(|guard| guard.find_map(&mut |part| looks_at_timer(part)));
        let what = [
            (transition.weight.is_some(), "is selected at random"),
            (expression.actions.iter().any(starts_timer), "starts a timer"),
            (guard.is_some(), "reads a timer"),
            (expression.actions.iter().any(writes_state), "writes whether a state is active"),
            (
                expression.guard.as_ref().is_some_and(reads_conditions),
                "computes with the activity of a state",
            ),
        ];
        found.extend(report_unsupported(&what, || of_transition(chart, id)));
    }
    found
}

fn report_unsupported(what: &[(bool, &str)], of: impl Fn() -> String) -> Vec<Diagnostic> {
    let so = what.iter().filter(|(is_so, _)| *is_so);
    so.map(|(_, what)| {
        let message = format!("{} {what}: a flat chart has events and conditions only", of());
        Diagnostic::error("E0160", Span::default(), message)
            .with_hint("run it on a machine, or generate its crate with `monas generate`")
    })
    .collect()
}

fn of_transition(chart: &Statechart, id: TransitionId) -> String {
    let transition = chart.transition(id);
    format!("the transition from `{}` to `{}`", chart.path(transition.source), chart.path(transition.target))
}

fn starts_timer(action: &Action) -> bool {
    matches!(action.kind, ActionKind::StartTimeout { .. })
}

fn writes_state(action: &Action) -> bool {
    matches!(&action.kind, ActionKind::Assign { value, .. } if reads_states(value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use yase::expression::parse_transition;
    use yase::{Node, NodeKind, Transition};

    fn chart(text: &str) -> (Statechart, TransitionId) {
        let mut chart = Statechart::new("c");
        let state = chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, "s"));
        let (expression, wrong) = parse_transition(text);
        assert_eq!(wrong, []);
        let transition = chart.connect(Transition { expression, ..Transition::new(state, state) });
        (chart, transition)
    }

    fn words(guard: &str) -> (String, Vec<String>) {
        let (chart, transition) = chart(&format!("e [{guard}]"));
        assert_eq!(not_known_beforehand(&chart), []);
        let words = SymbolTable::of(&chart);
        let guard = words.chart.transition(transition).expression.guard.as_ref().map(ToString::to_string);
        (guard.unwrap_or_default(), words.conditions)
    }

    #[test]
    fn conditions_that_may_be_unknown_have_a_separate_negation() {
        let cases: [(&str, &str, &[&str]); 6] = [
            ("!Ball.found", r#"script("condition 0")"#, &["!Ball.found"]),
            (r#"!script("x")"#, r#"!script("condition 0")"#, &["x"]),
            ("!In(s)", "!In(s)", &[]),
            ("In(s) && !Ball.found", r#"In(s) && script("condition 0")"#, &["!Ball.found"]),
            ("!(In(s) && Ball.found)", r#"!In(s) || script("condition 0")"#, &["!Ball.found"]),
            ("!!(In(s) || Ball.found)", r#"In(s) || script("condition 0")"#, &["Ball.found"]),
        ];
        for (guard, becomes, conditions) in cases {
            let conditions = conditions.iter().map(|it| String::from(*it)).collect();
            assert_eq!(words(guard), (becomes.to_owned(), conditions), "{guard}");
        }
    }
    /// The host does not know the active states.
    #[test]
    fn states_that_are_part_of_a_value_are_refused() {
        for (text, why) in [
            ("e [In(s) == true]", "computes with the activity of a state"),
            ("e [!(In(s) == Ball.found)]", "computes with the activity of a state"),
            ("e [Ball.found && !(In(s) && f(In(s)))]", "computes with the activity of a state"),
            ("e / Ball.found = !In(s)", "writes whether a state is active"),
        ] {
            let (chart, _) = chart(text);
            let found = not_known_beforehand(&chart);
            assert_eq!(found.len(), 1, "{text}: {found:?}");
            assert!(found[0].message.contains(why), "{text}: {}", found[0].message);
            // the following must terminate as well
            SymbolTable::of(&chart);
        }
    }
}
