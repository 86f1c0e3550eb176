//! R14 to R17: completion, transitions without an event, queues, charts that never rest.

use std::num::NonZeroU32;
use std::time::Duration;

use yase::{CompletionTrigger, Deferral, Machine, MachineErrorKind, Semantics, Status, Timestamp};

use crate::rules::{check, check_with, compare};
use yase_reference::test_host::TestHost;
use yase_reference::{chart, script};

#[test]
fn r14_a_basic_state_completes_when_its_activity_is_done() {
    check(
        "
        START
        A | run | for=20ms
        B
        failing | run
        c/START -> A
        A -> B
        B -> failing
        failing -> A
        failing -> failing {internal} : error.activity
        ",
        "100",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        start A
        A returns Done
        0.020 s -: A -> B; exit A; enter B
        0.020 s -: B -> failing; exit B; enter failing
        start failing
        failing returns Failed
        0.020 s error.activity: failing -> failing
        ",
    );
}

#[test]
fn r14_an_or_completes_at_end_and_an_and_when_all_its_regions_have() {
    check(
        "
        START
        P
          START
          A
          END
        & both
          one
            START
            B
            END
          two
            START
            C
            END
        X
        c/START -> P
        P/START -> A
        A -> P/END : e
        P -> both
        one/START -> B
        B -> one/END : e
        two/START -> C
        C -> two/END : f
        both -> X
        ",
        "1 e; 2 e; 3 f; 4",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/A; exit P/START; enter P/A
        0.001 s e: P/A -> P/END; exit P/A; enter P/END
        0.001 s -: P -> both; exit P/END, P; enter both, both/one, both/one/START, both/two, both/two/START
        0.001 s -: both/one/START -> both/one/B, both/two/START -> both/two/C; exit both/one/START, both/two/START; enter both/one/B, both/two/C
        0.002 s e: both/one/B -> both/one/END; exit both/one/B; enter both/one/END
        0.003 s f: both/two/C -> both/two/END; exit both/two/C; enter both/two/END
        0.003 s -: both -> X; exit both/one/END, both/one, both/two/END, both/two, both; enter X
        ",
    );
}

/// A composite that is left without an event, in one way or another.
fn composite(exit: &str) -> String {
    format!(
        "
        START
        P
          START
          A
          B
          END
        X
        c/START -> P
        P/START -> A
        A -> B : [B.n > 0]
        B -> P/END : e
        {exit}
        "
    )
}

const INSIDE: &str = "
    0.000 s start; enter c, START
    0.000 s -: START -> P; exit START; enter P, P/START
    0.000 s -: P/START -> P/A; exit P/START; enter P/A
";

#[test]
fn r15_an_unguarded_exit_of_a_composite_waits_for_its_completion() {
    check(
        &composite("P -> X"),
        "1 B=1; 2 e; 3",
        &format!(
            "{INSIDE}
            0.001 s -: P/A -> P/B; exit P/A; enter P/B
            0.002 s e: P/B -> P/END; exit P/B; enter P/END
            0.002 s -: P -> X; exit P/END, P; enter X"
        ),
    );
}

#[test]
fn r15_a_guarded_transition_to_itself_waits_for_completion_too() {
    check(
        &composite("P -> P : [A.n > 0]"),
        "1 A=1; 2 B=1; 3 e; 4",
        &format!(
            "{INSIDE}
            0.002 s -: P/A -> P/B; exit P/A; enter P/B
            0.003 s e: P/B -> P/END; exit P/B; enter P/END
            0.003 s -: P -> P; exit P/END, P; enter P, P/START
            0.003 s -: P/START -> P/A; exit P/START; enter P/A
            0.003 s -: P/A -> P/B; exit P/A; enter P/B"
        ),
    );
}

#[test]
fn r15_a_guarded_exit_of_a_composite_waits_until_nothing_inside_can_step() {
    check(
        &composite("P -> X : [A.n > 0]"),
        "1 A=1; 2",
        &format!("{INSIDE}0.001 s -: P -> X; exit P/A, P; enter X"),
    );
    // with both guards open the inner step comes first
    check(
        &composite("P -> X : [B.n > 0]"),
        "1 B=1; 2",
        &format!(
            "{INSIDE}
            0.001 s -: P/A -> P/B; exit P/A; enter P/B
            0.001 s -: P -> X; exit P/B, P; enter X"
        ),
    );
}

#[test]
fn r15_a_guarded_exit_of_an_and_waits_for_a_step_of_any_region() {
    check(
        "
        START
        & both
          one
            START
            A
          two
            START
            B
            C
        X
        c/START -> both
        one/START -> A
        two/START -> B
        B -> C : [A.n > 0]
        both -> X : [A.n > 0]
        ",
        "1 A=1; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        0.001 s -: both/two/B -> both/two/C; exit both/two/B; enter both/two/C
        0.001 s -: both -> X; exit both/one/A, both/one, both/two/C, both/two, both; enter X
        ",
    );
}

