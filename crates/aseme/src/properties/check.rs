//! A file of properties held against a model.

use std::collections::BTreeSet;
use std::sync::Arc;

use yase::diagnostic::nearest;
use yase::expression::{Expression, ExpressionKind, Path};
use yase::{Diagnostic, Source};

use super::explore::{Answer, explored};
use super::names::{Bound, bind, guards};
use super::plan::Atom;
use super::syntax::Property;
use crate::check::abstraction::Abstraction;
use crate::check::{Finding, Settings, abstracted};

/// What was found of one property.
#[derive(Clone, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub struct Judgement {
    /// Its name.
    pub name: String,
    /// Whether it holds.
    pub outcome: Outcome,
    /// How many states of the chart were looked at.
    pub states: usize,
}

/// Whether a property holds of all runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Outcome {
    /// It does.
    Holds,
    /// There is a run that violates it.
    Violated,
    /// There are more states than were looked at, and none of those that were violates it.
    NotDecided,
}

/// Holds the properties in a file against a model. Gives what is wrong with the file, and what was found of each property that can be explored; those that do not
/// hold are findings too, with a run that shows it (E0870), as are those of which nothing is decided (E0871).
///
/// # Errors
/// What keeps the model from being explored.
pub fn check(
    model: &Arc<Source>,
    properties: &Arc<Source>,
    settings: &Settings,
) -> Result<(Vec<Judgement>, Vec<Finding>), Vec<Diagnostic>> {
    let abstraction = abstracted(model)?.with_events(&settings.events);
    let (list, found) = super::parse(&properties.text);
    let mut findings: Vec<Finding> = found.into_iter().map(Finding::from).collect();
    let mut judgements = Vec::new();
    for property in &list {
        match bound(property, &abstraction, settings) {
            Ok((bound, doubts)) => {
                findings.extend(doubts.into_iter().map(Finding::from));
                let (judgement, finding) = judged(property, &abstraction, &bound, settings.states);
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
    settings: &Settings,
) -> Result<(Bound, Vec<Diagnostic>), Vec<Diagnostic>> {
    let bound = bind(property, &abstraction.chart)?;
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
    bound: &Bound,
    limit: usize,
) -> (Judgement, Option<Finding>) {
    let name = &property.name;
    let (answer, states) = explored(abstraction, bound, limit);
    let judgement = |outcome| Judgement { name: name.clone(), outcome, states };
    let place = property.formula.span();
    match answer {
        Answer::Holds => (judgement(Outcome::Holds), None),
        Answer::Violated(trace, is_circle) => {
            let message = format!("the property `{name}` does not hold");
            let hint = match is_circle {
                true => "the trace shows a run that goes round for ever without what must come",
                false => "the trace shows a run that violates it",
            };
            let diagnostic = Diagnostic::error("E0870", place, message).with_hint(hint);
            (judgement(Outcome::Violated), Some(Finding { diagnostic, trace: Some(trace) }))
        }
        Answer::NotDecided => {
            let message =
                format!("the property `{name}` is not decided: after {states} states there are more");
            let hint = "nothing that was looked at violates it; look at more with `--states`, or say less in one property";
            let diagnostic = Diagnostic::error("E0871", place, message).with_hint(hint);
            (judgement(Outcome::NotDecided), Some(diagnostic.into()))
        }
    }
}

/// Fields that no guard of the chart reads: as likely misspelt as meant.
fn unread(bound: &Bound, abstraction: &Abstraction) -> Vec<Diagnostic> {
    let mut known: BTreeSet<String> = BTreeSet::new();
    for condition in abstraction.conditions.iter().flatten() {
        fields(condition, &mut |path| {
            known.insert(path.text());
        });
    }
    let mut found = Vec::new();
    for atom in bound.plan.atoms() {
        let Atom::Condition(condition) = atom else { continue };
        fields(condition, &mut |path| {
            let text = path.text();
            if !known.contains(&text) {
                let message = format!("no guard of the chart reads `{text}`");
                let wrong = Diagnostic::warning("E0848", path.place.0, message);
                found.push(match nearest(&text, known.iter().map(String::as_str)) {
                    Some(near) => wrong.with_hint(format!("did you mean `{near}`?")),
                    None => wrong.with_hint("with `--linked` the program says whether there is such a field"),
                });
            }
        });
    }
    found
}

/// The fields and messages that a condition reads.
fn fields<'a>(expression: &'a Expression, told: &mut impl FnMut(&'a Path)) {
    match &expression.kind {
        ExpressionKind::Variable(path) if path.segments.len() > 1 => told(path),
        _ => expression.parts().into_iter().for_each(|operand| fields(operand, told)),
    }
}
