//! Every kind of error has a code, a position and a hint.

use yase::{Diagnostic, Severity, Source};

/// All findings about a text.
fn findings(text: &str) -> Vec<Diagnostic> {
    aseme::statechart_of_role(&Source::new("role.srm", text)).1
}

/// Asserts that a text has one finding with this code, text at its span, and part of its message or
/// hint.
fn check(text: &str, code: &str, marked: &str, says: &str) {
    let found = findings(text);
    let [finding] = found.as_slice() else { panic!("{text:?}: {found:?}") };
    let said = format!("{} / {}", finding.message, finding.hint.as_deref().unwrap_or_default());
    assert_eq!(finding.code, code, "{text:?}: {finding}");
    assert_eq!(&text[finding.span.start..finding.span.end], marked, "{text:?}: {finding}");
    assert!(said.contains(says), "{text:?}: {finding}");
}

#[test]
fn lines_that_are_no_formula() {
    check("a || b", "E0201", "a || b", "starts with `name =`");
    check("my role = a", "E0202", "my role", "is not a name");
    check(" = a", "E0202", "=", "is not a name");
    check("r = a = b", "E0203", "= b", "its own line");
    check("", "E0216", "", "role = activity1");
    check("# nothing", "E0216", "# nothing", "no formula");
}

#[test]
fn foreign_characters_are_reported_once() {
    check("r = a . &%$b", "E0204", "&%$", "no meaning");
    check("r = a ^ . b", "E0204", "^", "no meaning");
}

#[test]
fn operators_stand_between_terms() {
    check("r = a..b", "E0205", ".", "to the left of `.`");
    check("r = a . b .", "E0205", ".", "to the right of `.`");
    check("r = a ||", "E0205", "||", "to the right of `||`");
    check("r = . a", "E0205", ".", "to the left");
    check("r = (a | ) . b", "E0205", "|", "to the right");
    check("r = a b", "E0208", "b", "write `.` for a sequence");
    check("r = a (b.c)", "E0208", "(", "no operator before");
    check("r = *a", "E0209", "*", "`*` has no operand");
}

#[test]
fn brackets_are_balanced() {
    check("r = (a . b", "E0206", "(", "add the missing `)`");
    check("r = a . b)", "E0206", ")", "remove this");
    check("r = (a . [b)", "E0206", "[", "add the missing `]`");
    check("r = a . ()", "E0207", "(", "nothing follows `(`");
    check("r =", "E0207", "=", "name of an activity");
}

#[test]
fn copies_need_a_number_and_go_on_forever() {
    check("r = |a~|", "E0211", "|a~|", "as in `|x~|3`");
    check("r = |a~|0", "E0211", "|a~|0", "from 1");
    check("r = |a~|99999999999", "E0211", "|a~|99999999999", "whole number");
    check("r = |a|3", "E0212", "a", "write `|x~|n`");
    check("r = |a~ . b", "E0212", "|", "|(x . y)~|n");
    check("r = a . |b~", "E0212", "|", "ends");
}

#[test]
fn mixed_operators_are_a_warning() {
    let text = "r = a . b | c || d";
    check(text, "E0210", "a . b | c || d", "add parentheses");
    assert_eq!(findings(text)[0].severity, Severity::Warning);
    assert_eq!(findings("r = (a . b) | c"), []);
}

#[test]
fn formulas_fit_together() {
    check("a = b . c\nb = d\nb = e", "E0213", "b", "has a formula already");
    check("a = b\nb = c\nc = x . a", "E0214", "a", "a -> b -> c -> a");
    check("a = a", "E0214", "a", "a -> a");
    check("a = b\nc = d", "E0215", "c", "not part of `a`");
}

/// The name that is misspelt is reported, not what is missing because of it.
#[test]
fn a_misspelt_name_is_reported_once() {
    check("play = takeAction\ntakeAktion = x", "E0217", "takeAction", "did you mean `takeAktion`?");
    let role = "Role: r\nLiveness:\nr = Stand . acton . acton\naction = (Search | chase)~\nchase = Walk\n\
                Transitions:\nCONDITION -> Search : [!Ball.found]\nCONDITION -> chase : [Ball.found]\n\
                Walk -> END : [false]\nStates:\nWalk : priority = 3\n";
    check(role, "E0217", "acton", "did you mean `action`?");
    // short names resemble each other by chance
    check("r = ab\nac = b", "E0215", "ac", "not part of `r`");
}

#[test]
fn an_operator_that_is_to_be_chosen_is_no_name() {
    check("r = Walk ?OP? Kick", "E0219", "?OP?", "`|` for one of them");
}

#[test]
fn a_slip_of_case_is_named() {
    let found = findings("r = Decision+\ndecision = a");
    let codes: Vec<&str> = found.iter().map(|finding| finding.code).collect();
    assert_eq!(codes, ["E0218", "E0215"]);
    assert_eq!(found[0].hint.as_deref(), Some("did you mean `decision`?"));
}

