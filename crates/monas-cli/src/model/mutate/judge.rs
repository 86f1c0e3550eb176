//! Scenarios played on the model and on each of its mutants.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use aseme::mutation::Mutant;
use aseme::scenario::Step;
use monas::Error;
use monas::scenario::Player;
use yase::{Chart, Diagnostic};

use super::Verdict;
use crate::model::scenario::Scenario;

/// A scenario, and its steps as they are played.
pub(super) struct Course<'a> {
    pub(super) scenario: &'a Scenario,
    pub(super) steps: Vec<Step>,
}

/// Where the model itself does not do what its scenarios expect.
pub(super) fn on_the_model(
    courses: &[Course<'_>],
    chart: &Arc<Chart>,
    player: &Player,
) -> Result<Vec<Diagnostic>, Error> {
    let mut wrong = Vec::new();
    for course in courses {
        for difference in player.play(chart, &course.steps, |_| {})? {
            let passage = &difference.passage;
            let found = Diagnostic::error("E0898", passage.span, difference.to_string());
            let hint = format!("{} fails on the model as it is", course.scenario.file.display());
            wrong.push(found.with_hint(hint).in_source(&passage.source));
        }
    }
    // several scenarios may come after the one that fails
    wrong.dedup_by(|one, other| (&one.span, &one.source) == (&other.span, &other.source));
    Ok(wrong)
}

/// What becomes of each mutant, in their order, found out on all processors.
pub(super) fn all(
    mutants: &[Mutant],
    courses: &[Course<'_>],
    player: &Player,
) -> Result<Vec<Verdict>, Error> {
    let next = AtomicUsize::new(0);
    let work = || -> Result<Vec<(usize, Verdict)>, Error> {
        let mut judged = Vec::new();
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(mutant) = mutants.get(place) else { return Ok(judged) };
            judged.push((place, one(mutant, courses, player)?));
        }
    };
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let mut judged = Vec::new();
    thread::scope(|scope| -> Result<(), Error> {
        let hands: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        for hand in hands {
            match hand.join() {
                Ok(more) => judged.extend(more?),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        Ok(())
    })?;
    judged.sort_by_key(|(place, _)| *place);
    Ok(judged.into_iter().map(|(_, verdict)| verdict).collect())
}

fn one(mutant: &Mutant, courses: &[Course<'_>], player: &Player) -> Result<Verdict, Error> {
    let chart = match player.compile(&mutant.chart) {
        Ok(chart) => chart,
        Err(wrong) => {
            let why = wrong.first().map_or_else(String::new, |wrong| wrong.message.clone());
            return Ok(Verdict::Refused(why));
        }
    };
    for (place, course) in courses.iter().enumerate() {
        if let Some(difference) = player.first_difference(&chart, &course.steps)? {
            return Ok(Verdict::Noticed(place, difference));
        }
    }
    Ok(Verdict::Survived)
}
