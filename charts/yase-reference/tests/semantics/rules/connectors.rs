//! R9, R12, R13: connectors that split, join and decide late.

use yase::Semantics;

use crate::rules::check_with;

#[test]
fn r12_a_fork_enters_the_and_once_and_regions_without_a_target_by_their_start() {
    check_with(
        Semantics::yase(),
        "
        START
        idle
        & both | entry=raise(n)
          one
            START
            A
            B
          two
            START
            & inner
              three
                START
                C
              four
                START
                E
                F
            G
        < f
        c/START -> idle
        one/START -> A
        two/START -> G
        three/START -> C
        four/START -> E
        idle -> f : e / raise(w)
        f -> B : / raise(x)
        f -> F : / raise(y)
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> idle; exit START; enter idle
        0.001 s e: idle -> f -> both/one/B + f -> both/two/inner/four/F; exit idle; do raise(w) (idle -> f), raise(x) (f -> both/one/B), raise(y) (f -> both/two/inner/four/F), raise(n) (entry both); enter both, both/one, both/one/B, both/two, both/two/inner, both/two/inner/three, both/two/inner/three/START, both/two/inner/four, both/two/inner/four/F
        0.001 s -: both/two/inner/three/START -> both/two/inner/three/C; exit both/two/inner/three/START; enter both/two/inner/three/C
        0.001 s w: dropped
        0.001 s x: dropped
        0.001 s y: dropped
        0.001 s n: dropped
        ",
    );
}

#[test]
fn r12_a_fork_may_lead_through_connectors_and_is_taken_as_a_whole_or_not_at_all() {
    check_with(
        Semantics::yase(),
        "
        START
        idle
        & both
          one
            START
            A
            B
          two
            START
            C
            D
        < f
        % j
        c/START -> idle
        one/START -> A
        two/START -> C
        idle -> f : e
        f -> B
        f -> j
        j -> D : [A.n > 0]
        ",
        "1 e; 2 A=1; 3 e; 4",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> idle; exit START; enter idle
        0.001 s e: dropped
        0.003 s e: idle -> f -> both/one/B + f -> j -> both/two/D; exit idle; enter both, both/one, both/one/B, both/two, both/two/D
        ",
    );
}

#[test]
fn r12_a_join_fires_as_one_transition_when_all_its_sources_have_completed() {
    check_with(
        Semantics::yase(),
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
        j -> done : [A.n > 0] / raise(z)
        ",
        "30 A=1; 40",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        start A
        A returns Done
        0.030 s -: both/one/A -> j + both/two/B -> j -> done; exit both/one/A, both/one, both/two/B, both/two, both; do raise(x) (both/one/A -> j), raise(y) (both/two/B -> j), raise(z) (j -> done); enter done
        0.030 s x: dropped
        0.030 s y: dropped
        0.030 s z: dropped
        ",
    );
}

#[test]
fn r09_a_running_activity_in_the_region_of_a_source_holds_a_join() {
    check_with(
        Semantics::yase(),
        "
        START
        & both
          one
            START
            P
              START
              A | run | for=20ms
              END
          two
            START
            B
            C | run | for=30ms
        > j
        done
        c/START -> both
        one/START -> P
        P/START -> A
        A -> P/END
        two/START -> B
        B -> C : e
        P -> j
        C -> j
        j -> done
        ",
        "10 e; 50",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/P, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/P, both/one/P/START, both/two/B
        0.000 s -: both/one/P/START -> both/one/P/A; exit both/one/P/START; enter both/one/P/A
        start A
        0.010 s e: both/two/B -> both/two/C; exit both/two/B; enter both/two/C
        start C
        A returns Done
        0.020 s -: both/one/P/A -> both/one/P/END; exit both/one/P/A; enter both/one/P/END
        C returns Done
        0.040 s -: both/one/P -> j + both/two/C -> j -> done; exit both/one/P/END, both/one/P, both/one, both/two/C, both/two, both; enter done
        ",
    );
}

