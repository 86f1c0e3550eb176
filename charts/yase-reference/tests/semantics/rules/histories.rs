//! R10: what HISTORYs remember, and where they lead.

use yase::{Machine, Semantics, Timestamp, TransitionToAncestor};

use crate::rules::{check, check_with, with};
use yase_reference::{TestHost, chart, script};

#[test]
fn r10_a_shallow_history_leads_to_the_child_which_begins_anew() {
    check_with(
        Semantics::yase(),
        "
        START
        A
        P | entry=raise(n)
          START
          h h
          B
          Q
            START
            C
            D
        c/START -> A
        P/START -> B
        Q/START -> C
        C -> D : f
        A -> h : e
        h -> Q : / raise(d)
        P -> A : g
        ",
        "1 e; 2 f; 3 g; 4 e; 5",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> P/h; exit A; then P/h -> P/Q; do raise(n) (entry P), raise(d) (P/h -> P/Q); enter P, P/Q, P/Q/START
        0.001 s -: P/Q/START -> P/Q/C; exit P/Q/START; enter P/Q/C
        0.001 s n: dropped
        0.001 s d: dropped
        0.002 s f: P/Q/C -> P/Q/D; exit P/Q/C; enter P/Q/D
        0.003 s g: P -> A; exit P/Q/D, P/Q, P; enter A
        0.004 s e: A -> P/h; exit A; do raise(n) (entry P); enter P, P/Q, P/Q/START
        0.004 s -: P/Q/START -> P/Q/C; exit P/Q/START; enter P/Q/C
        0.004 s n: dropped
        ",
    );
}

#[test]
fn r10_a_deep_history_leads_to_all_that_was_active_in_regions_too() {
    check_with(
        Semantics::yase(),
        "
        START
        A
        P
          START
          H h
          & both
            one
              START
              B
              C | run | for=1ms
            two
              START
              D
              Q
                START
                E
                F
        c/START -> P
        P/START -> both
        one/START -> B
        two/START -> D
        Q/START -> E
        B -> C : e
        D -> F : f
        P -> A : g
        A -> h : e
        ",
        "1 e; 2 f; 3 g; 4 e; 5 f; 6",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/both; exit P/START; enter P/both, P/both/one, P/both/one/START, P/both/two, P/both/two/START
        0.000 s -: P/both/one/START -> P/both/one/B, P/both/two/START -> P/both/two/D; exit P/both/one/START, P/both/two/START; enter P/both/one/B, P/both/two/D
        0.001 s e: P/both/one/B -> P/both/one/C; exit P/both/one/B; enter P/both/one/C
        start C
        C returns Done
        0.002 s f: P/both/two/D -> P/both/two/Q/F; exit P/both/two/D; enter P/both/two/Q, P/both/two/Q/F
        0.003 s g: P -> A; exit P/both/one/C, P/both/one, P/both/two/Q/F, P/both/two/Q, P/both/two, P/both, P; enter A
        0.004 s e: A -> P/h; exit A; enter P, P/both, P/both/one, P/both/one/C, P/both/two, P/both/two/Q, P/both/two/Q/F
        start C
        C returns Done
        0.005 s f: dropped
        ",
    );
}

#[test]
fn r10_history_is_recorded_before_the_first_exit() {
    check_with(
        Semantics::yase(),
        "
        START
        P
          START
          h h
          B
          C
        A
        c/START -> P
        P/START -> B
        B -> C : k
        P -> A : e
        A -> h : f
        ",
        "1 k; 2 e; 3 f; 4",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/B; exit P/START; enter P/B
        0.001 s k: P/B -> P/C; exit P/B; enter P/C
        0.002 s e: P -> A; exit P/C, P; enter A
        0.003 s f: A -> P/h; exit A; enter P, P/C
        ",
    );
}

#[test]
fn r10_a_history_of_an_and_left_by_one_of_its_regions_remembers_the_others() {
    check_with(
        Semantics::yase(),
        "
        START
        & both
          H all
          h each
          one
            START
            A
            B
          two
            START
            C
            D
        E
        c/START -> both
        one/START -> A
        two/START -> C
        A -> B : e
        B -> E : f
        E -> all : g
        E -> each : h
        ",
        "1 e; 2 f; 3 g; 4 f; 5 h; 6",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/C; exit both/one/START, both/two/START; enter both/one/A, both/two/C
        0.001 s e: both/one/A -> both/one/B; exit both/one/A; enter both/one/B
        0.002 s f: both/one/B -> E; exit both/one/B, both/one, both/two/C, both/two, both; enter E
        0.003 s g: E -> both/all; exit E; enter both, both/one, both/one/B, both/two, both/two/C
        0.004 s f: both/one/B -> E; exit both/one/B, both/one, both/two/C, both/two, both; enter E
        0.005 s h: E -> both/each; exit E; enter both, both/one, both/one/START, both/two, both/two/START
        0.005 s -: both/one/START -> both/one/A, both/two/START -> both/two/C; exit both/one/START, both/two/START; enter both/one/A, both/two/C
        ",
    );
}

#[test]
fn r10_without_a_record_a_history_leads_where_it_says_or_to_start() {
    check_with(
        Semantics::yase(),
        "
        START
        A
        P
          START
          h h
          B
          C
          D
        c/START -> A
        P/START -> B
        A -> h : e
        h -> C : [A.n > 0]
        h -> D : [B.n > 0]
        P -> A : f
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> P/h; exit A; enter P, P/START
        0.001 s -: P/START -> P/B; exit P/START; enter P/B
        0.002 s f: P -> A; exit P/B, P; enter A
        ",
    );
}

