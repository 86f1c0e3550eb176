//! The effort of the checks for a large role and for the project's roles.

use std::path::Path;

use aseme_verify::{CheckSettings, check::check};
use yase::{Severity, Source};

use crate::large::large;

#[test]
fn a_large_role_is_checked() {
    let mut settings = CheckSettings::default();
    settings.states = 100;
    let report = check(&Source::new("large.srm", large()), &settings);
    let what = report.what.clone().unwrap_or_default();
    let nodes: usize = what.split(' ').next().and_then(|count| count.parse().ok()).unwrap_or(0);
    assert!(nodes >= 1_900, "{what}");
    let shadowed = report.findings.iter().filter(|finding| finding.diagnostic.code == "M07").count();
    assert!(shadowed >= 99, "each `g` comes too late: {shadowed}");
    assert!(!report.has_errors());
}

/// Asserts that all states are explored and all traces compared, so that nothing is undecided.
fn is_explored_to_the_end(name: &str, configurations: usize) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").join(name);
    let source = Source::new(name, std::fs::read_to_string(path).unwrap());
    let report = check(&source, &CheckSettings::default());
    let findings = report.findings.iter().filter(|it| it.diagnostic.severity > Severity::Information);
    assert_eq!(findings.map(ToString::to_string).collect::<Vec<_>>(), [""; 0]);
    let explored = report.explored.unwrap();
    assert!(explored.is_finished, "{explored:?}");
    assert_eq!(explored.configurations, configurations, "{explored:?}");
}

#[test]
fn the_goalie_is_explored_to_the_end() {
    is_explored_to_the_end("goalie.srm", 42);
}

#[test]
fn the_attacker_is_explored_to_the_end() {
    is_explored_to_the_end("attacker.srm", 46);
}

#[test]
fn the_extended_attacker_is_explored_to_the_end() {
    is_explored_to_the_end("extended_attacker.srm", 78);
}
