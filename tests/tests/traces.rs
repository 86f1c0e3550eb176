//! What the charts of both roles do in the first simulated second is written in golden files. `MONAS_BLESS=1` writes them anew.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use monas::MicroStep;
use monas_match::{Match, Options};
use monas_tests::{MATCH, root};

/// The trace of the chart on a host in the first second of a match.
fn trace_of(host: &'static str) -> String {
    let lines = Arc::new(Mutex::new(String::new()));
    let written = lines.clone();
    let plan = Match::load(root().join(MATCH.file), &monas::Registry::linked()).unwrap();
    let plan = plan.listen(Box::new(move |step: MicroStep<'_>| {
        if step.host == host {
            let mut lines = written.lock().unwrap();
            lines.push_str(&step.record.display(step.chart).to_string());
            lines.push('\n');
        }
    }));
    let mut running = plan.start(Options { seed: 7, record: None }).unwrap();
    running.advance(Duration::from_secs(1)).unwrap();
    let text = lines.lock().unwrap().clone();
    text
}

fn check(host: &'static str, file: &str) {
    let path = root().join("tests/golden").join(file);
    let trace = trace_of(host);
    assert!(trace.lines().count() > 10, "{trace}");
    if std::env::var_os("MONAS_BLESS").is_some() {
        std::fs::write(&path, &trace).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap(), trace);
}

#[test]
fn the_goalies_first_second() {
    check("blue-1", "goalie.trace");
}

#[test]
fn the_attackers_first_second() {
    check("blue-2", "attacker.trace");
}
