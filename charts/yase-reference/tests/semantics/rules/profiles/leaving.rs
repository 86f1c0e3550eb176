//! Leaving states with running activities, ancestors as targets, JOINs and timers.

use yase::{Semantics, TimerScope};

use crate::rules::check_with;

#[test]
fn r09_running_activities_are_interrupted_and_their_return_ignored() {
    check_with(
        Semantics::uml(),
        "
        START
        A | run | for=20ms
        B
        c/START -> A
        A -> B : e
        ",
        "5 e; 50",
        "
        0.000 s start; then START -> A; enter c, A
        start A
        cancel A
        0.005 s e: A -> B; exit A; enter B
        A returns Done
        ",
    );
}

#[test]
fn r09_a_state_that_is_entered_again_runs_its_activity_anew() {
    check_with(
        Semantics::scxml(),
        "
        START
        A | run | for=20ms
        c/START -> A
        A -> A : e
        ",
        "5 e; 50",
        "
        0.000 s start; then START -> A; enter c, A
        start A
        cancel A
        0.005 s e: A -> A; exit A; enter A
        start A
        A returns Done
        A returns Done
        ",
    );
}

#[test]
fn r14_an_active_ancestor_as_target_only_completes() {
    check_with(
        Semantics::uml(),
        "
        START
        P | exit=raise(x) | entry=raise(n)
          START
          Q | exit=raise(xq)
            START
            A | exit=raise(xa)
        C
        c/START -> P
        P/START -> Q
        Q/START -> A
        A -> P : e / raise(t)
        P -> C : / raise(done)
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> P + P/START -> P/Q + P/Q/START -> P/Q/A; do raise(n) (entry P); enter c, P, P/Q, P/Q/A
        0.000 s n: dropped
        0.001 s e: P/Q/A -> P; exit P/Q/A, P/Q; do raise(xa) (exit P/Q/A), raise(xq) (exit P/Q), raise(t) (P/Q/A -> P)
        0.001 s -: P -> C; exit P; do raise(x) (exit P), raise(done) (P -> C); enter C
        0.001 s xa: dropped
        0.001 s xq: dropped
        0.001 s t: dropped
        0.001 s x: dropped
        0.001 s done: dropped
        ",
    );
}

#[test]
fn r14_an_active_ancestor_is_left_and_entered_again() {
    check_with(
        Semantics::scxml(),
        "
        START
        P | exit=raise(x) | entry=raise(n)
          START
          A
        c/START -> P
        P/START -> A
        A -> P : e
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> P + P/START -> P/A; do raise(n) (entry P); enter c, P, P/A
        0.000 s n: dropped
        0.001 s e: P/A -> P; exit P/A, P; then P/START -> P/A; do raise(x) (exit P), raise(n) (entry P); enter P, P/A
        0.001 s x: dropped
        0.001 s n: dropped
        ",
    );
}

#[test]
fn r14_an_and_as_active_ancestor_completes_when_its_last_region_does() {
    check_with(
        Semantics::uml(),
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
        c/START -> both
        one/START -> A
        two/START -> B
        A -> both : e
        B -> both : f
        both -> C
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; then START -> both + both/one/START -> both/one/A + both/two/START -> both/two/B; enter c, both, both/one, both/one/A, both/two, both/two/B
        0.001 s e: both/one/A -> both; exit both/one/A
        0.002 s f: both/two/B -> both; exit both/two/B
        0.002 s -: both -> C; exit both/one, both/two, both; enter C
        ",
    );
}

#[test]
fn r14_a_vacated_region_still_takes_events_of_its_own() {
    check_with(
        Semantics::uml(),
        "
        START
        P
          START
          A
          B
        C
        c/START -> P
        P/START -> A
        A -> P : e
        P -> B {internal} : f
        P -> C : g
        ",
        "1 e; 2 f; 3 g; 4",
        "
        0.000 s start; then START -> P + P/START -> P/A; enter c, P, P/A
        0.001 s e: P/A -> P; exit P/A
        0.002 s f: P -> P/B; enter P/B
        0.003 s g: P -> C; exit P/B, P; enter C
        ",
    );
}

#[test]
fn r12_join_each_vacates_regions_until_all_have_arrived() {
    check_with(
        Semantics::uml(),
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
        A -> j : / raise(x)
        B -> j : / raise(y)
        j -> done : / raise(z)
        ",
        "40",
        "
        0.000 s start; then START -> both + both/one/START -> both/one/A + both/two/START -> both/two/B; enter c, both, both/one, both/one/A, both/two, both/two/B
        0.000 s -: both/two/B -> j; exit both/two/B; do raise(y) (both/two/B -> j)
        0.000 s y: dropped
        start A
        A returns Done
        0.020 s -: both/one/A -> j -> done; exit both/one/A, both/one, both/two, both; do raise(x) (both/one/A -> j), raise(z) (j -> done); enter done
        0.020 s x: dropped
        0.020 s z: dropped
        ",
    );
}