#[test]
fn r15_guardedness_is_that_of_the_first_segment() {
    let exit = "P -> c1\nc1 -> X : [A.n > 0]\nc1 -> X";
    check(
        &composite(&exit.replace('\n', "\n        ")).replace("\n        X\n", "\n        X\n        ? c1\n"),
        "1 A=1; 2",
        INSIDE,
    );
}

#[test]
fn r15_under_quiescent_completion_does_not_matter() {
    let mut semantics = Semantics::yase();
    semantics.eventless = CompletionTrigger::Quiescent;
    check_with(
        semantics,
        &composite("P -> X : [true]"),
        "1",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/A; exit P/START; enter P/A
        0.000 s -: P -> X; exit P/A, P; enter X
        ",
    );
    check_with(
        semantics,
        &composite("P -> X"),
        "1",
        &format!("{INSIDE}0.000 s -: P -> X; exit P/A, P; enter X"),
    );
}

#[test]
fn r15_the_guard_of_a_completed_state_is_looked_at_again() {
    check(
        "
        START
        A | run
        B
        c/START -> A
        A -> B : [A.n > 0]
        ",
        "5 A=0; 6 A=1; 7",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        start A
        A returns Done
        0.006 s -: A -> B; exit A; enter B
        ",
    );
}

#[test]
fn r16_eventless_transitions_come_before_raised_events_and_those_before_arrived_ones() {
    check(
        "
        START
        A
        B
        C
        D
        c/START -> A
        A -> B : e / raise(r)
        B -> C
        C -> D : r
        C -> A : f
        D -> A : f
        ",
        "1 e; 1 f; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> B; exit A; do raise(r) (A -> B); enter B
        0.001 s -: B -> C; exit B; enter C
        0.001 s r: C -> D; exit C; enter D
        0.001 s f: D -> A; exit D; enter A
        ",
    );
}

#[test]
fn r16_an_event_that_matches_nothing_is_dropped() {
    check(
        "
        START
        A
        B
        c/START -> A
        A -> B : f
        B -> A : e
        ",
        "1 e; 1 f; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: dropped
        0.001 s f: A -> B; exit A; enter B
        ",
    );
}

const DEFERRING: &str = "
    START
    P | defer=e
      START
      A
      B
    Q
    c/START -> P
    P/START -> A
    A -> B : f
    A -> Q : g
    Q -> P : e
    B -> B {internal} : e
";

#[test]
fn r16_a_deferred_event_waits_until_no_active_state_defers_it_and_comes_before_newer_ones() {
    check(
        DEFERRING,
        "1 e; 2 g; 2 h; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/A; exit P/START; enter P/A
        0.001 s e: nothing; defer in P
        0.002 s g: P/A -> Q; exit P/A, P; enter Q
        0.002 s e: Q -> P; exit Q; enter P, P/START
        0.002 s -: P/START -> P/A; exit P/START; enter P/A
        0.002 s ?: dropped
        ",
    );
}

#[test]
fn r16_what_is_taken_is_not_deferred_and_deferral_can_be_off() {
    let log = script::play(&chart(DEFERRING), "1 f; 2 e; 3");
    assert_eq!(log.last().unwrap(), "0.002 s e: P/B -> P/B");
    let mut semantics = Semantics::yase();
    semantics.deferral = Deferral::Off;
    let log = script::play_with(&chart(DEFERRING), "1 e; 2 g; 3", semantics);
    compare(&log[3..], "0.001 s e: dropped\n0.002 s g: P/A -> Q; exit P/A, P; enter Q");
}

fn limited(limit: u32) -> Semantics {
    let mut semantics = Semantics::yase();
    semantics.limit = NonZeroU32::new(limit).unwrap();
    semantics
}

#[test]
fn r17_a_chart_that_never_rests_stops_with_an_error_that_names_the_cycle() {
    let chart = chart("START\nS\nA\nB\nc/START -> S\nS -> A : e\nA -> B\nB -> A : [true]\n");
    let mut machine = Machine::new(script::compile_with(&chart, limited(10)));
    let mut host = TestHost::new(&chart);
    machine.start(Timestamp::ZERO, &mut host);
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    machine.dispatch_name("e");
    let error = machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap_err();
    assert_eq!(error.kind(), MachineErrorKind::NeverRests);
    let text = error.to_string();
    assert!(text.starts_with("the chart does not come to rest in 10 micro-steps: it repeats"), "{text}");
    assert!(text.contains("`A` -> `B`") && text.contains("`B` -> `A`"), "{text}");
    assert_eq!(machine.status(), Status::Stopped);
    assert_eq!(host.log.iter().filter(|line| line.contains("exit")).count(), 11, "START and ten more");
    // the configuration before the micro-step that would have been one too many
    assert!(machine.is_active(chart::find(&chart, "B")), "{:?}", machine.configuration());
    assert_eq!(machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap().micro_steps, 0);
}

