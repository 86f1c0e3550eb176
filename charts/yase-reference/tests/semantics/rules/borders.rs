//! R1, R2, R10: points on borders, regions of every kind, and leaving one for another.

use yase::Semantics;

use crate::rules::check_with;

#[test]
fn r01_entry_and_exit_points_lie_on_the_way() {
    check_with(
        Semantics::yase(),
        "
        START
        A | exit=raise(xa)
        P | entry=raise(np) | exit=raise(xp)
          START
          i in
          o out
          B
          C
        D
        c/START -> A
        P/START -> B
        A -> in : e / raise(g)
        in -> C : / raise(p)
        C -> out : f / raise(q)
        out -> D : / raise(r)
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> P/in -> P/C; exit A; do raise(xa) (exit A), raise(g) (A -> P/in), raise(p) (P/in -> P/C), raise(np) (entry P); enter P, P/C
        0.001 s xa: dropped
        0.001 s g: dropped
        0.001 s p: dropped
        0.001 s np: dropped
        0.002 s f: P/C -> P/out -> D; exit P/C, P; do raise(xp) (exit P), raise(q) (P/C -> P/out), raise(r) (P/out -> D); enter D
        0.002 s xp: dropped
        0.002 s q: dropped
        0.002 s r: dropped
        ",
    );
}

#[test]
fn r01_an_entry_point_of_an_and_forks_and_each_region_alone_leaves_by_an_exit_point() {
    check_with(
        Semantics::yase(),
        "
        START
        A
        & both
          i in
          o out
          one
            START
            B
            C
          two
            START
            D
            E
        F
        c/START -> A
        one/START -> B
        two/START -> D
        A -> in : e
        in -> C
        in -> E
        E -> out : f
        out -> F
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> both/in -> both/one/C + both/in -> both/two/E; exit A; enter both, both/one, both/one/C, both/two, both/two/E
        0.002 s f: both/two/E -> both/out -> F; exit both/one/C, both/one, both/two/E, both/two, both; enter F
        ",
    );
}

#[test]
fn r02_a_region_may_be_left_for_its_sibling_past_the_and() {
    check_with(
        Semantics::yase(),
        "
        START
        & both | exit=raise(x) | entry=raise(n)
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
        A -> C : e
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; do raise(n) (entry both); enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        0.000 s n: dropped
        0.001 s e: both/one/A -> both/two/C; exit both/one/A, both/one, both/two/B, both/two, both; do raise(x) (exit both), raise(n) (entry both); enter both, both/one, both/one/START, both/two, both/two/C
        0.001 s -: both/one/START -> both/one/A; exit both/one/START; enter both/one/A
        0.001 s x: dropped
        0.001 s n: dropped
        ",
    );
}

#[test]
fn r01_regions_may_be_basic_or_ands_themselves() {
    check_with(
        Semantics::yase(),
        "
        START
        & both
          A | run | for=20ms
          & inner
            B | run | for=10ms
            x never
            one
              START
              C
              END
        D
        c/START -> both
        one/START -> C
        C -> one/END : e
        both -> D
        ",
        "1 e; 50",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/A, both/inner, both/inner/B, both/inner/one, both/inner/one/START
        0.000 s -: both/inner/one/START -> both/inner/one/C; exit both/inner/one/START; enter both/inner/one/C
        start A
        start B
        0.001 s e: both/inner/one/C -> both/inner/one/END; exit both/inner/one/C; enter both/inner/one/END
        B returns Done
        A returns Done
        0.020 s -: both -> D; exit both/A, both/inner/B, both/inner/one/END, both/inner/one, both/inner, both; enter D
        ",
    );
}

#[test]
fn r10_a_region_that_another_member_of_the_step_has_left_does_not_fire() {
    check_with(
        Semantics::yase(),
        "
        START
        & both
          one
            START
            A
          two
            START
            B
        x stop
        C
        c/START -> both
        one/START -> A
        two/START -> B
        A -> C : e
        B -> stop : e
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        0.001 s e: both/one/A -> C; exit both/one/A, both/one, both/two/B, both/two, both; enter C
        ",
    );
}

#[test]
fn r01_an_entry_point_with_two_ways_into_one_region_is_no_fork() {
    check_with(
        Semantics::yase(),
        "
        START
        A
        & both
          i in
          one
            START
            B
            C
          two
            START
            D
        c/START -> A
        one/START -> B
        two/START -> D
        A -> in : e
        in -> C
        in -> B
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> both/in -> both/one/C; exit A; enter both, both/one, both/one/C, both/two, both/two/START
        0.001 s -: both/two/START -> both/two/D; exit both/two/START; enter both/two/D
        ",
    );
}
