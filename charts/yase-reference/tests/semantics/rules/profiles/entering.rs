//! The order and firing of transitions, the beginning of composites, and the end of the root.

use yase::{ExitOrder, InitialState, Semantics};

use crate::rules::check_with;

#[test]
fn r10_start_same_step_goes_on_through_starts_and_rests_where_none_is_open() {
    let mut semantics = Semantics::yase();
    semantics.start = InitialState::SameStep;
    check_with(
        semantics,
        "
        START
        P | entry=A.n = 0
          START
          Q
            START
            B
          C
        c/START -> P : / raise(s)
        P/START -> Q : / raise(p)
        Q/START -> B : [A.n == 1] / raise(q)
        ",
        "1 A=1; 2",
        "
        0.000 s start; then START -> P + P/START -> P/Q; do raise(s) (START -> P), A.n = 0 (entry P), raise(p) (P/START -> P/Q); enter c, P, P/Q, P/Q/START
        0.000 s s: dropped
        0.000 s p: dropped
        waits at P/Q/START
        0.001 s -: P/Q/START -> P/Q/B; exit P/Q/START; do raise(q) (P/Q/START -> P/Q/B); enter P/Q/B
        0.001 s q: dropped
        ",
    );
}

#[test]
fn r10_start_same_step_reads_guards_after_the_entries_before_it() {
    check_with(
        Semantics::uml(),
        "
        START
        P | entry=A.n = 3
          START
          Q
          R
        c/START -> P
        P/START -> Q : [A.n == 3]
        P/START -> R
        ",
        "2",
        "
        0.000 s start; then START -> P + P/START -> P/Q; do A.n = 3 (entry P); enter c, P, P/Q
        ",
    );
}

#[test]
fn r10_start_same_step_may_fork() {
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
        < f
        c/START -> f
        f -> B
        f -> D
        one/START -> A
        two/START -> C
        ",
        "2",
        "
        0.000 s start; then START -> f -> both/one/B + f -> both/two/D; enter c, both, both/one, both/one/B, both/two, both/two/D
        ",
    );
}

#[test]
fn r03_order_as_modelled_tries_an_unguarded_segment_in_its_place() {
    check_with(
        Semantics::scxml(),
        "
        START
        A
        B
        C
        c/START -> A
        A -> B : e
        A -> C : e [true]
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> A; enter c, A
        0.001 s e: A -> B; exit A; enter B
        ",
    );
}

#[test]
fn r10_firing_in_phases_leaves_all_then_acts_then_enters_all() {
    check_with(
        Semantics::scxml(),
        "
        START
        & both
          one
            START
            A | exit=raise(xa)
            B | entry=raise(nb)
          two
            START
            C | exit=raise(xc)
            D | entry=raise(nd)
        c/START -> both
        one/START -> A
        two/START -> C
        A -> B : e / raise(t)
        C -> D : e / raise(u)
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> both + both/one/START -> both/one/A + both/two/START -> both/two/C; enter c, both, both/one, both/one/A, both/two, both/two/C
        0.001 s e: both/one/A -> both/one/B, both/two/C -> both/two/D; exit both/two/C, both/one/A; do raise(xc) (exit both/two/C), raise(xa) (exit both/one/A), raise(t) (both/one/A -> both/one/B), raise(u) (both/two/C -> both/two/D), raise(nb) (entry both/one/B), raise(nd) (entry both/two/D); enter both/one/B, both/two/D
        0.001 s xc: dropped
        0.001 s xa: dropped
        0.001 s t: dropped
        0.001 s u: dropped
        0.001 s nb: dropped
        0.001 s nd: dropped
        ",
    );
}

