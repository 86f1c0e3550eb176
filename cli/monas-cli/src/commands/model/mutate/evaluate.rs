//! Plays scenarios on the model and on each of its mutants.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use aseme_verify::mutation::Mutant;
use aseme_verify::scenario::ScenarioStep;
use monas::Error;
use monas::scenario::ScenarioRunner;
use yase::{CompiledChart, Diagnostic};

use super::MutantOutcome;
use crate::commands::model::scenario::Scenario;

/// A scenario with its bound steps.
pub(crate) struct ScenarioTrace<'a> {
    pub(crate) scenario: &'a Scenario,
    pub(crate) steps: Vec<ScenarioStep>,
}

/// The expectations that fail on the model itself.
pub(crate) fn failures_on_model(
    scenarios: &[ScenarioTrace<'_>],
    chart: &Arc<CompiledChart>,
    runner: &ScenarioRunner,
) -> Result<Vec<Diagnostic>, Error> {
    let mut wrong = Vec::new();
    for scenario in scenarios {
        for difference in runner.play(chart, &scenario.steps, |_| {})? {
            let passage = &difference.passage;
            let found = Diagnostic::error("E0898", passage.span, difference.to_string());
            let hint = format!("{} fails on the model as it is", scenario.scenario.file.display());
            wrong.push(found.with_hint(hint).in_source(&passage.source));
        }
    }
    // Several scenarios may continue the one that fails.
    wrong.dedup_by(|one, other| (&one.span, &one.source) == (&other.span, &other.source));
    Ok(wrong)
}

/// The outcome of each mutant, in their order, computed on all processors.
pub(crate) fn evaluate_all(
    mutants: &[Mutant],
    scenarios: &[ScenarioTrace<'_>],
    runner: &ScenarioRunner,
) -> Result<Vec<MutantOutcome>, Error> {
    let next = AtomicUsize::new(0);
    let work = || -> Result<Vec<(usize, MutantOutcome)>, Error> {
        let mut outcomes = Vec::new();
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(mutant) = mutants.get(index) else { return Ok(outcomes) };
            outcomes.push((index, evaluate_one(mutant, scenarios, runner)?));
        }
    };
    let count = thread::available_parallelism().map_or(1, usize::from);
    let mut outcomes = Vec::new();
    thread::scope(|scope| -> Result<(), Error> {
        let workers: Vec<_> = (0..count).map(|_| scope.spawn(work)).collect();
        for worker in workers {
            match worker.join() {
                Ok(more) => outcomes.extend(more?),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        Ok(())
    })?;
    outcomes.sort_by_key(|(position, _)| *position);
    Ok(outcomes.into_iter().map(|(_, verdict)| verdict).collect())
}

fn evaluate_one(
    mutant: &Mutant,
    scenarios: &[ScenarioTrace<'_>],
    runner: &ScenarioRunner,
) -> Result<MutantOutcome, Error> {
    let chart = match runner.compile(&mutant.chart) {
        Ok(chart) => chart,
        Err(wrong) => {
            let why = wrong.first().map_or_else(String::new, |wrong| wrong.message.clone());
            return Ok(MutantOutcome::Refused(why));
        }
    };
    for (index, scenario) in scenarios.iter().enumerate() {
        if let Some(difference) = runner.first_difference(&chart, &scenario.steps)? {
            return Ok(MutantOutcome::Killed(index, difference));
        }
    }
    Ok(MutantOutcome::Survived)
}
