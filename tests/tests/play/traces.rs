//! The traces of the charts of both roles in the first simulated second and in the first second of
//! play equal golden files. `MONAS_BLESS=1` updates them.

#![allow(clippy::unwrap_used)] // tests may panic

use std::sync::{Arc, Mutex};
use std::time::Duration;

use aseme::path::shortest_path;
use monas::MicroStep;
use monas_match::{MatchOptions, MatchSource};
use monas_tests::{MATCH, root};

const SECOND: Duration = Duration::from_secs(1);

/// The trace of a host's chart during one second of a match, starting at `from`.
fn trace_of(host: &'static str, from: Duration) -> String {
    let lines = Arc::new(Mutex::new(String::new()));
    let written = lines.clone();
    let plan = MatchSource::load(root().join(MATCH.file), &monas::Registry::linked()).unwrap();
    let plan = plan.listen(Box::new(move |step: MicroStep<'_>| {
        if step.host == host && Duration::from_nanos(step.record.time.as_nanos()) >= from {
            let name = |node| shortest_path(step.chart.statechart(), node);
            let mut lines = written.lock().unwrap();
            lines.push_str(&step.record.display_with(step.chart, name).to_string());
            lines.push('\n');
        }
    }));
    let mut running = plan.start(MatchOptions { seed: 7, record: None }).unwrap();
    running.advance(from + SECOND).unwrap();
    drop(running);
    std::mem::take(&mut *lines.lock().unwrap())
}

/// Time of the first kick-off.
fn kick_off() -> Duration {
    let plan = MatchSource::load(root().join(MATCH.file), &monas::Registry::linked()).unwrap();
    let mut running = plan.start(MatchOptions { seed: 7, record: None }).unwrap();
    loop {
        running.advance(running.now() + SECOND).unwrap();
        let time = running.pitch().with_world(|world| {
            let kick_off = |event: &&monas_sim::SimulationEvent| {
                matches!(event.kind, monas_sim::EventKind::KickOff { .. })
            };
            world.events().iter().find(kick_off).map(|event| event.time)
        });
        if let Some(time) = time {
            return Duration::from_secs_f64(time);
        }
    }
}

fn check(host: &'static str, from: Duration, file: &str) {
    let path = root().join("tests/golden").join(file);
    let trace = trace_of(host, from);
    assert!(trace.lines().count() > 10, "{trace}");
    if std::env::var_os("MONAS_BLESS").is_some() {
        std::fs::write(&path, &trace).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap(), trace);
}

#[test]
fn the_goalies_first_second() {
    check("blue-1", Duration::ZERO, "goalie.trace");
}

#[test]
fn the_goalies_first_second_of_play() {
    check("blue-1", kick_off(), "goalie-play.trace");
}

#[test]
fn the_attackers_first_second() {
    check("blue-2", Duration::ZERO, "attacker.trace");
}

#[test]
fn the_attackers_first_second_of_play() {
    check("blue-2", kick_off(), "attacker-play.trace");
}
