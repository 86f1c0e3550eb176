//! Checks a file of properties against a model.

use std::collections::BTreeSet;
use std::sync::Arc;

use yase::diagnostic::nearest;
use yase::expression::{Expression, ExpressionKind, Path};
use yase::{Diagnostic, Source, TypeEnvironment};

use super::compiled_property::AtomicProposition;
use super::explore::{ExplorationVerdict, explored};
use super::names::{BoundProperty, bind, guards};
use super::syntax::Property;
use crate::abstraction::Abstraction;
use crate::abstraction::abstracted;
use crate::check_settings::CheckSettings;
use crate::finding::Finding;

/// The result for one property.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct PropertyResult {
    /// Its name.
    pub name: String,
    /// The outcome.
    pub outcome: PropertyOutcome,
    /// The number of explored states of the chart.
    pub states: usize,
}

/// Whether a property holds for all runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum PropertyOutcome {
    /// It holds.
    Holds,
    /// There is a run that violates it: the machine has executed it, with values for all that it
    /// reads.
    Violated,
    /// The exploration has found a violating run that the machine does not confirm.
    NotConfirmed,
    /// The limit of states was reached, and no explored state violates it.
    NotDecided,
}

/// Checks the properties in a file against a model. Returns the result of each property that can be
/// explored, and the findings: errors of the file, properties that do not hold, each with a
/// violating run that the machine has executed (E0870), and undecided properties: with more states
/// than the limit (E0871), or with a violating run of the exploration only (E0872).
///
/// # Errors
/// The errors that prevent exploring the model.
pub fn check(
    model: &Arc<Source>,
    properties: &Arc<Source>,
    settings: &CheckSettings,
) -> Result<(Vec<PropertyResult>, Vec<Finding>), Vec<Diagnostic>> {
    let abstraction = abstracted(model)?.with_events(&settings.events);
    let (list, found) = super::parse(&properties.text);
    let mut findings: Vec<Finding> = found.into_iter().map(Finding::from).collect();
    let mut judgements = Vec::new();
    for property in &list {
        match bound(property, &abstraction, settings) {
            Ok((bound, doubts)) => {
                findings.extend(doubts.into_iter().map(Finding::from));
                let (judgement, finding) = judged(property, &abstraction, &bound, settings);
                judgements.push(judgement);
                findings.extend(finding);
            }
            Err(wrong) => findings.extend(wrong.into_iter().map(Finding::from)),
        }
    }
    for finding in &mut findings {
        finding.diagnostic = finding.diagnostic.clone().in_source(properties);
    }
    findings.sort_by_key(|finding| finding.diagnostic.span);
    Ok((judgements, findings))
}

fn bound(
    property: &Property,
    abstraction: &Abstraction,
    settings: &CheckSettings,
) -> Result<(BoundProperty, Vec<Diagnostic>), Vec<Diagnostic>> {
    let bound = bind(property, &abstraction.chart, &TypeEnvironment::default())?;
    let doubts = match &settings.world {
        Some(world) => {
            guards(&bound.plan, &abstraction.chart, &world.vocabulary)?;
            Vec::new()
        }
        None => unread(&bound, abstraction),
    };
    Ok((bound, doubts))
}

fn judged(
    property: &Property,
    abstraction: &Abstraction,
    bound: &BoundProperty,
    settings: &CheckSettings,
) -> (PropertyResult, Option<Finding>) {
    let name = &property.name;
    let (answer, states) = explored(abstraction, bound, settings);
    let judgement = |outcome| PropertyResult { name: name.clone(), outcome, states };
    let span = property.formula.span();
    match answer {
        ExplorationVerdict::Holds => (judgement(PropertyOutcome::Holds), None),
        ExplorationVerdict::Violated(trace, is_circle) => {
            let message = format!("the property `{name}` does not hold");
            let hint = match is_circle {
                true => "the trace shows a run that repeats forever without the required step",
                false => "the trace shows a run that violates it",
            };
            let diagnostic = Diagnostic::error("E0870", span, message).with_hint(hint);
            (judgement(PropertyOutcome::Violated), Some(Finding { diagnostic, trace: Some(trace) }))
        }
        ExplorationVerdict::NotConfirmed(trace, why) => {
            let message =
                format!("the property `{name}` is not decided: a run against it is not confirmed: {why}");
            let hint = "the trace shows the run that the exploration has found";
            let diagnostic = Diagnostic::error("E0872", span, message).with_hint(hint);
            (judgement(PropertyOutcome::NotConfirmed), Some(Finding { diagnostic, trace: Some(trace) }))
        }
        ExplorationVerdict::NotDecided => {
            let message = format!("the property `{name}` is undecided after {states} states");
            let hint =
                "no explored state violates it; raise the limit with `--states`, or split the property";
            let diagnostic = Diagnostic::error("E0871", span, message).with_hint(hint);
            (judgement(PropertyOutcome::NotDecided), Some(diagnostic.into()))
        }
    }
}

/// Reports fields that no guard of the chart reads, since they may be misspelt.
fn unread(bound: &BoundProperty, abstraction: &Abstraction) -> Vec<Diagnostic> {
    let mut known: BTreeSet<String> = BTreeSet::new();
    for condition in abstraction.conditions.iter().flatten() {
        fields(condition, &mut |path| {
            known.insert(path.text());
        });
    }
    let mut found = Vec::new();
    for atom in bound.plan.atoms() {
        let AtomicProposition::Condition(condition) = atom else { continue };
        fields(condition, &mut |path| {
            let text = path.text();
            if !known.contains(&text) {
                let message = format!("no guard of the chart reads `{text}`");
                let wrong = Diagnostic::warning("E0848", path.position.0, message);
                found.push(match nearest(&text, known.iter().map(String::as_str)) {
                    Some(near) => wrong.with_hint(format!("did you mean `{near}`?")),
                    None => wrong.with_hint("name a field that a guard reads, or leave out `--unlinked`: the program knows all fields"),
                });
            }
        });
    }
    found
}

/// Visits the fields and messages that a condition reads.
fn fields<'a>(expression: &'a Expression, visit: &mut impl FnMut(&'a Path)) {
    match &expression.kind {
        ExpressionKind::Variable(path) if path.segments.len() > 1 => visit(path),
        _ => expression.parts().into_iter().for_each(|operand| fields(operand, visit)),
    }
}
