//! Which events come when, when completion counts, and who sees what is written.

use yase::{CompletionTrigger, Semantics};

use crate::rules::check_with;

#[test]
fn r16_pool_one_puts_raised_events_behind_arrived_ones() {
    check_with(
        Semantics::uml(),
        "
        START
        A
        c/START -> A
        A -> A {internal} : e / raise(g)
        A -> A {internal} : f
        A -> A {internal} : g
        ",
        "1 e; 1 f; 2",
        "
        0.000 s start; then START -> A; enter c, A
        0.001 s e: A -> A; do raise(g) (A -> A)
        0.001 s f: A -> A
        0.001 s g: A -> A
        ",
    );
}

#[test]
fn r15_eventless_once_looks_at_a_completion_once() {
    check_with(
        Semantics::uml(),
        "
        START
        P
          START
          A
          B
          END
        C
        c/START -> P
        P/START -> A
        A -> B : [A.n == 1]
        A -> P/END : e
        P -> C : [A.n == 2]
        ",
        "1 A=1; 2 e; 3",
        "
        0.000 s start; then START -> P + P/START -> P/A; enter c, P, P/A
        0.002 s e: P/A -> P/END; exit P/A; enter P/END
        ",
    );
}

#[test]
fn r15_eventless_once_offers_completions_before_events_and_of_ands_when_all_is_complete() {
    check_with(
        Semantics::uml(),
        "
        START
        & both
          one
            START
            A | run | for=20ms
            END
          two
            START
            B
            END
          D
        C
        c/START -> both
        one/START -> A
        A -> one/END
        two/START -> B
        B -> two/END : e
        both -> C : / raise(done)
        ",
        "1 e; 1 f; 40",
        "
        0.000 s start; then START -> both + both/one/START -> both/one/A + both/two/START -> both/two/B; enter c, both, both/one, both/one/A, both/two, both/two/B, both/D
        start A
        0.001 s e: both/two/B -> both/two/END; exit both/two/B; enter both/two/END
        0.001 s ?: dropped
        A returns Done
        0.020 s -: both/one/A -> both/one/END; exit both/one/A; enter both/one/END
        0.020 s -: both -> C; exit both/one/END, both/one, both/two/END, both/two, both/D, both; do raise(done) (both -> C); enter C
        0.020 s done: dropped
        ",
    );
}

#[test]
fn r15_eventless_always_does_not_wait_for_activities() {
    check_with(
        Semantics::scxml(),
        "
        START
        P | entry=A.n = 1
          START
          A | run | for=20ms
        B
        c/START -> P
        P/START -> A
        P -> B : [A.n == 1]
        ",
        "50",
        "
        0.000 s start; then START -> P + P/START -> P/A; do A.n = 1 (entry P); enter c, P, P/A
        0.000 s -: P -> B; exit P/A, P; enter B
        ",
    );
}

#[test]
fn r19_what_is_written_is_seen_at_once_by_other_regions() {
    check_with(
        Semantics::scxml(),
        "
        START
        & both
          one
            START
            A
            B
          two
            START
            C
            D
        c/START -> both
        one/START -> A
        two/START -> C
        A -> B : e / A.n = 3; raise(g)
        C -> D : g [A.n == 3]
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> both + both/one/START -> both/one/A + both/two/START -> both/two/C; enter c, both, both/one, both/one/A, both/two, both/two/C
        0.001 s e: both/one/A -> both/one/B; exit both/one/A; do A.n = 3, raise(g) (both/one/A -> both/one/B); enter both/one/B
        0.001 s g: both/two/C -> both/two/D; exit both/two/C; enter both/two/D
        ",
    );
}

#[test]
fn r19_what_is_written_is_seen_by_other_regions_in_the_next_step() {
    check_with(
        Semantics::yase(),
        "
        START
        & both
          one
            START
            A
            B
          two
            START
            C
            D
        c/START -> both
        one/START -> A
        two/START -> C
        A -> B : e / A.n = 3; raise(g)
        C -> D : g [A.n == 3]
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/C; exit both/one/START, both/two/START; enter both/one/A, both/two/C
        0.001 s e: both/one/A -> both/one/B; exit both/one/A; do A.n = 3, raise(g) (both/one/A -> both/one/B); enter both/one/B
        0.001 s g: dropped
        0.002 s ?: dropped
        ",
    );
}

#[test]
fn r14_completions_are_events() {
    check_with(
        Semantics::scxml(),
        "
        START
        & both
          one
            START
            A
            END a
            END b
          two
            START
            B
            END
        C
        c/START -> both
        one/START -> A
        two/START -> B
        A -> b : e
        B -> two/END : f
        both -> C : done.state.both
        both/one -> both/one {internal} : done.state / raise(seen)
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; then START -> both + both/one/START -> both/one/A + both/two/START -> both/two/B; enter c, both, both/one, both/one/A, both/two, both/two/B
        0.001 s e: both/one/A -> both/one/b; exit both/one/A; enter both/one/b
        0.001 s done.state.one: both/one -> both/one; do raise(seen) (both/one -> both/one)
        0.001 s seen: dropped
        0.002 s f: both/two/B -> both/two/END; exit both/two/B; enter both/two/END
        0.002 s done.state.two: both/one -> both/one; do raise(seen) (both/one -> both/one)
        0.002 s done.state.both: both/one -> both/one, both -> C; exit both/two/END, both/two, both/one/b, both/one, both; do raise(seen) (both/one -> both/one); enter C
        0.002 s seen: dropped
        0.002 s seen: dropped
        ",
    );
}

#[test]
fn r16_deferral_off_drops_events() {
    check_with(
        Semantics::scxml(),
        "
        START
        A | defer=e
        B
        C
        c/START -> A
        A -> B : f
        B -> C : e
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; then START -> A; enter c, A
        0.001 s e: dropped
        0.002 s f: A -> B; exit A; enter B
        ",
    );
}

#[test]
fn r16_deferral_on_offers_events_again() {
    check_with(
        Semantics::yase(),
        "
        START
        A | defer=e
        B
        C
        c/START -> A
        A -> B : f
        B -> C : e
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: nothing; defer in A
        0.002 s f: A -> B; exit A; enter B
        0.002 s e: B -> C; exit B; enter C
        ",
    );
}

#[test]
fn r15_eventless_quiescent_and_join_together_wait_for_completion() {
    let mut semantics = Semantics::yase();
    semantics.eventless = CompletionTrigger::Quiescent;
    check_with(
        semantics,
        "
        START
        & both
          one
            START
            A | run | for=20ms
          two
            START
            B
        > j
        done
        c/START -> both
        one/START -> A
        two/START -> B
        A -> j
        B -> j
        j -> done
        ",
        "40",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        start A
        A returns Done
        0.020 s -: both/one/A -> j + both/two/B -> j -> done; exit both/one/A, both/one, both/two/B, both/two, both; enter done
        ",
    );
}
