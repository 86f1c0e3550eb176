//! Checks of a team's own properties on all behaviours of its charts.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme_verify::properties::{self, PropertyOutcome, PropertyResult};
use aseme_verify::{CheckSettings, check::CheckReport};
use monas::config;
use monas_terminal::{CommandFailure, CommandOutput, counted};
use serde_json::json;
use yase::Source;

/// The result of one property of one model.
pub(crate) struct CheckedProperty {
    model: PathBuf,
    judgement: PropertyResult,
}

/// Checks the properties of files on a model.
pub(crate) fn checked(
    model: &Arc<Source>,
    path: &Path,
    files: &[PathBuf],
    settings: &CheckSettings,
    judged: &mut Vec<CheckedProperty>,
) -> CheckReport {
    let mut report = CheckReport::default();
    let mut has_unread = false;
    for file in files {
        match config::read_file(file) {
            Ok(source) => has_unread |= !add(model, path, &source, settings, &mut report, judged),
            Err(unread) => {
                report.findings.push((*unread).into());
                has_unread = true;
            }
        }
    }
    if !has_unread {
        report.kind = Some("its properties were checked".to_owned());
    }
    report
}

/// Adds the findings of one file. Returns false if the file or the model could not be read
/// completely.
fn add(
    model: &Arc<Source>,
    path: &Path,
    source: &Arc<Source>,
    settings: &CheckSettings,
    report: &mut CheckReport,
    judged: &mut Vec<CheckedProperty>,
) -> bool {
    match properties::check(model, source, settings) {
        Ok((judgements, findings)) => {
            let is_verdict = |code: &str| matches!(code, "E0870" | "E0871" | "E0872");
            let is_understood =
                findings.iter().all(|it| !it.diagnostic.is_error() || is_verdict(it.diagnostic.code));
            report.findings.extend(findings);
            let model = || path.to_path_buf();
            judged.extend(
                judgements.into_iter().map(|judgement| CheckedProperty { model: model(), judgement }),
            );
            is_understood
        }
        Err(wrong) => {
            report.findings.extend(wrong.into_iter().map(Into::into));
            false
        }
    }
}

fn word(outcome: PropertyOutcome) -> &'static str {
    match outcome {
        PropertyOutcome::Holds => "holds",
        PropertyOutcome::Violated => "does not hold",
        PropertyOutcome::NotConfirmed => "is not decided: a run against it is not confirmed",
        _ => "is not decided",
    }
}

/// One line per property.
pub(crate) fn text(
    judged: &[CheckedProperty],
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    for CheckedProperty { model, judgement } in judged {
        let (model, outcome) = (config::shown_name(model), word(judgement.outcome));
        let states = counted(judgement.states as u64, "state");
        writeln!(console.out, "{model}: `{}` {outcome}; {states} explored", judgement.name)?;
    }
    Ok(())
}

/// One object per property.
pub(crate) fn json(
    judged: &[CheckedProperty],
    console: &mut CommandOutput<'_>,
) -> Result<(), CommandFailure> {
    for CheckedProperty { model, judgement } in judged {
        let PropertyResult { name, outcome, states, .. } = judgement;
        let (model, outcome) = (config::shown_name(model), word(*outcome));
        let object = json!({"model": model, "property": name, "outcome": outcome, "states": states});
        writeln!(console.out, "{object}")?;
    }
    Ok(())
}