#[test]
fn r17_exactly_as_many_micro_steps_as_allowed_are_no_error() {
    let mut text = String::from("START\nn0\nc/START -> n0\n");
    for number in 1..10 {
        text += &format!("n{number}\nn{} -> n{number}\n", number - 1);
    }
    assert!(!script::play_with(&chart(&text), "1", limited(10)).iter().any(|line| line.starts_with("error")));
    assert!(script::play_with(&chart(&text), "1", limited(9)).iter().any(|line| line.starts_with("error")));
}

#[test]
fn r17_raised_events_can_be_a_cycle() {
    let text = "START\nA\nc/START -> A\nA -> A {internal} : e / raise(e)\n";
    let log = script::play_with(&chart(text), "1 e; 2", limited(10));
    assert_eq!(
        log.last().unwrap(),
        "error: the chart does not come to rest in 10 micro-steps: it repeats `A` -> `A`"
    );
}

#[test]
fn r17_a_chart_that_answers_each_message_with_two_is_stopped_before_they_fill_the_world() {
    let text = "START\nA\nc/START -> A\nA -> A {internal} : B / B.n = 1, publish_all, B.n = 2, publish_all\n";
    let log = script::play_with(&chart(text), "1 B=1; 2", limited(10));
    assert!(log.last().unwrap().starts_with("error: the chart does not come to rest"), "{log:#?}");
    assert!(log.len() < 30);
}

#[test]
fn r17_a_chart_that_steps_for_ever_at_one_moment_is_stopped() {
    let log = script::play_with(&chart("START\nA | run\nc/START -> A\nA -> A\n"), "1", limited(10));
    assert_eq!(
        log.last().unwrap(),
        "error: the chart makes more than 10 steps at one moment: it repeats `A` -> `A`"
    );
    // time that passes makes it a loop like any other
    let log =
        script::play_with(&chart("START\nA | run | for=1ms\nc/START -> A\nA -> A\n"), "50", limited(10));
    assert!(!log.iter().any(|line| line.starts_with("error")));
}

#[test]
fn r17_steps_at_one_moment_are_counted_whoever_looks_on_and_anew_when_time_passes_or_the_chart_starts() {
    let chart = chart("START\nA\nB\nc/START -> A\nA -> B : e\nB -> A : e\n");
    for silent in [false, true] {
        let mut host = TestHost { silent, ..TestHost::new(&chart) };
        let mut machine = Machine::new(script::compile_with(&chart, limited(3)));
        let mut steps = |machine: &mut Machine, now: Timestamp, count: usize| {
            for _ in 0..count {
                machine.dispatch_name("e");
                let summary = machine.run_to_completion(now, &mut host)?;
                assert_eq!((summary.micro_steps, summary.transitions), (1, 1));
            }
            Ok::<(), yase::MachineError>(())
        };
        for start in [Timestamp::ZERO, Timestamp::from_millis(1)] {
            machine.start(start, &mut TestHost::new(&chart));
            machine.run_to_completion(start, &mut TestHost::new(&chart)).unwrap();
            steps(&mut machine, start, 2).unwrap();
            steps(&mut machine, start + Duration::from_millis(1), 3).unwrap();
            let error = steps(&mut machine, start + Duration::from_millis(1), 1).unwrap_err();
            assert_eq!(error.kind(), MachineErrorKind::NeverAdvances);
            assert_eq!(machine.status(), Status::Stopped);
        }
    }
}

#[test]
fn r17_a_step_may_offer_as_many_events_as_it_may_have_micro_steps() {
    let chart = chart("START\nA\nB\nc/START -> A\nA -> B : e\nB -> A : e\n");
    for silent in [false, true] {
        for (events, limit) in [(4, 4), (5, 4)] {
            let mut host = TestHost { silent, ..TestHost::new(&chart) };
            let mut machine = Machine::new(script::compile_with(&chart, limited(limit)));
            machine.start(Timestamp::ZERO, &mut host);
            machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
            (0..events).for_each(|_| machine.dispatch(chart_event(&machine)));
            let found = machine.run_to_completion(Timestamp::from_millis(1), &mut host);
            match found {
                Ok(summary) => assert_eq!((events, summary.transitions), (4, 4)),
                Err(error) => assert_eq!((events, error.kind()), (5, MachineErrorKind::NeverRests)),
            }
        }
    }
}

fn chart_event(machine: &Machine) -> yase::expression::EventId {
    machine.chart().events().find("e").unwrap()
}
