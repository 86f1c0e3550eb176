//! Tests that only the chart decides: forbidden transitions do not happen, and allowed ones do.

#![allow(clippy::unwrap_used)] // tests may panic

mod attack;
mod monitors;
mod safety;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

use monas::ChartCoverage;
use monas_match::{MatchOptions, MatchSource, MatchSummary};
use monas_tests::{MATCH, root};

/// A copy of the project's configuration and models in its own folder, with one text replaced.
fn changed(folder: &Path, file: &str, from: &str, to: &str) -> std::path::PathBuf {
    for part in ["models", "config", "config/fields", "config/roles"] {
        fs::create_dir_all(folder.join(part)).unwrap();
        for entry in fs::read_dir(root().join(part)).unwrap().flatten() {
            if entry.path().is_file() {
                fs::copy(entry.path(), folder.join(part).join(entry.file_name())).unwrap();
            }
        }
    }
    let path = folder.join(file);
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{file} has no `{from}`");
    fs::write(&path, text.replace(from, to)).unwrap();
    folder.join(MATCH.file)
}

fn played(path: &Path, seed: u64, seconds: u64) -> (MatchSummary, monas::Statistics) {
    let plan = MatchSource::load(path, &monas::Registry::linked()).unwrap();
    let mut running = plan.start(MatchOptions { seed, record: None }).unwrap();
    running.advance(Duration::from_secs(seconds)).unwrap();
    let statistics = running.simulation().unwrap().statistics();
    (running.finish().unwrap(), statistics)
}

#[test]
fn no_robot_kicks_when_the_chart_never_takes_that_branch() {
    let folder = tempfile::tempdir().unwrap();
    let branch = "CONDITION -> kickBall : [Ball.distance <= near && Ball.speed < still\n        \
                  && abs(Ball.x - kick_x) <= tolerance && abs(abs(Ball.y) - kick_y) <= tolerance]";
    let path = changed(folder.path(), "models/attacker.srm", branch, "CONDITION -> kickBall : [false]");
    let seeds = if crate::is_long() { 1..=20 } else { 1..=5 };
    for seed in seeds {
        let (summary, statistics) = played(&path, seed, 60);
        let kicks: u32 = summary.teams.iter().map(|team| team.kicks).sum();
        assert_eq!(kicks, 0, "seed {seed}");
        let calls = |activity| {
            statistics.agents.iter().map(|agent| statistics.calls(&agent.host, activity)).sum::<u64>()
        };
        assert_eq!(calls("LeftKick") + calls("RightKick"), 0, "seed {seed}");
        assert!(calls("AlignWithBall") > 0, "seed {seed}: the ball was never near");
    }
}

#[test]
fn no_robot_decides_before_the_game_is_on() {
    let folder = tempfile::tempdir().unwrap();
    let before = "<initial_duration>1</initial_duration>";
    let path =
        changed(folder.path(), "config/simulator.xml", before, "<initial_duration>200</initial_duration>");
    let (_, statistics) = played(&path, 7, 120);
    let calls =
        |activity| statistics.agents.iter().map(|agent| statistics.calls(&agent.host, activity)).sum::<u64>();
    assert_eq!((calls("WalkToKickOff"), calls("WaitForBallMessage")), (0, 0));
    assert!(calls("Vision") > 5000 && calls("Sensors") > 5000, "they find their poses");
    assert!(calls("RobotController") > 6000, "the parts that always run do run");
}

#[test]
fn every_state_is_active_and_every_transition_fires_in_a_match() {
    let (seed, seconds) = if crate::is_long() { (7, 600) } else { (4, 300) };
    let (summary, _) = played(&root().join(MATCH.file), seed, seconds);
    let mut models: BTreeMap<String, ChartCoverage> = BTreeMap::new();
    for coverage in &summary.coverage {
        let sum = models.entry(coverage.model.clone()).or_insert_with(|| coverage.clone());
        if sum.host != coverage.host {
            sum.add(coverage);
        }
    }
    assert_eq!(models.len(), 2);
    for (model, coverage) in &models {
        let fired = coverage.transitions.iter().filter(|transition| transition.fired > 0).count();
        let entered = coverage.states.iter().filter(|state| state.entered > 0).count();
        let never = coverage.transitions.iter().filter(|transition| transition.never).count();
        println!(
            "{model}: {entered} of {} states, {fired} of {} transitions, {never} marked [false]",
            coverage.states.len(),
            coverage.transitions.len(),
        );
        assert_eq!(coverage.states_missed().collect::<Vec<_>>(), Vec::<&str>::new(), "{model}");
        assert_eq!(coverage.transitions_missed().collect::<Vec<_>>(), Vec::<&str>::new(), "{model}");
    }
}
