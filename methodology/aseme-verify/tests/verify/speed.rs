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
    let what = report.kind.clone().unwrap_or_default();
    let nodes: usize = what.split(' ').next().and_then(|count| count.parse().ok()).unwrap_or(0);
    assert!(nodes >= 1_900, "{what}");
    let shadowed = report.findings.iter().filter(|finding| finding.diagnostic.code == "M07").count();
    assert!(shadowed >= 99, "each `g` comes too late: {shadowed}");
    assert!(!report.has_errors());
}

/// Branches without a guard contradict nothing, so they do not use up the paths that are compared.
#[test]
fn a_contradiction_is_found_behind_any_number_of_harmless_branches() {
    let harmless = "  CONDITION -> END\n".repeat(4_500);
    let chart = format!(
        "IAC: r\n\nStates:\n  r OR\n    START\n    a BASIC\n    CONDITION\n    b BASIC\n    END\n\nTransitions:\n  \
         START -> a\n  a -> CONDITION : [Ball.distance < 1]\n{harmless}  CONDITION -> b : [Ball.distance > 2]\n  \
         b -> END\n"
    );
    let mut settings = CheckSettings::default();
    settings.states = 0;
    let report = check(&Source::new("r.iac", chart), &settings);
    assert!(!report.is_unreadable(), "{:?}", report.findings.first());
    let dead = report.findings.iter().filter(|it| it.diagnostic.message.contains("is never enabled"));
    assert_eq!(dead.map(|it| it.diagnostic.code).collect::<Vec<_>>(), ["M06"]);
}

/// Asserts that all states are explored and all traces compared, so that nothing is undecided: in
/// the long form of the tests, as in `.ci/run`. Else only the first states are explored.
fn is_explored(name: &str, configurations: usize, expected: &[&str]) {
    if std::env::var_os("MONAS_LONG_TESTS").is_some() {
        return is_explored_to_the_end(name, configurations, expected);
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").join(name);
    let source = Source::new(name, std::fs::read_to_string(path).unwrap());
    let mut settings = CheckSettings::default();
    settings.states = 5_000;
    let report = check(&source, &settings);
    let findings = report.findings.iter().filter(|it| it.diagnostic.severity > Severity::Information);
    assert_eq!(findings.map(ToString::to_string).collect::<Vec<_>>(), expected);
    assert_eq!(report.explored.unwrap().states, 5_000);
}

fn is_explored_to_the_end(name: &str, configurations: usize, expected: &[&str]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").join(name);
    let source = Source::new(name, std::fs::read_to_string(path).unwrap());
    let report = check(&source, &CheckSettings::default());
    let findings = report.findings.iter().filter(|it| it.diagnostic.severity > Severity::Information);
    assert_eq!(findings.map(ToString::to_string).collect::<Vec<_>>(), expected);
    let explored = report.explored.unwrap();
    assert!(explored.is_finished, "{explored:?}");
    assert_eq!(explored.configurations, configurations, "{explored:?}");
}

#[test]
fn the_goalie_is_explored_to_the_end() {
    is_explored("goalie.srm", 31, &[]);
}

#[test]
fn the_attacker_is_explored_to_the_end() {
    is_explored("attacker.srm", 33, &[]);
}

#[test]
fn the_extended_attacker_is_explored_to_the_end() {
    // Without the program it is unknown that `passBall` is an activity.
    let pass = "extended_attacker.srm:20:44: warning[M21]: `passBall` has no formula and is taken for an activity \
                (write its formula, or check the role with the program that has the activity)";
    is_explored("extended_attacker.srm", 59, &[pass]);
}

/// A long sequence is compared with its formula activity by activity, not each with all.
#[test]
fn a_long_sequence_is_checked_to_the_end() {
    let names: Vec<String> = (0..3_000).map(|number| format!("a{number}")).collect();
    let role = format!("Role: r\nLiveness:\nr = {}\n", names.join(" . "));
    let report = check(&Source::new("long.srm", role), &CheckSettings::default());
    let findings = report.findings.iter().filter(|it| it.diagnostic.severity > Severity::Information);
    assert_eq!(findings.map(ToString::to_string).collect::<Vec<_>>(), [""; 0]);
    let explored = report.explored.unwrap();
    assert!(explored.is_finished && explored.states == 3_001, "{explored:?}");
}

/// An exploration ends where its caller, its memory or its number of states ends it, and says
/// which.
#[test]
fn an_exploration_says_why_it_ended() {
    use aseme_verify::{CheckProgress, ProgressObserver};
    use std::ops::ControlFlow;
    use yase_explore::ExplorationStop;

    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/goalie.srm");
    let source = Source::new("goalie.srm", std::fs::read_to_string(path).unwrap());
    let stop = |settings: &CheckSettings| check(&source, settings).explored.unwrap().stop;
    let mut settings = CheckSettings::default();
    settings.observer = ProgressObserver::new(|progress| match progress {
        CheckProgress::Exploring(progress) if progress.states >= 100 => ControlFlow::Break(()),
        _ => ControlFlow::Continue(()),
    });
    assert_eq!(stop(&settings), Some(ExplorationStop::Observer));
    let mut settings = CheckSettings::default();
    settings.bytes = 100_000;
    assert_eq!(stop(&settings), Some(ExplorationStop::Bytes));
    settings.states = 50;
    settings.bytes = usize::MAX;
    assert_eq!(stop(&settings), Some(ExplorationStop::States));
}

/// A queue that grows is widened: the number of states does not grow with the limit.
#[test]
fn a_queue_that_grows_does_not_make_states() {
    let role = include_str!("m28/fault.srm");
    let states = |limit: usize| {
        let mut settings = CheckSettings::default();
        settings.states = limit;
        let report = check(&Source::new("q.srm", role), &settings);
        assert!(report.findings.iter().all(|it| it.diagnostic.code != "M13"), "{:?}", report.findings);
        let explored = report.explored.unwrap();
        assert_eq!(explored.overflowing, ["go"]);
        explored.states
    };
    assert_eq!(states(100_000), states(100));
}
