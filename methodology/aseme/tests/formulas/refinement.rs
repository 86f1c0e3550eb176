//! Refinements remain valid when formulas are edited, as far as they still match.

use aseme::SrmFile;
use yase::{Diagnostic, Statechart};

const ROLE: &str = "\
Role: player
Liveness:
player = Stand . ( Search | act )   # to be extended
act = Track . Kick
Transitions:
Stand -> (Search|act) : [up]        # after the beginning
CONDITION -> Search : [!Ball.found]
CONDITION -> act : [Ball.found]
Track -> Kick
        : [Ball.distance < 0.25] / StartTimeout(kick, 100ms)
Kick -> END : [kick]
";

fn chart(text: &str) -> (Statechart, Vec<Diagnostic>) {
    let (file, findings) = SrmFile::parse(text);
    assert_eq!(findings, []);
    aseme::role_to_statechart(file.srm())
}

/// Each refined transition as `source -> target : expression`.
fn refined(chart: &Statechart) -> Vec<String> {
    let refined = chart.transitions().filter(|(_, transition)| !transition.expression.is_empty());
    refined
        .map(|(id, transition)| {
            format!("{} : {}", aseme::path::shortest_transition(chart, id), transition.expression)
        })
        .collect()
}

#[test]
fn every_entry_finds_its_transition() {
    let (chart, unmatched) = chart(ROLE);
    assert_eq!(unmatched, []);
    assert_eq!(
        refined(&chart),
        [
            "Stand -> (Search|act) : [up]",
            "CONDITION -> Search : [!Ball.found]",
            "CONDITION -> act : [Ball.found]",
            "Track -> Kick : [Ball.distance < 0.25] / StartTimeout(kick, 100ms)",
            "Kick -> END : [kick]",
        ]
    );
}

#[test]
fn an_edit_elsewhere_keeps_every_refinement() {
    let edited = ROLE
        .replace("player = Stand .", "player = LedHandlerω || ( Boot . Stand .")
        .replace("act )   #", "act ) )   #");
    let (before, _) = chart(ROLE);
    let (after, unmatched) = chart(&edited);
    assert_eq!(unmatched, []);
    assert_eq!(refined(&before), refined(&after));
}

#[test]
fn unmatched_entries_are_reported_with_text_and_candidates() {
    let edited = ROLE.replace("act = Track . Kick", "act = Track . [Align] . Kick");
    let (chart, unmatched) = chart(&edited);
    let [finding] = unmatched.as_slice() else { panic!("{unmatched:?}") };
    let text = "Track -> Kick : [Ball.distance < 0.25] / StartTimeout(kick, 100ms)";
    assert_eq!(finding.message, format!("`{text}` names no transition of the chart"));
    assert_eq!(finding.hint.as_deref(), Some("did you mean one of `Track -> [Align]`, `[Align] -> Kick`?"));
    assert_eq!(refined(&chart).len(), 4, "the others stay");
}

#[test]
fn ambiguous_entries_are_named_with_candidates() {
    let edited = ROLE.replace("( Search | act )   #", "( Search | act ) . Track . Kick  #");
    let (_, unmatched) = chart(&edited);
    let hints: Vec<&str> = unmatched.iter().filter_map(|finding| finding.hint.as_deref()).collect();
    assert_eq!(unmatched.iter().map(|finding| finding.code).collect::<Vec<_>>(), ["E0251", "E0251"]);
    assert_eq!(hints[0], "did you mean one of `player/Track -> Kick`, `act/Track -> Kick`?");
}

#[test]
fn candidates_fit_when_taken_as_they_are() {
    let text = "Liveness:\nr = a~ || (b . a . b . a) || |c~|2\n";
    let (chart, _) = chart(text);
    for (id, _) in chart.transitions() {
        let path = aseme::path::shortest_transition(&chart, id);
        let (again, unmatched) = self::chart(&format!("{text}Transitions:\n{path} : [x]\n"));
        assert_eq!(unmatched, [], "{path}");
        let refined = again.transitions().filter(|(_, transition)| !transition.expression.is_empty());
        assert_eq!(refined.map(|(id, _)| id).collect::<Vec<_>>(), [id], "{path}");
    }
}

#[test]
fn scopes_occurrences_and_wildcards() {
    let text = "\
Liveness:
r = a . b . a . c~ . d~
Transitions:
r: a[2] -> c~ !3 : [second]
*~ -> * : [wild]
d~ -> END %0.5 interrupts : [plain]
r/START -> a[1]
        !-1 : [first]
";
    let (chart, unmatched) = chart(text);
    // `*` matches states, and END is none
    assert_eq!(unmatched, []);
    assert_eq!(
        refined(&chart),
        ["START -> a[1] : [first]", "a[2] -> c~ : [second]", "c~ -> d~ : [wild]", "d~ -> END : [plain]"]
    );
    let said: Vec<_> = chart
        .transitions()
        .map(|(_, transition)| (transition.priority, transition.weight, transition.interrupts))
        .collect();
    assert_eq!(
        said[..6],
        [
            (-1, None, false),
            (0, None, false),
            (0, None, false),
            (3, None, false),
            (0, None, false),
            (0, Some(0.5), true)
        ]
    );
}

#[test]
fn states_are_refined() {
    let text = "\
Liveness:
r = a . (b | c)
States:
a : activity = Walk, priority = 5, entry = StartTimeout(t, 100ms), publish_all, exit = raise(left), defer = one two.three
(b|c)/b : duration = 250ms   # a while
*: priority = 1
";
    let (chart, unmatched) = chart(text);
    let nodes = |name: &str| {
        chart.nodes().find(|(_, node)| node.name == name).map(|(_, node)| node.clone()).expect("a node")
    };
    let codes: Vec<&str> = unmatched.iter().map(|finding| finding.code).collect();
    assert_eq!(codes, ["E0253", "E0253"], "`*` is for composites too");
    let a = nodes("a");
    assert_eq!((a.activity.as_deref(), a.priority, a.entry.len(), a.exit.len()), (Some("Walk"), 5, 2, 1));
    assert_eq!(a.defer, ["one", "two.three"]);
    assert_eq!(nodes("b").duration, Some(std::time::Duration::from_millis(250)));
    assert_eq!((nodes("b").activity.as_deref(), nodes("c").priority), (Some("b"), 1));
}

#[test]
fn entries_know_their_place() {
    let (file, _) = SrmFile::parse(ROLE);
    let entries: Vec<&str> =
        file.entries().iter().map(|entry| &ROLE[entry.span.start..entry.span.end]).collect();
    assert_eq!(
        entries[..4],
        ["player", "player = Stand . ( Search | act )", "act = Track . Kick", "Stand -> (Search|act) : [up]"]
    );
}
