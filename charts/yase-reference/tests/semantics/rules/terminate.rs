//! R13: TERMINATE.

use yase::{Firing, InitialState, Semantics};

use crate::rules::data::verbose;
use crate::rules::{check_with, refusal, with};

#[test]
fn r13_what_can_only_stop_the_chart_leaves_nothing() {
    check_with(
        Semantics::yase(),
        "
        START
        O | exit=raise(x)
          START
          & both
            one
              START
              A | run | for=20ms
            two
              START
              B | exit=raise(y)
        ! ch
        x stop
        x halt
        c/START -> O
        O/START -> both
        one/START -> A
        two/START -> B
        B -> ch : e / A.n = 1
        ch -> stop : [A.n == 1] / A.n = 2
        ch -> halt
        ",
        "1 e; 2 e; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> O; exit START; enter O, O/START
        0.000 s -: O/START -> O/both; exit O/START; enter O/both, O/both/one, O/both/one/START, O/both/two, O/both/two/START
        0.000 s -: O/both/one/START -> O/both/one/A, O/both/two/START -> O/both/two/B; exit O/both/one/START, O/both/two/START; enter O/both/one/A, O/both/two/B
        start A
        cancel A
        0.001 s e: O/both/two/B -> ch; then ch -> stop; do A.n = 1 (O/both/two/B -> ch), A.n = 2 (ch -> stop)
        A returns Done
        ",
    );
}

const SIDE_BY_SIDE: &str = "
    START
    & both
      one
        START
        A | exit=raise(a)
        B | entry=raise(b)
      two
        START
        C | exit=raise(c)
        x stop
      three
        START
        E | exit=raise(e)
        F | entry=raise(f)
    c/START -> both
    one/START -> A
    two/START -> C
    three/START -> E
    A -> B : go / raise(ab)
    C -> stop : go / raise(cs)
    E -> F : go / raise(ef)
";

#[test]
fn r13_beside_others_what_fires_before_is_done_and_what_would_fire_after_is_not() {
    check_with(
        Semantics::yase(),
        SIDE_BY_SIDE,
        "1 go; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START, both/three, both/three/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/C, both/three/START -> both/three/E; exit both/one/START, both/two/START, both/three/START; enter both/one/A, both/two/C, both/three/E
        0.001 s go: both/one/A -> both/one/B, both/two/C -> both/two/stop; exit both/one/A; do raise(a) (exit both/one/A), raise(ab) (both/one/A -> both/one/B), raise(b) (entry both/one/B), raise(cs) (both/two/C -> both/two/stop); enter both/one/B
        ",
    );
}

#[test]
fn r13_in_phases_all_exits_effects_and_entries_of_the_others_happen_before_the_chart_stops() {
    check_with(
        Semantics::scxml(),
        SIDE_BY_SIDE,
        "1 go; 2",
        "
        0.000 s start; then START -> both + both/one/START -> both/one/A + both/two/START -> both/two/C + both/three/START -> both/three/E; enter c, both, both/one, both/one/A, both/two, both/two/C, both/three, both/three/E
        0.001 s go: both/one/A -> both/one/B, both/two/C -> both/two/stop, both/three/E -> both/three/F; exit both/three/E, both/one/A; do raise(e) (exit both/three/E), raise(a) (exit both/one/A), raise(ab) (both/one/A -> both/one/B), raise(cs) (both/two/C -> both/two/stop), raise(ef) (both/three/E -> both/three/F), raise(b) (entry both/one/B), raise(f) (entry both/three/F); enter both/one/B, both/three/F
        ",
    );
}

#[test]
fn r13_a_start_left_in_the_same_step_may_stop_the_chart_and_nothing_more_is_entered() {
    check_with(
        with(|it| it.start = InitialState::SameStep),
        "
        START
        A
        & both
          one
            START
            B
          two | entry=raise(t)
            START
            x stop
          three
            START
            C
        c/START -> A
        one/START -> B
        two/START -> stop : / raise(s)
        three/START -> C
        A -> both : e
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> A; enter c, A
        0.001 s e: A -> both; exit A; then both/one/START -> both/one/B + both/two/START -> both/two/stop; do raise(t) (entry both/two), raise(s) (both/two/START -> both/two/stop); enter both, both/one, both/one/B, both/two
        ",
    );
}

#[test]
fn r13_a_fork_that_leads_to_terminate_is_refused() {
    let chart = |last: &str| {
        format!(
            "
            START
            A
            & both
              one
                START
                B
              two
                START
                D
            x stop
            ! ch
            < f
            c/START -> A
            one/START -> B
            two/START -> D
            A -> f : e
            f -> B
            {last}
            "
        )
    };
    let refused = |node: &str| {
        format!(
            "error[M04]: a FORK leads to `c/{node}`, which stops the chart (the branches of a FORK lead to states; TERMINATE may \
             stand behind a CHOICE that leads to others too)"
        )
    };
    let dead_end = "ch -> D";
    assert_eq!(refusal(&chart(&format!("f -> stop\n            {dead_end}"))), refused("stop"));
    assert_eq!(refusal(&chart("f -> ch\n            ch -> stop")), refused("ch"));
    assert_eq!(refusal(&chart("f -> ch\n            ch -> stop : [A.n == 1]\n            ch -> D")), "none");
}

#[test]
fn r13_in_phases_a_start_that_stops_the_chart_keeps_what_comes_after_from_being_entered() {
    check_with(
        with(|it| {
            it.start = InitialState::SameStep;
            it.firing = Firing::Phases;
        }),
        "
        START
        & both
          one
            START
            A
            P
              START
              x stop
          two
            START
            C
            D
        c/START -> both
        one/START -> A
        two/START -> C
        P/START -> stop
        A -> P : e
        C -> D : e
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> both + both/one/START -> both/one/A + both/two/START -> both/two/C; enter c, both, both/one, both/one/A, both/two, both/two/C
        0.001 s e: both/one/A -> both/one/P, both/two/C -> both/two/D; exit both/one/A, both/two/C; then both/one/P/START -> both/one/P/stop; enter both/one/P
        ",
    );
}

#[test]
fn r13_behind_a_history_that_stops_the_chart_no_start_is_left() {
    check_with(
        with(|it| it.start = InitialState::SameStep),
        "
        START
        A
        P
          START
          H h
          B
          x stop
        c/START -> A
        P/START -> B : / raise(never)
        h -> stop : / raise(s)
        A -> h : e
        ",
        "1 e; 2",
        "
        0.000 s start; then START -> A; enter c, A
        0.001 s e: A -> P/h; exit A; then P/h -> P/stop; do raise(s) (P/h -> P/stop); enter P
        ",
    );
}

#[test]
fn r13_a_way_that_only_stops_works_on_the_blackboard_around_where_it_stops() {
    let written = |inside: &str, around: &str| {
        let text = format!(
            "START
& both
  one
    START
    A
    {inside}
  two
    START
    B
{around}
c/START -> both
one/START -> A
two/START -> B
A -> k : e / B.n = 1
k -> stop"
        );
        let log = verbose(&text, "1 e; 2", Semantics::yase());
        log.into_iter().filter(|line| line.contains(" on ")).collect::<String>()
    };
    assert_eq!(written("! k", "x stop"), "  B on 0 = 1");
    assert_eq!(written("x stop", "! k"), "  B on 1 = 1");
}
