//! Properties of a team's own, held against all that its charts can do.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aseme::check::{Report, Settings};
use aseme::properties::{self, Judgement, Outcome};
use monas::config;
use serde_json::json;
use yase::Source;

use crate::console::Console;
use crate::failure::Failure;

/// What was found of one property of one model.
pub(super) struct Judged {
    model: PathBuf,
    judgement: Judgement,
}

/// Holds the properties of files against a model.
pub(super) fn checked(
    path: &Path,
    files: &[PathBuf],
    settings: &Settings,
    judged: &mut Vec<Judged>,
) -> Report {
    let model = match config::read_file(path) {
        Ok(model) => model,
        Err(unread) => return Report::of_unreadable(*unread),
    };
    let mut report = Report::default();
    let mut has_unread = false;
    for file in files {
        match config::read_file(file) {
            Ok(source) => has_unread |= !add(&model, path, &source, settings, &mut report, judged),
            Err(unread) => {
                report.findings.push((*unread).into());
                has_unread = true;
            }
        }
    }
    if !has_unread {
        report.what = Some("its properties were looked at".to_owned());
    }
    report
}

/// Adds what is to be said of one file. False if not all of it, or not the model, could be understood.
fn add(
    model: &Arc<Source>,
    path: &Path,
    source: &Arc<Source>,
    settings: &Settings,
    report: &mut Report,
    judged: &mut Vec<Judged>,
) -> bool {
    match properties::check(model, source, settings) {
        Ok((judgements, findings)) => {
            let is_verdict = |code: &str| matches!(code, "E0870" | "E0871");
            let is_understood =
                findings.iter().all(|it| !it.diagnostic.is_error() || is_verdict(it.diagnostic.code));
            report.findings.extend(findings);
            let model = || path.to_path_buf();
            judged.extend(judgements.into_iter().map(|judgement| Judged { model: model(), judgement }));
            is_understood
        }
        Err(wrong) => {
            report.findings.extend(wrong.into_iter().map(Into::into));
            false
        }
    }
}

fn word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Holds => "holds",
        Outcome::Violated => "does not hold",
        _ => "is not decided",
    }
}

/// A line for each property.
pub(super) fn text(judged: &[Judged], console: &mut Console<'_>) -> Result<(), Failure> {
    for Judged { model, judgement } in judged {
        let (model, outcome, states) = (model.display(), word(judgement.outcome), judgement.states);
        writeln!(console.out, "{model}: `{}` {outcome}; {states} states explored", judgement.name)?;
    }
    Ok(())
}

/// An object for each property.
pub(super) fn json(judged: &[Judged], console: &mut Console<'_>) -> Result<(), Failure> {
    for Judged { model, judgement } in judged {
        let Judgement { name, outcome, states, .. } = judgement;
        let (model, outcome) = (model.display().to_string(), word(*outcome));
        let object = json!({"model": model, "property": name, "outcome": outcome, "states": states});
        writeln!(console.out, "{object}")?;
    }
    Ok(())
}