#[test]
fn r10_firing_in_phases_takes_transitions_in_the_order_of_their_first_leaf() {
    check_with(
        Semantics::scxml(),
        "
        START
        & both
          P
            START
            & deep
              one
                START
                A
              two
                START
                B
          three
            START
            C
        c/START -> both
        P/START -> deep
        one/START -> A
        two/START -> B
        three/START -> C
        deep -> deep {internal} : e / raise(outer)
        B -> B {internal} : e / raise(b)
        C -> C {internal} : e / raise(c)
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> both + both/P/START -> both/P/deep + both/P/deep/one/START -> both/P/deep/one/A + both/P/deep/two/START -> both/P/deep/two/B + both/three/START -> both/three/C; enter c, both, both/P, both/P/deep, both/P/deep/one, both/P/deep/one/A, both/P/deep/two, both/P/deep/two/B, both/three, both/three/C
        0.001 s e: both/P/deep -> both/P/deep, both/P/deep/two/B -> both/P/deep/two/B, both/three/C -> both/three/C; do raise(outer) (both/P/deep -> both/P/deep), raise(b) (both/P/deep/two/B -> both/P/deep/two/B), raise(c) (both/three/C -> both/three/C)
        0.001 s outer: dropped
        0.001 s b: dropped
        0.001 s c: dropped
        ",
    );
}

#[test]
fn r10_firing_in_phases_drops_an_outer_transition_that_an_inner_one_conflicts_with() {
    check_with(
        Semantics::scxml(),
        "
        START
        P
          START
          & both
            one
              START
              A
            two
              START
              B
              D
        Z
        c/START -> P
        P/START -> both
        one/START -> A
        two/START -> B
        both -> Z : e
        B -> D : e
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> P + P/START -> P/both + P/both/one/START -> P/both/one/A + P/both/two/START -> P/both/two/B; enter c, P, P/both, P/both/one, P/both/one/A, P/both/two, P/both/two/B
        0.001 s e: P/both/two/B -> P/both/two/D; preempt P/both -> Z; exit P/both/two/B; enter P/both/two/D
        ",
    );
}

#[test]
fn r10_exits_in_reverse_document_order() {
    check_with(
        Semantics::scxml(),
        "
        START
        & both | exit=raise(x)
          one | exit=raise(x1)
            START
            A | exit=raise(xa)
          two | exit=raise(x2)
            START
            B | exit=raise(xb)
        C
        c/START -> both
        one/START -> A
        two/START -> B
        both -> C : e
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> both + both/one/START -> both/one/A + both/two/START -> both/two/B; enter c, both, both/one, both/one/A, both/two, both/two/B
        0.001 s e: both -> C; exit both/two/B, both/two, both/one/A, both/one, both; do raise(xb) (exit both/two/B), raise(x2) (exit both/two), raise(xa) (exit both/one/A), raise(x1) (exit both/one), raise(x) (exit both); enter C
        0.001 s xb: dropped
        0.001 s x2: dropped
        0.001 s xa: dropped
        0.001 s x1: dropped
        0.001 s x: dropped
        ",
    );
}

#[test]
fn r10_exits_in_reverse_document_order_for_each_transition() {
    let mut semantics = Semantics::yase();
    semantics.exits = ExitOrder::ReverseDocument;
    check_with(
        semantics,
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
        both -> C : e
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        0.001 s e: both -> C; exit both/two/B, both/two, both/one/A, both/one, both; enter C
        ",
    );
}

#[test]
fn r13_the_end_of_the_root_exits_everything() {
    check_with(
        Semantics::scxml(),
        "
        START
        A
        END done | entry=raise(n) | exit=raise(x)
        c/START -> A
        A -> done : e / raise(t)
        A -> A {internal} : f
        ",
        "1 e; 1 f; 2",
        "
        0.000 s start; then START -> A; enter c, A
        0.001 s e: A -> done; exit A; do raise(t) (A -> done), raise(n) (entry done); enter done
        0.001 s finish; exit done, c; do raise(x) (exit done)
        ",
    );
}

#[test]
fn r13_the_end_of_the_root_idles() {
    check_with(
        Semantics::uml(),
        "
        START
        A
        END done | entry=raise(n) | exit=raise(x)
        c/START -> A
        A -> done : e / raise(t)
        ",
        "1 e; 1 f; 2",
        "
        0.000 s start; then START -> A; enter c, A
        0.001 s e: A -> done; exit A; do raise(t) (A -> done), raise(n) (entry done); enter done
        ",
    );
}

#[test]
fn r03_order_guarded_first_tries_an_unguarded_segment_last() {
    check_with(
        Semantics::yase(),
        "
        START
        A
        B
        C
        c/START -> A
        A -> B : e
        A -> C : e [true]
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> C; exit A; enter C
        ",
    );
}
