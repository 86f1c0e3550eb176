//! R9: running activities lock, hold and are interrupted.

use yase::CompletionTrigger;

use crate::rules::{check, check_with, with};

#[test]
fn r09_a_region_that_runs_an_activity_contributes_nothing() {
    check(
        "
        START
        outer
          START
          A | run | for=20ms
        X
        c/START -> outer
        outer/START -> A
        outer -> outer {internal} : e / raise(done)
        A -> X : f
        ",
        "10 e; 30",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> outer; exit START; enter outer, outer/START
        0.000 s -: outer/START -> outer/A; exit outer/START; enter outer/A
        start A
        0.010 s e: nothing; hold outer -> outer
        A returns Done
        0.020 s e: outer -> outer; do raise(done) (outer -> outer)
        0.020 s done: dropped
        ",
    );
}

const NESTED: &str = "
    START
    & both
      one
        START
        A | run | for=20ms
      two
        START
        & inner
          three
            START
            B | run | for=40ms
            C
          four
            START
            D
            E
    X
    c/START -> both
    one/START -> A
    two/START -> inner
    three/START -> B
    four/START -> D
";

const ENTERED: &str = "
    0.000 s start; enter c, START
    0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
    0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/inner; exit both/one/START, both/two/START; enter both/one/A, both/two/inner, both/two/inner/three, both/two/inner/three/START, both/two/inner/four, both/two/inner/four/START
    0.000 s -: both/two/inner/three/START -> both/two/inner/three/B, both/two/inner/four/START -> both/two/inner/four/D; exit both/two/inner/three/START, both/two/inner/four/START; enter both/two/inner/three/B, both/two/inner/four/D
    start A
    start B
";

const LEAVE: &str = "exit both/one/A, both/one, both/two/inner/three/B, both/two/inner/three, both/two/inner/four/D, \
                     both/two/inner/four, both/two/inner, both/two, both; enter X";

#[test]
fn r09_nested_regions_are_judged_each_by_itself() {
    check(
        &format!("{NESTED}    D -> E : e\n    inner -> inner {{internal}} : f"),
        "10 e; 11 f; 15",
        &format!(
            "{ENTERED}
            0.010 s e: both/two/inner/four/D -> both/two/inner/four/E; exit both/two/inner/four/D; enter both/two/inner/four/E
            0.011 s f: both/two/inner -> both/two/inner"
        ),
    );
}

#[test]
fn r09_a_composite_is_not_left_while_an_activity_runs_at_any_depth() {
    check(
        &format!("{NESTED}    both -> X : e"),
        "10 e; 60",
        &format!(
            "{ENTERED}
            0.010 s e: nothing; hold both -> X
            A returns Done
            0.020 s e: nothing; hold both -> X
            B returns Done
            0.040 s e: both -> X; {LEAVE}"
        ),
    );
}

#[test]
fn r09_without_an_event_too() {
    check(
        &format!("{NESTED}    both -> X : [A.n > 0]"),
        "10 A=1; 60",
        &format!(
            "{ENTERED}
            A returns Done
            B returns Done
            0.040 s -: both -> X; {LEAVE}"
        ),
    );
}

#[test]
fn r09_running_lasts_from_the_enqueueing_of_the_activity() {
    // the second event comes in the step that entered A: its activity has not been started yet
    check(
        "
        START
        S
        A | run | for=5ms
        X
        c/START -> S
        S -> A : e
        A -> X : f
        ",
        "1 e; 1 f; 10",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> S; exit START; enter S
        0.001 s e: S -> A; exit S; enter A
        0.001 s f: nothing; hold A -> X
        start A
        A returns Done
        0.006 s f: A -> X; exit A; enter X
        ",
    );
}

#[test]
fn r09_a_held_event_comes_before_newer_ones_and_before_the_eventless_transitions_of_what_it_leaves() {
    check(
        "
        START
        A | run | for=20ms
        B
        X
        Y
        c/START -> A
        A -> B
        A -> X : e
        A -> Y : f
        X -> X {internal} : f
        ",
        "10 e; 11 f; 30",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        start A
        0.010 s e: nothing; hold A -> X
        0.011 s f: nothing; hold A -> Y
        A returns Done
        0.020 s e: A -> X; exit A; enter X
        0.020 s f: X -> X
        ",
    );
}

#[test]
fn r09_what_a_held_event_would_leave_waits_for_it_in_all_regions() {
    // C's way on needs no event; it would start the next activity for ever, and the AND could never
    // be left
    check(
        "
        START
        & both
          one
            START
            A | run | for=30ms
          two
            START
            C | run | for=10ms
        X
        c/START -> both
        one/START -> A
        two/START -> C
        C -> C
        both -> X : e
        ",
        "15 e; 60",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/C; exit both/one/START, both/two/START; enter both/one/A, both/two/C
        start A
        start C
        C returns Done
        0.010 s -: both/two/C -> both/two/C; exit both/two/C; enter both/two/C
        start C
        0.015 s e: nothing; hold both -> X
        C returns Done
        0.020 s e: nothing; hold both -> X
        A returns Done
        0.030 s e: both -> X; exit both/one/A, both/one, both/two/C, both/two, both; enter X
        ",
    );
}