#[test]
fn r12_a_join_of_states_deep_in_regions_leads_through_a_fork() {
    check_with(
        Semantics::yase(),
        "
        START
        & both
          one
            START
            P
              START
              A
              END
          two
            START
            B
        & again
          three
            START
            C
            D
          four
            START
            E
            F
        > j
        < f
        c/START -> both
        one/START -> P
        P/START -> A
        A -> P/END : e
        two/START -> B
        three/START -> C
        four/START -> E
        P -> j : / raise(x)
        B -> j
        j -> f : / raise(y)
        f -> D
        f -> F : / raise(z)
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/P, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/P, both/one/P/START, both/two/B
        0.000 s -: both/one/P/START -> both/one/P/A; exit both/one/P/START; enter both/one/P/A
        0.001 s e: both/one/P/A -> both/one/P/END; exit both/one/P/A; enter both/one/P/END
        0.001 s -: both/one/P -> j + both/two/B -> j -> f -> again/three/D + f -> again/four/F; exit both/one/P/END, both/one/P, both/one, both/two/B, both/two, both; do raise(x) (both/one/P -> j), raise(y) (j -> f), raise(z) (f -> again/four/F); enter again, again/three, again/three/D, again/four, again/four/F
        0.001 s x: dropped
        0.001 s y: dropped
        0.001 s z: dropped
        ",
    );
}

#[test]
fn r12_a_choice_reads_what_the_actions_before_it_have_written() {
    check_with(
        Semantics::yase(),
        "
        START
        A | exit=raise(x)
        ! ch
        ! ch2
        P
          START
          B
        C
        c/START -> A
        P/START -> B
        A -> ch : e / A.n = 5
        ch -> ch2 : [A.n > 3] / A.n = 7
        ch -> C
        ch2 -> B : [A.n == 7] / raise(y)
        ch2 -> C
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> ch; exit A; then ch -> ch2 -> P/B; do raise(x) (exit A), A.n = 5 (A -> ch), A.n = 7 (ch -> ch2), raise(y) (ch2 -> P/B); enter P, P/B
        0.001 s x: dropped
        0.001 s y: dropped
        ",
    );
}

#[test]
fn r12_the_scope_of_a_choice_holds_all_it_may_lead_to() {
    check_with(
        Semantics::yase(),
        "
        START
        P | exit=raise(left)
          START
          A
          B
        ! ch
        C
        c/START -> P
        P/START -> A
        A -> ch : e / A.n = 1
        ch -> B : [A.n == 1]
        ch -> C
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/A; exit P/START; enter P/A
        0.001 s e: P/A -> ch; exit P/A, P; then ch -> P/B; do raise(left) (exit P), A.n = 1 (P/A -> ch); enter P, P/B
        0.001 s left: dropped
        ",
    );
}

#[test]
fn r12_without_an_open_branch_a_choice_stops_the_chart_as_it_was_before() {
    check_with(
        Semantics::yase(),
        "
        START
        A | exit=raise(x)
        ! ch
        C
        c/START -> A
        A -> ch : e / A.n = 5
        ch -> C : [A.n > 6]
        A -> C : f
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        error: no outgoing transition of CHOICE `ch` is enabled
        ",
    );
}

#[test]
fn r12_a_choice_behind_each_branch_of_a_fork_is_decided_in_turn() {
    check_with(
        Semantics::yase(),
        "
        START
        idle
        & both
          one
            START
            A
            B
          two
            START
            C
            D
        < f
        ! p
        ! q
        c/START -> idle
        one/START -> A
        two/START -> C
        idle -> f : e / A.n = 1
        f -> p : / A.n = 2
        f -> q : / B.n = 1
        p -> B : [A.n == 2 && B.n == 1] / A.n = 3
        p -> A
        q -> D : [A.n == 3]
        q -> C
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> idle; exit START; enter idle
        0.001 s e: idle -> f -> p + f -> q; exit idle; then p -> both/one/B + q -> both/two/D; do A.n = 1 (idle -> f), A.n = 2 (f -> p), B.n = 1 (f -> q), A.n = 3 (p -> both/one/B); enter both, both/one, both/one/B, both/two, both/two/D
        ",
    );
}

#[test]
fn r13_a_choice_may_stop_the_chart() {
    check_with(
        Semantics::yase(),
        "
        START
        A | exit=raise(x)
        ! ch
        x stop
        B
        c/START -> A
        A -> ch : e / A.n = 1
        ch -> stop : [A.n == 1] / A.n = 2
        ch -> B
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> ch; exit A; then ch -> stop; do raise(x) (exit A), A.n = 1 (A -> ch), A.n = 2 (ch -> stop)
        ",
    );
}