#[test]
fn r10_a_start_forgets_what_histories_remember() {
    let chart = chart(
        "START\nA\nP\n  START\n  h h\n  B\n  C\nc/START -> P\nP/START -> B\nB -> C : k\nP -> A : e\nA -> h : f",
    );
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost::new(&chart);
    let mut leaf = |events: &[&str]| {
        machine.start(Timestamp::ZERO, &mut host);
        for event in events {
            machine.dispatch_name(event);
        }
        machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
        machine.configuration().pop().map(|node| machine.chart().short_path(node)).unwrap()
    };
    assert_eq!(leaf(&["k", "e", "f"]), "P/C");
    assert_eq!(leaf(&["e", "f"]), "P/B");
    assert_eq!(leaf(&["k", "e"]), "A");
    assert_eq!(leaf(&["e", "f"]), "P/B", "what the run before remembered is forgotten");
}

#[test]
fn r10_without_a_record_a_history_takes_the_way_that_is_open() {
    check_with(
        Semantics::yase(),
        "
        START
        A
        P | entry=raise(n)
          START
          h h
          B
          C
          D
        c/START -> A
        P/START -> B
        A -> h : e / raise(t)
        h -> C : [A.n > 0]
        h -> D : [B.n > 0] / raise(d)
        ",
        "1 B=1; 2 e; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.002 s e: A -> P/h; exit A; then P/h -> P/D; do raise(t) (A -> P/h), raise(n) (entry P), raise(d) (P/h -> P/D); enter P, P/D
        0.002 s t: dropped
        0.002 s n: dropped
        0.002 s d: dropped
        ",
    );
}

#[test]
fn r10_a_deep_history_restores_a_vacated_part_by_its_start() {
    check_with(
        Semantics::uml(),
        "
        START
        P
          START
          H h
          Q
            START
            A
            B
        R
        c/START -> P
        P/START -> Q
        Q/START -> A
        A -> Q : e
        P -> R : f
        R -> h : g
        ",
        "1 e; 2 f; 3 g; 4",
        "
        0.000 s start; then START -> P + P/START -> P/Q + P/Q/START -> P/Q/A; enter c, P, P/Q, P/Q/A
        0.001 s e: P/Q/A -> P/Q; exit P/Q/A
        0.002 s f: P -> R; exit P/Q, P; enter R
        0.003 s g: R -> P/h; exit R; then P/Q/START -> P/Q/A; enter P, P/Q, P/Q/A
        ",
    );
}

#[test]
fn r21_a_timer_that_a_transition_to_a_history_starts_belongs_to_its_composite_and_others_to_their_target() {
    let text = "
        START
        P
          START
          h H
          A
          B
        Q
        c/START -> P
        P/START -> A
        A -> B : swap
        B -> A : swap
        P -> Q : out
        Q -> H : back / StartTimeout(v, 10ms)
        Q -> A : a / StartTimeout(v, 10ms)
        A -> A {internal} : v
        B -> B {internal} : v
        Q -> Q {internal} : v
    ";
    let taken = |script: &str| {
        let log = script::play_with(&chart(text), script, with(|it| it.timers = yase::TimerScope::State));
        log.last().unwrap().trim().to_owned()
    };
    // not unset while `P` is active
    assert_eq!(taken("1 out; 2 back; 3 swap; 30"), "0.012 s v: P/B -> P/B");
    assert!(taken("1 out; 2 back; 3 out; 30").starts_with("0.003 s out: P -> Q"));
    // only while `A` is
    assert_eq!(taken("1 out; 2 a; 30"), "0.012 s v: P/A -> P/A");
    assert!(taken("1 out; 2 a; 3 swap; 30").starts_with("0.003 s swap: P/A -> P/B"));
}

#[test]
fn r10_a_composite_that_was_left_with_nothing_in_it_has_no_history() {
    check_with(
        with(|it| it.ancestor = TransitionToAncestor::Completed),
        "
        START
        P
          START
          h last
          A
          B
        X
        c/START -> P
        P/START -> A
        last -> B
        A -> P : f
        P -> X : g
        X -> last : g
        ",
        "1 f; 2 g; 3 g; 4",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/A; exit P/START; enter P/A
        0.001 s f: P/A -> P; exit P/A
        0.002 s g: P -> X; exit P; enter X
        0.003 s g: X -> P/last; exit X; then P/last -> P/B; enter P, P/B
        ",
    );
}

#[test]
fn r10_the_shallow_history_of_an_and_is_that_it_was_active() {
    check(
        "
        START
        & both
          h last
          one
            START
            A
            B
          two
            START
            C
        X
        c/START -> X
        one/START -> A
        two/START -> C
        last -> B
        X -> last : g
        both -> X : f
                ",
        "1 g; 2 f; 3 g; 4",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> X; exit START; enter X
        0.001 s g: X -> both/last; exit X; then both/last -> both/one/B; enter both, both/one, both/one/B, both/two, both/two/START
        0.001 s -: both/two/START -> both/two/C; exit both/two/START; enter both/two/C
        0.002 s f: both -> X; exit both/one/B, both/one, both/two/C, both/two, both; enter X
        0.003 s g: X -> both/last; exit X; enter both, both/one, both/one/START, both/two, both/two/START
        0.003 s -: both/one/START -> both/one/A, both/two/START -> both/two/C; exit both/one/START, both/two/START; enter both/one/A, both/two/C
        ",
    );
}
