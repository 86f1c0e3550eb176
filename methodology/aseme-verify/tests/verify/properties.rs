//! Properties checked by exploration.

use std::sync::Arc;

use aseme_verify::properties::{PropertyOutcome, PropertyResult, check};
use aseme_verify::{CheckSettings, Finding, ProgramSymbols, explorable};
use yase::Source;
use yase::vocabulary::{FieldEntry, FieldId, MessageEntry, TopicEntry, TopicId, TopicKind, ValueType};
use yase_explore::{Trace, replay};

fn judged(
    model: &str,
    formula: &str,
    settings: &CheckSettings,
) -> (Arc<Source>, Vec<PropertyResult>, Vec<Finding>) {
    let model = Source::new("r.srm", model);
    let text = format!("property \"p\": {formula}\n");
    let (judgements, findings) = check(&model, &Source::new("r.properties", text), settings).unwrap();
    (model, judgements, findings)
}

fn outcome(model: &str, formula: &str) -> PropertyOutcome {
    let (_, judgements, findings) = judged(model, formula, &CheckSettings::default());
    assert_eq!(judgements.len(), 1, "{findings:?}");
    assert_eq!(judgements[0].outcome == PropertyOutcome::Holds, findings.iter().all(|it| it.trace.is_none()));
    judgements[0].outcome
}

/// The violating run of a property; asserts that it can be replayed.
fn run_against(model: &str, formula: &str) -> String {
    let (source, _, findings) = judged(model, formula, &CheckSettings::default());
    let text = findings[0].trace.clone().unwrap_or_else(|| panic!("no run: {findings:?}"));
    let trace = Trace::parse(&explorable(&source).unwrap(), &text).unwrap();
    let mut steps = 0;
    replay(&trace, |_, _, _| steps += 1).unwrap();
    assert_eq!(steps, trace.steps().len());
    text
}

/// Looks and takes one of two branches, forever.
const WALKER: &str = "Role: walker\nLiveness:\nwalker = act~\nact = Look . (Turn | Walk)\nTransitions:\n\
    CONDITION -> Turn : [!Ball.found]\nCONDITION -> Walk : [Ball.found]\n";

#[test]
fn a_property_implied_by_guards_holds_and_its_negation_is_violated() {
    assert_eq!(outcome(WALKER, "always (entering Walk implies [Ball.found])"), PropertyOutcome::Holds);
    assert_eq!(outcome(WALKER, "always not (in Walk and in Turn)"), PropertyOutcome::Holds);
    let text = run_against(WALKER, "always (entering Walk implies [!Ball.found])");
    assert_eq!(
        text,
        "start\nreturn act/Look\n  false  !Ball.found\n  true   Ball.found\n  # entering Walk\n"
    );
}

/// A region does not see in a step what is written to the root's blackboard in it; properties read
/// the root's blackboard.
#[test]
fn writes_to_the_root_blackboard_are_not_visible_to_earlier_reads_of_a_region() {
    let role = "Role: r\nLiveness:\nr = (a || b) . c\nTransitions:\n\
        b -> END : [Ball.found]\n(a||b) -> c : go / Ball.found = true\n";
    let text = run_against(role, "always (entering c implies not [Ball.found])");
    assert!(text.contains("event go\n  false  Ball.found\n  # entering c, [Ball.found]\n"), "{text}");
}

#[test]
fn an_optional_event_gives_a_violating_cycle() {
    let restless = WALKER.replace(" : [!Ball.found]", " :");
    let text = run_against(&restless, "always (entering Look implies eventually entering Walk)");
    let (_, circle) = text.split_once("# repeats forever from here\n").unwrap();
    assert!(circle.contains("return ") && !circle.contains("entering Walk"), "{text}");
    let either = "always (entering Look implies eventually (entering Walk or entering Turn))";
    assert_eq!(outcome(WALKER, either), PropertyOutcome::Violated, "nobody need say where the ball is");
}

#[test]
fn an_activity_that_runs_returns_and_a_timer_that_is_set_expires() {
    assert_eq!(
        outcome(WALKER, "always (entering Look implies eventually leaving Look)"),
        PropertyOutcome::Holds
    );
    let plain = "Role: r\nLiveness:\nr = (a . b)~\n";
    assert_eq!(outcome(plain, "always (entering a implies eventually entering b)"), PropertyOutcome::Holds);
    assert_eq!(outcome(plain, "always eventually in a"), PropertyOutcome::Holds);
    assert_eq!(outcome(plain, "eventually always in a"), PropertyOutcome::Violated);
    assert_eq!(outcome(plain, "not in b until in a"), PropertyOutcome::Holds);
    assert_eq!(outcome(plain, "in b until in a"), PropertyOutcome::Holds, "a is there from the beginning");
    assert_eq!(outcome(plain, "(in a until in b) or true"), PropertyOutcome::Holds);
    assert_eq!(outcome(plain, "always not in a until in b"), PropertyOutcome::Violated);
    let timed = "Role: r\nLiveness:\nr = (a . b)~\nTransitions:\na -> b : [TimeoutCheck(t)]\n\
        START -> a : / StartTimeout(t, 1s)\n";
    assert_eq!(outcome(timed, "always (entering a implies eventually entering b)"), PropertyOutcome::Holds);
}

