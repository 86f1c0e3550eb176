//! `monas model mutate`: what changes of a chart its scenarios notice.

mod judge;
mod tell;

use aseme::mutation::{Mutant, mutants};
use monas::config;
use monas::scenario::Difference;
use yase::Diagnostic;

use super::scenario::{self, Scenario};
use crate::arguments::MutateArguments;
use crate::console::Console;
use crate::exit::Exit;
use crate::failure::Failure;
use judge::Course;

/// What became of a mutant.
enum Verdict {
    /// It cannot run: why.
    Refused(String),
    /// A scenario, by its place, shows that it does something else.
    Noticed(usize, Difference),
    /// No scenario does.
    Survived,
}

/// A mutant and what became of it.
struct Judged {
    mutant: Mutant,
    verdict: Verdict,
}

pub(crate) fn execute(arguments: &MutateArguments, console: &mut Console<'_>) -> Result<Exit, Failure> {
    let format = arguments.format.value;
    let invalid = |wrong: Vec<Diagnostic>| Failure::Invalid(format, wrong);
    let source = config::read_file(&arguments.model).map_err(|unread| invalid(vec![*unread]))?;
    let mutants = mutants(&source).map_err(invalid)?;
    let player = scenario::player(format)?;
    let chart = scenario::chart(&arguments.model, &player, format)?;
    let scenarios = about(arguments)?;
    let failed = |error| Failure::failed(format, error);
    let mut courses = Vec::new();
    for scenario in &scenarios {
        let steps = scenario.bind(&chart, &player).map_err(invalid)?;
        courses.push(Course { scenario, steps });
    }
    let wrong = judge::on_the_model(&courses, &chart, &player).map_err(failed)?;
    if !wrong.is_empty() {
        return Err(invalid(wrong));
    }
    let verdicts = judge::all(&mutants, &courses, &player).map_err(failed)?;
    let judged =
        mutants.into_iter().zip(verdicts).map(|(mutant, verdict)| Judged { mutant, verdict }).collect();
    let report = tell::Report { source, judged, scenarios: &scenarios };
    report.write(format, console)?;
    Ok(if report.is_least(arguments.least) { Exit::Success } else { Exit::Diverged })
}

/// The scenarios that are about the model.
fn about(arguments: &MutateArguments) -> Result<Vec<Scenario>, Failure> {
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
        return Err(Failure::Invalid(format, wrong));
    }
    if scenarios.is_empty() {
        let (folder, model) = (arguments.scenarios.display(), arguments.model.display());
        return Err(Failure::Failed(format, format!("no scenario in {folder} is about {model}")));
    }
    Ok(scenarios)
}
