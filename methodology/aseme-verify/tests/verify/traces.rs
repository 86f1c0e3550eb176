//! Traces of explorations can be parsed from their text and replayed.

use std::sync::Arc;

use aseme_verify::{CheckSettings, Finding, check::check, explorable};
use yase::{MachineErrorKind, Source};
use yase_explore::{Trace, replay};

fn first_with(text: &str, code: &str) -> (Arc<Source>, Finding) {
    let source = Source::new("r.iac", text);
    let report = check(&source, &CheckSettings::default());
    let found = report.findings.iter().find(|finding| finding.diagnostic.code == code);
    (source, found.unwrap_or_else(|| panic!("no {code} in {:?}", report.findings)).clone())
}

#[test]
fn a_way_to_a_dead_end_leads_there() {
    let text = include_str!("m14/fault.iac");
    let (source, finding) = first_with(text, "M14");
    let chart = explorable(&source).unwrap();
    let trace = Trace::parse(&chart, finding.trace.as_deref().unwrap()).unwrap();
    assert_eq!(trace.to_string(), finding.trace.unwrap());
    let mut steps = 0;
    let machine = replay(&trace, |_, _, _| steps += 1).unwrap();
    assert_eq!(steps, trace.steps().len());
    let active: Vec<String> =
        machine.configuration().into_iter().map(|node| chart.short_path(node)).collect();
    assert_eq!(active, ["r", "b"]);
}

#[test]
fn a_way_to_a_livelock_ends_in_it() {
    let (source, finding) = first_with(include_str!("m13/fault.iac"), "M13");
    let chart = explorable(&source).unwrap();
    let trace = Trace::parse(&chart, finding.trace.as_deref().unwrap()).unwrap();
    assert_eq!(replay(&trace, |_, _, _| {}).unwrap_err().kind(), MachineErrorKind::NeverRests);
}

#[test]
fn an_invalid_trace_is_rejected_with_its_line() {
    let chart = explorable(&Source::new("r.iac", include_str!("m14/fault.iac"))).unwrap();
    let refused = |text: &str| Trace::parse(&chart, text).unwrap_err().to_string();
    assert_eq!(refused(""), "line 1: a trace starts with `start`");
    assert_eq!(refused("event kick"), "line 1: a trace starts with `start`");
    assert_eq!(refused("  true  x\n"), "line 1: this line belongs to no step: a trace starts with `start`");
    assert!(
        refused("# a\nstart\nreturn x\n").starts_with("line 3: no state with an activity has the name `x`")
    );
    assert!(refused("start\ntimer r x\n").starts_with("line 2: the chart has no timer `r x`"));
    assert!(refused("start\n  true  Ball.found\n").starts_with("line 2: no guard of the chart reads"));
    assert!(refused("start now\n").starts_with("line 1: `start now` is not a step"));
}
