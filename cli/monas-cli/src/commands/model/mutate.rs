//! `monas model mutate`: mutation testing of scenarios.

mod evaluate;
mod report;

use std::path::PathBuf;

use aseme_verify::mutation::{Mutant, mutants};
use clap::{Args, ValueHint};
use monas::config;
use monas::scenario::ScenarioDifference;
use yase::Diagnostic;

use super::scenario;
use super::scenario::Scenario;
use evaluate::ScenarioTrace;
use monas_terminal::{CommandFailure, CommandOutput, Exit, FormatArgument};

/// Arguments of `monas model mutate`.
#[derive(Args, Debug)]
pub(crate) struct MutateArguments {
    /// The model file.
    #[arg(value_hint = ValueHint::FilePath)]
    pub(crate) model: PathBuf,
    /// The folder of scenarios, searched recursively; scenarios of other models are skipped.
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) scenarios: PathBuf,
    /// The smallest percentage of mutants that must be detected.
    #[arg(long, value_name = "PERCENT", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=100))]
    pub(crate) least: u8,
    #[command(flatten)]
    pub(crate) format: FormatArgument,
}

/// The outcome of a mutant.
enum MutantOutcome {
    /// It cannot run, for this reason.
    Refused(String),
    /// The scenario with this index detects it by this difference.
    Killed(usize, ScenarioDifference),
    /// No scenario detects it.
    Survived,
}

/// A mutant with its outcome.
struct EvaluatedMutant {
    mutant: Mutant,
    verdict: MutantOutcome,
}

pub(crate) fn execute(
    arguments: &MutateArguments,
    console: &mut CommandOutput<'_>,
) -> Result<Exit, CommandFailure> {
    let format = arguments.format.value;
    let invalid = |wrong: Vec<Diagnostic>| CommandFailure::Invalid(format, wrong);
    let source = config::read_file(&arguments.model).map_err(|unread| invalid(vec![*unread]))?;
    let mutants = mutants(&source).map_err(invalid)?;
    let runner = scenario::runner(format)?;
    let chart = scenario::chart(&arguments.model, &runner, format)?;
    let scenarios = scenarios_of_model(arguments)?;
    let failed = |error| CommandFailure::failed(format, error);
    let mut bound = Vec::new();
    for scenario in &scenarios {
        let steps = scenario.bind(&chart, &runner).map_err(invalid)?;
        bound.push(ScenarioTrace { scenario, steps });
    }
    let wrong = evaluate::failures_on_model(&bound, &chart, &runner).map_err(failed)?;
    if !wrong.is_empty() {
        return Err(invalid(wrong));
    }
    let outcomes = evaluate::evaluate_all(&mutants, &bound, &runner).map_err(failed)?;
    let judged = mutants
        .into_iter()
        .zip(outcomes)
        .map(|(mutant, verdict)| EvaluatedMutant { mutant, verdict })
        .collect();
    let report = report::MutationReport { source, judged, scenarios: &scenarios };
    report.write(format, console)?;
    Ok(if report.is_least(arguments.least) { Exit::Success } else { Exit::Diverged })
}

/// The scenarios of the model.
fn scenarios_of_model(arguments: &MutateArguments) -> Result<Vec<Scenario>, CommandFailure> {
    let format = arguments.format.value;
    let (mut scenarios, mut wrong) = (Vec::new(), Vec::new());
    for file in scenario::files(&arguments.scenarios, format)? {
        match scenario::load(&file) {
            Ok(scenario) if scenario.is_about(&arguments.model) => scenarios.push(scenario),
            Ok(_) => {}
            Err(found) => wrong.extend(found),
        }
    }
    if !wrong.is_empty() {
        return Err(CommandFailure::Invalid(format, wrong));
    }
    if scenarios.is_empty() {
        let (folder, model) = (arguments.scenarios.display(), arguments.model.display());
        return Err(CommandFailure::Failed(format, format!("no scenario in {folder} belongs to {model}")));
    }
    Ok(scenarios)
}
