//! Tests of the patrol: the program's output, and the effects of edits to its model.

use std::error::Error;
use std::process::Command;

use monas::{Agent, Blackboard, Registry, Statistics, Talws, Timestamp};
use yase::{Diagnostic, Source, Statechart};

const MODEL: &str = include_str!("../patrol.srm");

fn nothing(_: &mut Blackboard) {}

/// The chart of the model with one text replaced, and its diagnostics.
fn edited(from: &str, to: &str) -> (Statechart, Vec<Diagnostic>) {
    assert!(MODEL.contains(from), "the model has no `{from}`");
    aseme::statechart_of_role(&Source::new("patrol.srm", MODEL.replace(from, to)))
}

/// The statistics of a chart's activities after ten simulated seconds.
fn ten_seconds_of(chart: Statechart) -> Result<Statistics, Box<dyn Error>> {
    let names = ["Walk", "Left", "Right", "Rest"];
    let registry =
        names.into_iter().fold(Registry::empty(), |registry, name| registry.with(name, || nothing));
    let talws = Talws::new().registry(registry).agent(Agent::statechart("guard", chart));
    let mut simulation = talws.simulate(7)?;
    simulation.run_until(Timestamp::from_secs_f64(10.0))?;
    Ok(simulation.statistics())
}

#[test]
fn the_program_prints_what_runs() -> Result<(), Box<dyn Error>> {
    let output = Command::new(env!("CARGO_BIN_EXE_example-formula")).output()?;
    assert_eq!(String::from_utf8(output.stdout)?, include_str!("patrol.txt"));
    assert!(output.status.success());
    Ok(())
}

#[test]
fn a_branch_that_the_chart_forbids_is_never_taken() -> Result<(), Box<dyn Error>> {
    let (chart, findings) = edited("[left_again]", "[false]");
    assert_eq!(findings, []);
    let statistics = ten_seconds_of(chart)?;
    let calls = |name| statistics.calls(Talws::LOCAL, name);
    // The timer is never started, so it has expired, and the transition to the right is disabled as
    // well: the patrol has walked once and waits.
    assert_eq!((calls("Walk"), calls("Left"), calls("Right")), (1, 0, 0));
    Ok(())
}

#[test]
fn an_edit_of_the_formula_keeps_the_refinements() -> Result<(), Box<dyn Error>> {
    let (chart, findings) = edited("(Walk . look)~", "(Walk . look . Rest)~");
    assert_eq!(findings, []);
    let statistics = ten_seconds_of(chart)?;
    let calls = |name| statistics.calls(Talws::LOCAL, name);
    // 14 walks of 700 ms take 9.8 s; every third look is to the left.
    assert_eq!((calls("Left"), calls("Right"), calls("Rest")), (5, 9, 14));
    Ok(())
}

#[test]
fn a_refinement_that_no_longer_fits_is_named() {
    let (_, findings) = edited("look = Left | Right", "look = Right | Ahead");
    let [finding] = findings.as_slice() else { panic!("one finding: {findings:#?}") };
    assert!(finding.message.contains("Left"), "{finding}");
    assert_eq!(finding.position().map(|(line, _)| line), Some(10));
}
