//! Charts for drawings: with expressions that are still unfinished.

use std::sync::Arc;

use aseme::srm::SrmFile;
use yase::expression::{
    Name, Path, TextPosition, TransitionExpression, Trigger, parse_actions_at, parse_transition,
};
use yase::{Diagnostic, Severity, Source, Span, Statechart};

use crate::convert::{self, Model};
use crate::diagram::apply_diagram;
use crate::iac::Iac;

/// The statechart of a model as it can be drawn, and all findings about its text.
///
/// An expression that cannot be read is on its transition as it is written, in backquotes; the
/// findings about it are warnings. The chart cannot be run. None if the text has other errors.
///
/// The nodes of a model in XMI are where `diagram`, a diagram of its editor, has them.
pub fn drawable_chart_of(
    source: &Arc<Source>,
    diagram: Option<&Arc<Source>>,
) -> (Option<Statechart>, Vec<Diagnostic>) {
    let (found, read) = convert::read(source);
    let (chart, made) = match found {
        Some((Model::Chart(mut chart), _)) => {
            if let Some(diagram) = diagram
                && let Err(found) = apply_diagram(&mut chart, &source.text, &diagram.text)
            {
                return (None, vec![found.in_source(diagram)]);
            }
            of_chart(chart)
        }
        Some((Model::Role(role), _)) if !aseme::have_formula_errors(&read) => of_role(&role, &read),
        _ => {
            let (chart, found) = crate::statechart_of(source);
            return (Some(chart).filter(|_| !found.iter().any(Diagnostic::is_error)), found);
        }
    };
    let made = made.into_iter().map(|finding| finding.in_source(source));
    let mut found: Vec<Diagnostic> = read.into_iter().chain(made).map(tolerated).collect();
    found.sort_by_key(|finding| finding.span);
    (Some(chart).filter(|_| !found.iter().any(Diagnostic::is_error)), found)
}

/// Whether a finding is about an expression.
fn is_about_expression(finding: &Diagnostic) -> bool {
    ("E0100".."E0200").contains(&finding.code)
}

/// A finding as a warning if it is about an expression.
fn tolerated(finding: Diagnostic) -> Diagnostic {
    match finding.is_error() && is_about_expression(&finding) {
        true => Diagnostic { severity: Severity::Warning, ..finding },
        false => finding,
    }
}

fn of_chart(mut model: Iac) -> (Statechart, Vec<Diagnostic>) {
    let (_, found) = model.to_statechart();
    let unfinished: Vec<usize> = (0..model.transitions.len())
        .filter(|&index| parse_transition(&model.transitions[index].te).1.iter().any(Diagnostic::is_error))
        .collect();
    let written: Vec<String> =
        unfinished.iter().map(|&index| std::mem::take(&mut model.transitions[index].te)).collect();
    for node in &mut model.nodes {
        for actions in [&mut node.refinement.entry, &mut node.refinement.exit] {
            if parse_actions_at(actions, 0).1.iter().any(Diagnostic::is_error) {
                actions.clear();
            }
        }
    }
    let (mut chart, _) = model.to_statechart();
    // transitions without ends are not part of the chart
    let exists = |node: usize| node < model.nodes.len();
    let drawn: Vec<usize> = (0..model.transitions.len())
        .filter(|&index| exists(model.transitions[index].source) && exists(model.transitions[index].target))
        .collect();
    for (index, text) in unfinished.into_iter().zip(written) {
        if let Some(position) = drawn.iter().position(|&drawn| drawn == index) {
            chart.transition_mut(yase::TransitionId(position as u32)).expression = quoted(&text);
        }
    }
    (chart, found)
}

fn of_role(role: &SrmFile, read: &[Diagnostic]) -> (Statechart, Vec<Diagnostic>) {
    let mut srm = role.srm().clone();
    let unfinished: Vec<Span> = read
        .iter()
        .filter(|finding| finding.is_error() && is_about_expression(finding))
        .map(|finding| finding.span)
        .collect();
    for entry in &mut srm.transitions {
        let is_inside = |span: &Span| entry.span.start <= span.start && span.end <= entry.span.end;
        if unfinished.iter().any(is_inside) {
            let head = entry.text.find("->").unwrap_or_default();
            let text = entry.text[head..].split_once(':').map_or("", |(_, expression)| expression);
            entry.expression = quoted(text);
        }
    }
    aseme::role_to_statechart(&srm)
}

/// An expression that only shows a text.
fn quoted(text: &str) -> TransitionExpression {
    let text: Vec<&str> = text.split_whitespace().collect();
    let position = TextPosition::default();
    let name = Name { text: text.join(" ").replace('`', "'"), position };
    let trigger = Some(Trigger::OneOf(vec![Path { segments: vec![name], position }]));
    TransitionExpression { trigger, ..TransitionExpression::default() }
}