#[test]
fn a_run_that_ends_has_done_what_it_had_to() {
    let once = "Role: r\nLiveness:\nr = a . b\n";
    assert_eq!(outcome(once, "eventually entering b"), PropertyOutcome::Holds);
    assert_eq!(outcome(once, "always eventually entering b"), PropertyOutcome::Violated);
    assert_eq!(outcome(once, "eventually leaving b"), PropertyOutcome::Holds);
    assert_eq!(outcome(once, "always eventually in b"), PropertyOutcome::Violated);
}

#[test]
fn bounds_are_of_model_time() {
    let takes = |duration: &str| {
        format!(
            "Role: r\nLiveness:\nr = (a . b)~\nStates:\na : duration = {duration}\nb : duration = 100 ms\n"
        )
    };
    let soon = "always (entering a implies eventually entering b within 300 ms)";
    assert_eq!(outcome(&takes("300 ms"), soon), PropertyOutcome::Holds);
    assert_eq!(outcome(&takes("301 ms"), soon), PropertyOutcome::Violated);
    let until = "always (entering a implies in a until entering b within 300 ms)";
    assert_eq!(outcome(&takes("300 ms"), until), PropertyOutcome::Holds);
    let text = run_against(&takes("400 ms"), soon);
    assert!(text.contains("# after 400 ms\nreturn "), "{text}");
    // seven ticks of 100 ms are no whole number of milliseconds if seconds are multiplied
    let text = run_against(&takes("700 ms"), soon);
    assert!(text.contains("# after 700 ms\nreturn "), "{text}");
    let never = "always not (entering a and eventually entering b within 200 ms)";
    assert_eq!(outcome(&takes("300 ms"), never), PropertyOutcome::Holds);
    assert_eq!(outcome(&takes("200 ms"), never), PropertyOutcome::Violated);
}

#[test]
fn timers_are_exact_where_time_is_counted() {
    let model = "Role: r\nLiveness:\nr = a~\nTransitions:\na -> a : [t] / StartTimeout(t, 200ms)\n";
    assert_eq!(outcome(model, "always eventually entering a within 200 ms"), PropertyOutcome::Holds);
    assert_eq!(outcome(model, "always eventually entering a within 199 ms"), PropertyOutcome::Violated);
}

#[test]
fn a_part_that_others_wait_for_is_not_left_out() {
    let model = "Role: r\nLiveness:\nr = waits || works\nwaits = a . b\nworks = c . d\nTransitions:\n\
        a -> b : go\nc -> d : / raise(go)\n*||* -> END : [false]\n";
    assert_eq!(outcome(model, "eventually in b"), PropertyOutcome::Holds, "`go` is raised by `works`");
    let alone = model.replace("raise(go)", "StartTimeout(t, 1s)");
    assert_eq!(outcome(&alone, "eventually in b"), PropertyOutcome::Violated, "nobody need raise `go`");
    let (_, with, _) = judged(model, "eventually in b", &CheckSettings::default());
    let (_, without, _) = judged(&alone, "eventually in b", &CheckSettings::default());
    assert!(without[0].states < with[0].states, "{with:?} {without:?}");
}

#[test]
fn an_incomplete_exploration_is_undecided() {
    let mut settings = CheckSettings::default();
    settings.states = 2;
    let (_, judgements, findings) = judged(WALKER, "always not (in Walk and in Turn)", &settings);
    assert_eq!(judgements[0].outcome, PropertyOutcome::NotDecided);
    assert_eq!(findings[0].diagnostic.code, "E0871");
    let (_, judgements, _) = judged(WALKER, "not in Look", &settings);
    assert_eq!(judgements[0].outcome, PropertyOutcome::Violated, "a run that was found is one");
}

/// Code, text at the span, and hint of each finding.
fn said(model: &str, formula: &str, settings: &CheckSettings) -> Vec<(&'static str, String, String)> {
    let (_, _, findings) = judged(model, formula, settings);
    let summary = |it: &Finding| {
        let text = &it.diagnostic.source.as_ref().unwrap().text;
        let span = it.diagnostic.span;
        (
            it.diagnostic.code,
            text[span.start..span.end].to_owned(),
            it.diagnostic.hint.clone().unwrap_or_default(),
        )
    };
    findings.iter().map(summary).collect()
}

#[test]
fn unknown_names_are_reported_with_the_nearest_one() {
    let settings = CheckSettings::default();
    let one = |code, text: &str, hint: &str| vec![(code, text.to_owned(), hint.to_owned())];
    assert_eq!(said(WALKER, "always not in Wakl", &settings), one("E0845", "Wakl", "did you mean `Walk`?"));
    let events = "Role: r\nLiveness:\nr = a . b\nTransitions:\na -> b : kick\n";
    assert_eq!(
        said(events, "eventually event kcik", &settings),
        one("E0846", "kcik", "did you mean `kick`?")
    );
    let twice = "Role: r\nLiveness:\nr = one . two\none = a . b\ntwo = a . c\n";
    assert_eq!(said(twice, "always not in a", &settings), one("E0845", "a", "say which: `one/a`, `two/a`"));
    let field = said(WALKER, "always (in Walk implies [Ball.fuond])", &settings);
    assert!(
        field.contains(&("E0848", "Ball.fuond".into(), "did you mean `Ball.found`?".into())),
        "{field:?}"
    );
}

