//! Checks of models that are larger than people write them: none of them may be quadratic. Each of
//! these tests takes minutes if one is.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::ops::ControlFlow;

use aseme_verify::check::{CheckReport, check};
use aseme_verify::{CheckProgress, CheckSettings, Finding, ProgramSymbols, ProgressObserver};
use yase::Source;

const STATES: usize = 20_000;

fn checked(name: &str, text: String) -> CheckReport {
    let mut settings = CheckSettings::default();
    settings.states = 0;
    check(&Source::new(name, text), &settings)
}

/// A role of many states in a row with an entry for each transition or state.
fn role(section: &str, entry: impl Fn(usize) -> String) -> String {
    let names: Vec<String> = (0..STATES).map(|number| format!("A{number}")).collect();
    let entries = (0..STATES - 1).fold(String::new(), |mut text, number| {
        writeln!(text, "{}", entry(number)).unwrap();
        text
    });
    format!("Role: r\nLiveness:\nr = {}\n{section}:\n{entries}", names.join(" . "))
}

fn count(report: &CheckReport, code: &str) -> usize {
    report.findings.iter().filter(|finding| finding.diagnostic.code == code).count()
}

fn codes(report: &CheckReport) -> BTreeSet<&'static str> {
    report.findings.iter().map(|finding| finding.diagnostic.code).collect()
}

/// Places of findings are asked for, as their reader does.
fn last_column(report: &CheckReport) -> usize {
    report
        .findings
        .iter()
        .filter_map(|it| it.diagnostic.position())
        .map(|(_, column)| column)
        .max()
        .unwrap_or(0)
}

#[test]
fn events_of_which_no_other_part_knows_are_each_reported() {
    let entry = |number| format!("A{number} -> A{} : e{number} / raise(f{number})", number + 1);
    let report = checked("events.srm", role("Transitions", entry));
    assert_eq!(count(&report, "M16"), 2 * (STATES - 1));
}

#[test]
fn timers_that_are_not_read_are_each_reported() {
    let entry = |number| {
        format!("A{number} -> A{} : [TimeoutCheck(t{number})] / StartTimeout(u{number}, 1s)", number + 1)
    };
    let report = checked("timers.srm", role("Transitions", entry));
    assert_eq!(count(&report, "M19"), 2 * (STATES - 1));
}

#[test]
fn regions_that_read_and_write_the_same_message_are_compared() {
    let mut text = String::from("IAC: r\n\nStates:\n  r OR\n    START\n    both AND\n");
    for number in 0..STATES {
        writeln!(text, "      R{number} OR\n        START\n        A{number} BASIC\n        END").unwrap();
    }
    text += "\nTransitions:\n  r/START -> both\n";
    for number in 0..STATES {
        let step = "[Ball.x > 1] / Ball.x = 1";
        writeln!(text, "  R{number}/START -> A{number} : {step}\n  A{number} -> R{number}/END").unwrap();
    }
    let report = checked("regions.iac", text);
    assert!(!report.is_unreadable(), "{:?}", codes(&report));
    assert_eq!(count(&report, "M11"), STATES);
}

#[test]
fn entries_for_states_that_do_not_exist_are_each_reported() {
    let report = checked("states.srm", role("States", |number| format!("B{number} : activity = X")));
    assert_eq!(count(&report, "E0250"), STATES - 1);
}

#[test]
fn states_of_the_same_name_get_numbers() {
    let report = checked("twins.srm", format!("Role: r\nLiveness:\nr = {}\n", vec!["a"; STATES].join(" . ")));
    assert!(!report.is_unreadable());
}

#[test]
fn findings_in_one_long_line_have_their_columns() {
    let names: Vec<String> = (0..STATES).map(|number| format!("a{number}")).collect();
    let report = checked("line.srm", format!("Role: r\nLiveness:\nr = B . {}\n", names.join(" . ")));
    assert_eq!(count(&report, "M21"), STATES);
    assert!(last_column(&report) > 7 * STATES);
}

#[test]
fn lines_without_sense_are_each_reported() {
    let lines = (0..STATES).fold(String::new(), |mut text, number| {
        writeln!(text, ") x{number} = | (").unwrap();
        text
    });
    let report = checked("lines.srm", format!("Role: r\nLiveness:\nr = A\n{lines}"));
    assert!(report.is_unreadable() && report.findings.len() >= STATES);
    assert!(last_column(&report) > 0);
}