#[test]
fn charts_have_limits() {
    let deep = format!("r = {}a{}", "[".repeat(300), "]".repeat(300));
    assert_eq!(findings(&deep)[0].code, "E0220");
    let levels: String = (0..40).map(|n| format!("x{n} = x{next} . x{next}\n", next = n + 1)).collect();
    assert_eq!(findings(&levels)[0].code, "E0221");
    assert_eq!(findings("r = |a~|4000000000")[0].code, "E0221");
}

#[test]
fn sections_are_known() {
    check("<SAGmodel/>", "E0230", "<SAGmodel", "an `SRM:SRMmodel`, or text");
    check("Role: r\nLivenes:\nr = a", "E0231", "Livenes", "did you mean `Liveness:`?");
    check("Liveness:\nr = a\nLiveness:\nq = b", "E0232", "Liveness", "repeated");
    check("Role: r\nConstants:", "E0233", "Role: r", "add `Liveness:`");
    check("Role:\nLiveness:\nr = a", "E0234", ":", "no name");
    check("Protocols: Attack\nLiveness:\nr = a", "E0235", "Attack", "protocol: participant");
    check("something\nLiveness:\nr = a", "E0236", "something", "precedes the first section");
}

#[test]
fn constants_are_values_with_names() {
    let check = |line: &str, code, marked, says| {
        check(&format!("Liveness:\nr = a\nConstants:\n{line}\n"), code, marked, says)
    };
    check("near", "E0237", "near", "name = value");
    check("2near = 1", "E0237", "2near = 1", "starts with an ASCII letter");
    check("a = 1\na = 2", "E0238", "a = 2", "already");
    check("a = one", "E0239", "a = one", "a number, which a unit may follow");
}

#[test]
fn transition_entries_are_well_formed() {
    let check = |line: &str, code, marked, says| {
        check(&format!("Liveness:\nr = a . b\nTransitions:\n{line}\n"), code, marked, says)
    };
    check("a b : [false]", "E0240", "a b : [false]", "source -> target");
    check("a/ -> b", "E0241", "a/", "missing in the path");
    check("a -> b$", "E0241", "b$", "`$` cannot occur");
    check("a -> b !x", "E0242", "!x", "!priority");
    check("a -> b %-1", "E0242", "%-1", "%weight");
}

#[test]
fn state_entries_are_well_formed() {
    let check = |line: &str, code, marked, says| {
        check(&format!("Liveness:\nr = a . b\nStates:\n{line}\n"), code, marked, says)
    };
    check("a", "E0243", "a", "path : key = value");
    check("a : 5", "E0243", "5", "keys are");
    check("a : prioritty = 5", "E0244", "prioritty", "did you mean `priority`?");
    check("a : priority = high", "E0245", "high", "a whole number");
    check("a : duration = 2 hours", "E0245", "2 hours", "`250ms`");
    check("a : activity = my activity", "E0245", "my activity", "name of an activity");
}

#[test]
fn entries_name_one_thing() {
    let check = |lines: &str, code, marked, says| {
        check(&format!("Liveness:\nr = (a . b) | (b . c)\n{lines}\n"), code, marked, says)
    };
    check("Transitions:\nb -> a : [false]", "E0250", "b -> a : [false]", "names no transition");
    check("Transitions:\na -> bb : [x_timeout]", "E0250", "a -> bb : [x_timeout]", "did you mean `b`?");
    check("Transitions:\nSTART -> *~", "E0250", "START -> *~", "names no transition");
    check("Transitions:\na -> b\n(a.b)/a -> b : [false]", "E0252", "(a.b)/a -> b : [false]", "keep one");
    check("States:\nb : priority = 5", "E0251", "b : priority = 5", "`(a.b)/b`, `(b.c)/b`");
    check(
        "States:\nCONDITION : exit = publish_all",
        "E0250",
        "CONDITION : exit = publish_all",
        "names no state",
    );
    check("States:\n(a.b) : activity = Walk", "E0253", "(a.b) : activity = Walk", "runs no activity");
}

#[test]
fn two_mistakes_are_two_findings_with_their_lines() {
    let text = "Role: r\nLiveness:\nr = a . b\nTransitions:\na -> b : [false]\na -> c : [false]\nStates:\nb : prio = 1\n";
    let found: Vec<String> = findings(text).iter().map(Diagnostic::to_string).collect();
    assert_eq!(found.len(), 2, "{found:#?}");
    assert!(
        found[0].starts_with("role.srm:6:1: error[E0250]: `a -> c : [false]` names no transition"),
        "{}",
        found[0]
    );
    assert!(found[1].starts_with("role.srm:8:5: error[E0244]: states have no `prio`"), "{}", found[1]);
}