#[test]
fn timers_have_no_place_in_conditions() {
    let model = "Role: r\nLiveness:\nr = a~\nTransitions:\na -> a : [t] / StartTimeout(t, 200ms)\n";
    for formula in ["always [t]", "always eventually [Ball.found && !t]"] {
        let wrong = said(model, formula, &CheckSettings::default());
        assert_eq!(
            (wrong[0].0, wrong[0].2.as_str()),
            ("E0841", "use `within` after `eventually` or `until`")
        );
    }
    let (_, judgements, findings) = judged(model, "always [ready]", &CheckSettings::default());
    assert_eq!(judgements.len(), 1, "`ready` may be a function of the program: {findings:?}");
}

#[test]
fn the_world_knows_messages_and_fields() {
    let field = FieldEntry { id: FieldId(0), name: "found".into(), kind: ValueType::Bool };
    let (path, message) = ("soccer/ball".to_owned(), "Ball".to_owned());
    let mut world = ProgramSymbols::default();
    let topic = TopicEntry { id: TopicId(0), path, kind: TopicKind::State, message: message.clone() };
    world.vocabulary.topics.push(topic);
    world.vocabulary.messages.push(MessageEntry { name: message, fields: vec![field] });
    let mut settings = CheckSettings::default();
    settings.world = Some(world);
    let wrong = said(WALKER, "always (in Walk implies [Ball.fuond])", &settings);
    assert_eq!(wrong, [("E0134", "fuond".into(), "did you mean `found`?".into())]);
    let wrong = said(WALKER, "always (in Walk implies [Bal.found])", &settings);
    assert_eq!((wrong[0].0, wrong[0].2.as_str()), ("E0132", "did you mean `Ball`?"));
}

fn shipped(role: &str, change: (&str, &str)) -> Vec<(String, PropertyOutcome)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/");
    let read = |ending: &str| std::fs::read_to_string(format!("{folder}{role}.{ending}")).unwrap();
    let model = read("srm");
    assert!(model.contains(change.0));
    let model = Source::new("role.srm", model.replace(change.0, change.1));
    let (judgements, findings) =
        check(&model, &Source::new("role.properties", read("properties")), &CheckSettings::default())
            .unwrap();
    assert!(findings.iter().all(|it| it.trace.is_some()), "{findings:?}");
    judgements.into_iter().map(|it| (it.name, it.outcome)).collect()
}

/// The clauses of a step that needs too many say nothing: the property is undecided.
#[test]
fn a_property_with_too_many_obligations_is_not_violated() {
    let role = "Role: r\nLiveness:\nr = A . [Z] . A~\nTransitions:\nCONDITION -> Z : [false]\n";
    assert_eq!(outcome(role, "not (in Z)"), PropertyOutcome::Holds);
    let each =
        |number: usize| format!("((eventually [Ball.x > {number}]) until (eventually [Ball.y > {number}]))");
    let all: Vec<String> = (0..10).map(each).collect();
    let formula = format!("not ({} and in Z)", all.join(" and "));
    let (_, judgements, findings) = judged(role, &formula, &CheckSettings::default());
    assert_eq!(judgements[0].outcome, PropertyOutcome::NotDecided, "{findings:?}");
}

#[test]
fn the_shipped_roles_have_their_properties() {
    for role in ["goalie", "attacker"] {
        let judged = shipped(role, ("", ""));
        assert!(
            judged.len() >= 4 && judged.iter().all(|(_, outcome)| *outcome == PropertyOutcome::Holds),
            "{judged:?}"
        );
    }
}

#[test]
fn a_mistake_in_a_shipped_role_is_noticed() {
    let broken = |role, change| -> Vec<String> {
        let violated = shipped(role, change).into_iter().filter(|(_, it)| *it == PropertyOutcome::Violated);
        violated.map(|(name, _)| name).collect()
    };
    let side = (
        "RightDive : [Ball.crossing_bearing < -dive_from]",
        "RightDive : [Ball.crossing_bearing > -dive_from]",
    );
    // a ball far to the right enables no exit now, and may have turned back when the next message
    // arrives
    let both = ["no dive for a ball that stays away", "it dives to the side of the ball"];
    assert_eq!(broken("goalie", side), both);
    let slow = ("StartTimeout(robot_timeout, 100ms)", "StartTimeout(robot_timeout, 150ms)");
    assert_eq!(broken("goalie", slow), ["the body is served ten times a second"]);
    let far = ("kickBall : [Ball.distance <= near", "kickBall : [Ball.distance > near");
    let followed = ["it kicks only what lies near", "a look at the ball is followed by a deed"];
    assert_eq!(broken("attacker", far), followed);
}
