//! At least one test for each rule of the machine, named after it: a chart, its inputs, and every
//! line of its trace.

mod arrivals;
mod borders;
mod choosers;
mod completion;
mod connectors;
mod data;
mod firing;
mod guard_values;
mod histories;
mod history;
mod joins;
mod pool;
mod profiles;
mod refusals;
mod running;
mod scripts;
mod selection;
mod structure;
mod terminate;
mod timers;
mod trace;
mod whole_steps;
mod wiring;

use yase::Semantics;

/// `yase` with a change.
fn with(change: impl FnOnce(&mut Semantics)) -> Semantics {
    let mut semantics = Semantics::yase();
    change(&mut semantics);
    semantics
}

/// Plays a script on a chart and compares every line of the log.
#[track_caller]
fn check(chart: &str, script: &str, expected: &str) {
    check_with(Semantics::yase(), chart, script, expected);
}

#[track_caller]
fn check_with(semantics: Semantics, chart: &str, script: &str, expected: &str) {
    let found = yase_reference::script::play_with(&yase_reference::chart(chart), script, semantics);
    compare(&found, expected);
}

#[track_caller]
fn compare(found: &[String], expected: &str) {
    let expected: Vec<&str> = expected.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let found: Vec<&str> = found.iter().map(|line| line.trim()).collect();
    assert!(found == expected, "found\n{}\n\nexpected\n{}\n", found.join("\n"), expected.join("\n"));
}

/// The diagnostics that a chart gets, one a line.
fn refusal(chart: &str) -> String {
    match yase_reference::chart(chart).compile(&yase_reference::test_host::vocabulary()) {
        Ok(_) => "none".to_owned(),
        Err(found) => found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"),
    }
}