/// A chart of many composites, each with a START that transitions name.
#[test]
fn connectors_of_many_composites_are_found() {
    let mut text = String::from("IAC: r\n\nStates:\n  r OR\n    START\n");
    for number in 0..STATES {
        writeln!(text, "    R{number} OR\n      START\n      A{number} BASIC").unwrap();
    }
    text += "\nTransitions:\n  r/START -> R0\n";
    for number in 0..STATES {
        writeln!(text, "  R{number}/START -> A{number}\n  A{number} -> X{number}").unwrap();
    }
    let report = checked("composites.iac", text);
    assert_eq!(count(&report, "E0271"), STATES);
    assert_eq!(codes(&report).len(), 1);
}

#[test]
fn states_that_a_document_does_not_have_are_each_reported() {
    let mut text = String::from("<scxml xmlns=\"http://www.w3.org/2005/07/scxml\" version=\"1.0\">\n");
    for number in 0..STATES {
        writeln!(text, "<state id=\"A{number}\"><transition event=\"e\" target=\"B{number}\"/></state>")
            .unwrap();
    }
    let report = checked("states.scxml", text + "</scxml>\n");
    assert_eq!(count(&report, "E0606"), STATES);
}

/// The caller sees how far the checks before an exploration have come, and may end them.
#[test]
fn checks_before_an_exploration_can_be_stopped() {
    let text = || role("Transitions", |number| format!("A{number} -> A{} : [1 > 2]", number + 1));
    let stopped_at = |last: usize| {
        let mut settings = CheckSettings::default();
        settings.observer = ProgressObserver::new(move |progress| match progress {
            CheckProgress::Checking { done, of } if done < of.min(last) => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        });
        check(&Source::new("r.srm", text()), &settings)
    };
    let parts = 2 * (STATES + 3) + 2 * (STATES + 1);
    let some = stopped_at(parts / 2 + 1_001);
    assert!(some.is_stopped && some.explored.is_none());
    assert_eq!(count(&some, "M09"), 999, "the first transition is that of START");
    assert_eq!(count(&stopped_at(1), "M09"), 0);
    let all = checked("r.srm", text());
    assert!(!all.is_stopped && count(&all, "M09") == STATES - 1);
}

/// Names that the program does not have are compared with its names a limited number of times, and
/// found among the timers of the chart by a binary search.
#[test]
fn names_that_the_program_does_not_have_are_each_reported() {
    let misspelt =
        |number| format!("A{number} -> A{} : [tt{number}] / StartTimeout(t{number}, 1s)", number + 1);
    let mut settings = CheckSettings::default();
    settings.states = 0;
    settings.world = Some(ProgramSymbols::default());
    let report = check(&Source::new("linked.srm", role("Transitions", misspelt)), &settings);
    let unknown = |it: &&Finding| it.diagnostic.message.contains("there is no `tt");
    assert_eq!(report.findings.iter().filter(unknown).count(), STATES - 1);
}

/// A writer finds the one reader of another region among many of its own.
#[test]
fn a_reader_in_another_region_is_found_among_any_number_of_own_readers() {
    let mut text =
        String::from("IAC: r\n\nStates:\n  r OR\n    START\n    both AND\n      W OR\n        START\n");
    for number in 0..40 {
        writeln!(text, "        A{number} BASIC").unwrap();
    }
    text += "        END\n      R OR\n        START\n        B BASIC\n        END\n\nTransitions:\n  r/START -> both\n  W/START -> A0\n  R/START -> B\n";
    for number in 0..39 {
        writeln!(text, "  A{number} -> A{} : [Ball.x > 1] / Ball.x = 1", number + 1).unwrap();
    }
    text += "  A39 -> W/END\n  B -> R/END : [Ball.x > 2]\n";
    let report = checked("readers.iac", text);
    assert!(!report.is_unreadable(), "{:?}", codes(&report));
    assert_eq!(count(&report, "M11"), 39);
    assert!(
        report
            .findings
            .iter()
            .filter(|it| it.diagnostic.code == "M11")
            .all(|it| it.diagnostic.message.starts_with("`B -> "))
    );
}

/// Paths beyond the limit are not compared, and the check says so.
#[test]
fn paths_that_are_not_compared_are_said() {
    let chart = |branches: usize| {
        let guarded = "  CONDITION -> b : [Ball.distance > 2]\n".repeat(branches);
        format!(
            "IAC: r\n\nStates:\n  r OR\n    START\n    a BASIC\n    CONDITION\n    b BASIC\n    END\n\nTransitions:\n  \
             START -> a\n  a -> CONDITION : [Ball.y < 1]\n{guarded}  CONDITION -> END\n  b -> END\n"
        )
    };
    let said = |branches: usize| {
        let report = checked("paths.iac", chart(branches));
        assert!(!report.is_unreadable(), "{:?}", codes(&report));
        report
            .findings
            .iter()
            .any(|it| it.diagnostic.message.contains("are not found") && !it.diagnostic.is_error())
    };
    assert_eq!((said(100), said(5_000)), (false, true));
}
