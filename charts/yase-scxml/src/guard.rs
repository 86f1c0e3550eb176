//! Conditions that a chart can evaluate without a session: those made of `In()`.

use super::language::{ActiveQuery, ScriptExpression as Script};
use super::lexical::quoted;
use yase::diagnostic::Span;
use yase::expression::{ActionKind, Expression, ExpressionKind, Name, Path, TextPosition};
use yase::statechart::Statechart;

/// The condition as an expression of the chart, if it consists of `In()` and all states can be
/// found by their names.
pub(crate) fn native(
    script: &Script,
    is_found: &dyn Fn(&str) -> bool,
    position: TextPosition,
) -> Option<Expression> {
    let all = |operands: Vec<&Script>| {
        operands.into_iter().map(|operand| native(operand, is_found, position)).collect::<Option<Vec<_>>>()
    };
    let kind = match script.active_query()? {
        ActiveQuery::Known(value) => ExpressionKind::Bool(value),
        ActiveQuery::In(state) => {
            if !is_found(state) {
                return None;
            }
            ExpressionKind::In(Name { text: state.to_owned(), position })
        }
        ActiveQuery::Not(operand) => ExpressionKind::Not(Box::new(native(operand, is_found, position)?)),
        ActiveQuery::All(operands) => ExpressionKind::And(all(operands)?),
        ActiveQuery::Any(operands) => ExpressionKind::Or(all(operands)?),
    };
    Some(Expression { kind, position })
}

/// The condition of a chart in the language of the document, if it can be expressed there.
pub(crate) fn condition_text(chart: &Statechart, guard: &Expression) -> Option<String> {
    let joined = |operands: &[Expression], separator: &str| {
        let operands = operands.iter().map(|operand| {
            let text = condition_text(chart, operand)?;
            let nested = matches!(operand.kind, ExpressionKind::And(_) | ExpressionKind::Or(_));
            Some(if nested { format!("({text})") } else { text })
        });
        Some(operands.collect::<Option<Vec<_>>>()?.join(separator))
    };
    match &guard.kind {
        ExpressionKind::Script(text) => Some(text.clone()),
        ExpressionKind::Bool(value) => Some(value.to_string()),
        ExpressionKind::In(state) => {
            let name = &chart.node(chart.find(&state.text)?).name;
            // Regions without a name have no id in SCXML.
            (!name.is_empty()).then(|| format!("In({})", quoted(name)))
        }
        ExpressionKind::Not(operand) => {
            let text = condition_text(chart, operand)?;
            let nested = matches!(operand.kind, ExpressionKind::And(_) | ExpressionKind::Or(_));
            Some(if nested { format!("!({text})") } else { format!("!{text}") })
        }
        ExpressionKind::And(operands) => joined(operands, " && "),
        ExpressionKind::Or(operands) => joined(operands, " || "),
        _ => None,
    }
}

/// The name of an event as a path; a name that could denote a message becomes one segment.
pub(crate) fn event_path(name: &str, span: Span) -> Path {
    const MESSAGES: [&str; 4] = ["Message", "Signal", "State", "Data"];
    let position = TextPosition(span);
    let segment = |text: &str| Name { text: text.to_owned(), position };
    let like_a_message = name.split('.').any(|token| MESSAGES.contains(&token));
    let segments = if like_a_message { vec![segment(name)] } else { name.split('.').map(segment).collect() };
    Path { segments, position }
}

/// Whether a condition or content of a chart is a script.
pub(crate) fn uses_scripts(chart: &Statechart) -> bool {
    let script = |action: &yase::expression::Action| matches!(action.kind, ActionKind::Script(_));
    let in_states = chart.nodes().any(|(_, node)| node.entry.iter().chain(&node.exit).any(script));
    in_states
        || chart.transitions().any(|(_, transition)| {
            let guard = transition.expression.guard.as_ref();
            transition.expression.actions.iter().any(script) || guard.is_some_and(holds_script)
        })
}

fn holds_script(guard: &Expression) -> bool {
    match &guard.kind {
        ExpressionKind::Script(_) => true,
        ExpressionKind::Not(operand) => holds_script(operand),
        ExpressionKind::And(operands) | ExpressionKind::Or(operands) => operands.iter().any(holds_script),
        _ => false,
    }
}