#[test]
fn r12_join_each_forgets_arrivals_when_the_and_is_left() {
    check_with(
        Semantics::uml(),
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
        other
        c/START -> both
        one/START -> A
        two/START -> B
        A -> j
        B -> j
        j -> done
        both -> other : e
        other -> both : f
        ",
        "1 e; 2 f; 40",
        "
        0.000 s start; then START -> both + both/one/START -> both/one/A + both/two/START -> both/two/B; enter c, both, both/one, both/one/A, both/two, both/two/B
        0.000 s -: both/two/B -> j; exit both/two/B
        start A
        cancel A
        0.001 s e: both -> other; exit both/one/A, both/one, both/two, both; enter other
        A returns Done
        0.002 s f: other -> both; exit other; then both/one/START -> both/one/A + both/two/START -> both/two/B; enter both, both/one, both/one/A, both/two, both/two/B
        0.002 s -: both/two/B -> j; exit both/two/B
        start A
        A returns Done
        0.022 s -: both/one/A -> j -> done; exit both/one/A, both/one, both/two, both; enter done
        ",
    );
}

#[test]
fn r21_timers_of_a_state_end_with_it() {
    let mut semantics = Semantics::yase();
    semantics.timers = TimerScope::State;
    check_with(
        semantics,
        "
        START
        A | entry=StartTimeout(v, 5ms)
        B
        C
        c/START -> A
        A -> B : e
        B -> A : f
        A -> C : v
        B -> C : v
        ",
        "1 e; 20",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; do StartTimeout(v, 5ms) (entry A); enter A
        0.001 s e: A -> B; exit A; enter B
        ",
    );
}

#[test]
fn r21_a_timer_of_a_transition_belongs_to_its_target_and_survives_others() {
    let mut semantics = Semantics::yase();
    semantics.timers = TimerScope::State;
    check_with(
        semantics,
        "
        START
        P
          START
          A
          B
        C
        c/START -> P : / StartTimeout(v, 5ms)
        P/START -> A
        A -> B : e
        P -> C : v
        ",
        "1 e; 2 f; 20",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; do StartTimeout(v, 5ms) (START -> P); enter P, P/START
        0.000 s -: P/START -> P/A; exit P/START; enter P/A
        0.001 s e: P/A -> P/B; exit P/A; enter P/B
        0.002 s ?: dropped
        0.005 s v: P -> C; exit P/B, P; enter C
        ",
    );
}

#[test]
fn r21_a_timer_behind_a_choice_belongs_to_what_is_chosen() {
    let mut semantics = Semantics::yase();
    semantics.timers = TimerScope::State;
    check_with(
        semantics,
        "
        START
        A
        ! ch
        B
        C
        D
        c/START -> A
        A -> ch : e / StartTimeout(v, 5ms)
        ch -> B
        B -> C : f
        C -> D : v
        c/START -> D : [v && !v]
        ",
        "1 e; 2 f; 20",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> ch; exit A; then ch -> B; do StartTimeout(v, 5ms) (A -> ch); enter B
        0.002 s f: B -> C; exit B; enter C
        ",
    );
}

#[test]
fn r21_timers_of_the_chart_survive_their_state() {
    check_with(
        Semantics::yase(),
        "
        START
        A | entry=StartTimeout(v, 5ms)
        B
        C
        c/START -> A
        A -> B : e
        B -> C : v
        ",
        "1 e; 20",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; do StartTimeout(v, 5ms) (entry A); enter A
        0.001 s e: A -> B; exit A; enter B
        0.005 s v: B -> C; exit B; enter C
        ",
    );
}

#[test]
fn r21_a_timer_of_a_way_behind_a_choice_belongs_to_where_that_leads() {
    let mut semantics = Semantics::yase();
    semantics.timers = TimerScope::State;
    let chart = "
        START
        A
        ! k
        P
          START
          B
          H h
        D
        X
        c/START -> A
        P/START -> B
        A -> k : e / StartTimeout(v, 5ms)
        k -> h : [A.n == 1]
        k -> D
        D -> X : f
        P -> X : f
        X -> X {internal} : v
        ";
    check_with(
        semantics,
        chart,
        "1 e; 2 f; 20",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> k; exit A; then k -> D; do StartTimeout(v, 5ms) (A -> k); enter D
        0.002 s f: D -> X; exit D; enter X
        ",
    );
    check_with(
        semantics,
        chart,
        "1 A=1; 2 e; 3 f; 20",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.002 s e: A -> k; exit A; then k -> P/h; do StartTimeout(v, 5ms) (A -> k); enter P, P/START
        0.002 s -: P/START -> P/B; exit P/START; enter P/B
        0.003 s f: P -> X; exit P/B, P; enter X
        ",
    );
}