#[test]
fn r09_an_event_that_another_region_consumes_is_not_held() {
    check(
        &format!("{NESTED}    both -> X : e\n    D -> E : e"),
        "10 e; 60",
        &format!(
            "{ENTERED}
            0.010 s e: both/two/inner/four/D -> both/two/inner/four/E; exit both/two/inner/four/D; enter both/two/inner/four/E
            A returns Done
            B returns Done"
        ),
    );
}

#[test]
fn r09_a_held_event_is_offered_again_only_when_what_was_in_its_way_has_returned() {
    check(
        &format!("{NESTED}    B -> C : e\n    A -> A {{internal}} : other"),
        "10 e; 60",
        &format!(
            "{ENTERED}
            0.010 s e: nothing; hold both/two/inner/three/B -> both/two/inner/three/C
            A returns Done
            B returns Done
            0.040 s e: both/two/inner/three/B -> both/two/inner/three/C; exit both/two/inner/three/B; enter both/two/inner/three/C"
        ),
    );
}

#[test]
fn r09_a_held_event_that_fits_no_longer_is_dropped() {
    check(
        "
        START
        A | run | for=20ms
        B
        c/START -> A
        A -> B : e [A.n == 1]
        ",
        "0 A=1; 10 e; 15 A=2; 30",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        start A
        0.010 s e: nothing; hold A -> B
        A returns Done
        0.020 s e: dropped
        ",
    );
}

#[test]
fn r09_an_interrupting_transition_asks_activities_to_return_and_fires_when_they_have() {
    // B's activity ends by itself in the meantime: the way on from B does not come first
    check(
        "
        START
        & both
          one
            START
            A | run | for=50ms
          two
            START
            B | run | for=50ms
            C
        X
        c/START -> both
        one/START -> A
        two/START -> B
        B -> C
        both -> X {interrupts} : e
        ",
        "10 e; 60",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        start A
        start B
        cancel A
        cancel B
        0.010 s e: nothing; hold both -> X
        A returns Done
        B returns Done
        0.011 s e: both -> X; exit both/one/A, both/one, both/two/B, both/two, both; enter X
        ",
    );
}

#[test]
fn r09_an_interrupting_transition_needs_no_event() {
    // A's way back to itself would start its activity for ever; without the mark nothing inside may
    // run
    let chart = |mark: &str| {
        format!(
            "
            START
            & both
              one
                START
                A | run | for=30ms
              two
                START
                B
            X
            c/START -> both
            one/START -> A
            two/START -> B
            A -> A
            both -> X {mark} : [A.n > 0]
            "
        )
    };
    let enter = "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        start A";
    check(
        &chart("{interrupts}"),
        "10 A=1; 50",
        &format!(
            "{enter}
            cancel A
            0.010 s -: nothing; hold both -> X
            A returns Done
            0.011 s -: both -> X; exit both/one/A, both/one, both/two/B, both/two, both; enter X"
        ),
    );
    check(
        &chart(""),
        "10 A=1; 50",
        &format!(
            "{enter}
            A returns Done
            0.030 s -: both/one/A -> both/one/A; exit both/one/A; enter both/one/A
            start A"
        ),
    );
}

#[test]
fn r09_an_activity_that_is_interrupted_before_it_starts_is_asked_to_return_when_it_has() {
    check(
        "
        START
        S
        A | run | for=50ms
        X
        c/START -> S
        S -> A : e
        A -> X {interrupts} : f
        ",
        "1 e; 1 f; 10",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> S; exit START; enter S
        0.001 s e: S -> A; exit S; enter A
        0.001 s f: nothing; hold A -> X
        start A
        cancel A
        A returns Done
        0.002 s f: A -> X; exit A; enter X
        ",
    );
}

#[test]
fn r09_what_happens_to_an_interrupted_state_meanwhile_is_held() {
    check(
        "
        START
        A | run | for=50ms
        X
        Y
        c/START -> A
        A -> X {interrupts} : e
        A -> Y {interrupts} : f
        X -> Y : f
        ",
        "10 e; 10 f; 60",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        start A
        cancel A
        0.010 s e: nothing; hold A -> X
        0.010 s f: nothing; hold A -> Y
        A returns Done
        0.011 s e: A -> X; exit A; enter X
        0.011 s f: X -> Y; exit X; enter Y
        ",
    );
}

#[test]
fn r09_an_ongoing_activity_is_not_called_again_when_its_state_is_about_to_be_left() {
    check(
        "
        START
        & both
          one
            START
            A | run | for=50ms
          two
            START
            ongoing | run
        X
        c/START -> both
        one/START -> A
        two/START -> ongoing
        both -> X {interrupts} : e
        ",
        "9 e; 60",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/ongoing; exit both/one/START, both/two/START; enter both/one/A, both/two/ongoing
        start A
        start ongoing
        ongoing returns Ongoing
        cancel A
        0.009 s e: nothing; hold both -> X
        A returns Done
        stop ongoing
        0.010 s e: both -> X; exit both/one/A, both/one, both/two/ongoing, both/two, both; enter X
        ",
    );
}

#[test]
fn r15_what_interrupts_but_asks_nothing_waits_under_quiescent() {
    let text = "
        START
        P
          START
          S | run | for=20ms
        X
        c/START -> P
        P/START -> S
        P -> X {interrupts}
    ";
    check_with(
        with(|it| it.eventless = CompletionTrigger::Quiescent),
        text,
        "10; 30",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/S; exit P/START; enter P/S
        start S
        S returns Done
        0.020 s -: P -> X; exit P/S, P; enter X
        ",
    );
}
