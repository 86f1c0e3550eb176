//! R7, R12, R15: JOINs that take composites, and what their sources may still do.

use yase::{CompletionTrigger, Firing, JoinMode, Semantics, TransitionToAncestor};

use crate::rules::{check_with, with};

/// A JOIN of a BASIC state and an AND, out of one of whose regions a way leads that is looked at
/// when that region has completed.
const INNER: &str = "
    START
    & both
      one
        START
        A
      two
        START
        & n
          p
            START
            END
          q
            START
            END
        X
    > j
    D
    c/START -> both
    one/START -> A
    two/START -> n
    p/START -> p/END
    q/START -> q/END
    A -> j
    n -> j
    j -> D
";

#[test]
fn r07_a_join_waits_while_something_inside_any_of_its_sources_can_step() {
    // without that, the JOIN is taken
    check_with(
        Semantics::yase(),
        INNER,
        "1",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/n; exit both/one/START, both/two/START; enter both/one/A, both/two/n, both/two/n/p, both/two/n/p/START, both/two/n/q, both/two/n/q/START
        0.000 s -: both/two/n/p/START -> both/two/n/p/END, both/two/n/q/START -> both/two/n/q/END; exit both/two/n/p/START, both/two/n/q/START; enter both/two/n/p/END, both/two/n/q/END
        0.000 s -: both/one/A -> j + both/two/n -> j -> D; exit both/one/A, both/one, both/two/n/p/END, both/two/n/p, both/two/n/q/END, both/two/n/q, both/two/n, both/two, both; enter D
        ",
    );
    check_with(
        Semantics::yase(),
        &format!("{INNER}    p -> X\n"),
        "1",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/n; exit both/one/START, both/two/START; enter both/one/A, both/two/n, both/two/n/p, both/two/n/p/START, both/two/n/q, both/two/n/q/START
        0.000 s -: both/two/n/p/START -> both/two/n/p/END, both/two/n/q/START -> both/two/n/q/END; exit both/two/n/p/START, both/two/n/q/START; enter both/two/n/p/END, both/two/n/q/END
        0.000 s -: both/two/n/p -> both/two/X; exit both/two/n/p/END, both/two/n/p, both/two/n/q/END, both/two/n/q, both/two/n; enter both/two/X
        ",
    );
}

#[test]
fn r07_of_two_joins_that_each_hold_a_source_of_the_other_the_inner_that_is_looked_at_first_is_taken() {
    // `j` takes the composite around a source of `k`, and `k` the composite around a source of `j`
    check_with(
        Semantics::yase(),
        "
        START
        & both
          & one
            x
              START
              END
            y
          & two
            v
              START
              END
            w
        > j
        > k
        D
        E
        c/START -> both
        x/START -> x/END
        v/START -> v/END
        one -> j
        v -> j
        x -> k
        two -> k
        j -> D
        k -> E
        ",
        "1",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/x, both/one/x/START, both/one/y, both/two, both/two/v, both/two/v/START, both/two/w
        0.000 s -: both/one/x/START -> both/one/x/END, both/two/v/START -> both/two/v/END; exit both/one/x/START, both/two/v/START; enter both/one/x/END, both/two/v/END
        0.000 s -: both/one/x -> k + both/two -> k -> E; exit both/one/x/END, both/one/x, both/one/y, both/one, both/two/v/END, both/two/v, both/two/w, both/two, both; enter E
        ",
    );
}

#[test]
fn r15_eventless_once_offers_a_join_together_when_the_last_of_its_sources_completes() {
    let once = with(|it| it.eventless = CompletionTrigger::Once);
    let chart = |first: u32, second: u32| {
        format!(
            "
            START
            & both
              one
                START
                A | run | for={first}ms
              two
                START
                B | run | for={second}ms
            > j
            D
            c/START -> both
            one/START -> A
            two/START -> B
            A -> j
            B -> j
            j -> D
            "
        )
    };
    let begin = "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        start A
        start B
        ";
    let joined = "-: both/one/A -> j + both/two/B -> j -> D; exit both/one/A, both/one, both/two/B, both/two, both; enter D";
    let ends = format!("{begin}B returns Done\nA returns Done\n0.020 s {joined}");
    check_with(once, &chart(20, 10), "30", &ends);
    let ends = format!("{begin}A returns Done\nB returns Done\n0.020 s {joined}");
    check_with(once, &chart(10, 20), "30", &ends);
}

#[test]
fn r15_eventless_once_offers_a_completion_once_though_it_comes_about_twice() {
    // `two` reaches an END, and then another, before the AND's completion is looked at
    check_with(
        with(|it| it.eventless = CompletionTrigger::Once),
        "
        START
        & both
          one
            START
            END
          two
            START
            END
            END again
        c/START -> both
        one/START -> one/END
        two/START -> two/END
        two -> again {internal} : [In(two/END)]
        both -> both {internal} : / raise(x)
        ",
        "1",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/END, both/two/START -> both/two/END; exit both/one/START, both/two/START; enter both/one/END, both/two/END
        0.000 s -: both/two -> both/two/again; exit both/two/END; enter both/two/again
        0.000 s -: both -> both; do raise(x) (both -> both)
        0.000 s x: dropped
        ",
    );
}

#[test]
fn r08_what_leaves_nothing_since_its_region_was_vacated_is_in_conflict_with_nothing() {
    check_with(
        with(|it| it.ancestor = TransitionToAncestor::Completed),
        "
        START
        & both
          one
            START
            A
          two
            START
            B
        D
        c/START -> both
        one/START -> A
        two/START -> B
        A -> one : f
        one -> A {internal} : e
        B -> D : e
        ",
        "1 f; 2 e; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        0.001 s f: both/one/A -> both/one; exit both/one/A
        0.002 s e: both/one -> both/one/A, both/two/B -> D; exit both/one/A, both/one, both/two/B, both/two, both; enter both/one/A, D
        ",
    );
}

#[test]
fn r10_in_phases_what_begins_at_a_vacated_region_that_another_leaves_does_not_fire() {
    // or `one` would get two children; what leads nowhere fires all the same
    check_with(
        with(|it| {
            it.ancestor = TransitionToAncestor::Completed;
            it.firing = Firing::Phases;
        }),
        "
        START
        & both
          one
            START
            A
            C
          two
            START
            B
          three
        c/START -> both
        one/START -> A
        two/START -> B
        A -> one : f
        one -> A {internal} : e
        B -> C : e
        three -> three {internal} : e / raise(g)
        ",
        "1 f; 2 e; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START, both/three
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        0.001 s f: both/one/A -> both/one; exit both/one/A
        0.002 s e: both/two/B -> both/one/C, both/three -> both/three; exit both/one, both/two/B, both/two, both/three, both; do raise(g) (both/three -> both/three); enter both, both/one, both/one/C, both/two, both/two/START, both/three
        0.002 s -: both/two/START -> both/two/B; exit both/two/START; enter both/two/B
        0.002 s g: dropped
        ",
    );
}

#[test]
fn r10_what_begins_at_a_state_that_another_has_left_does_not_fire_though_it_was_entered_again() {
    // `r` is a region of its own: to stop the chart it leaves nothing
    check_with(
        Semantics::yase(),
        "
        START
        & both
          one
            START
            A
          r
        x stop
        c/START -> both
        one/START -> A
        A -> r : e
        r -> stop : e
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/r
        0.000 s -: both/one/START -> both/one/A; exit both/one/START; enter both/one/A
        0.001 s e: both/one/A -> both/r; exit both/one/A, both/one, both/r, both; enter both, both/one, both/one/START, both/r
        0.001 s -: both/one/START -> both/one/A; exit both/one/START; enter both/one/A
        ",
    );
}

#[test]
fn r12_what_has_arrived_at_a_join_and_is_then_left_arrives_again() {
    // `two` has arrived and is vacated; `both -> D` leaves and enters it with all that is in it,
    // but not `both`
    check_with(
        with(|it| it.join = JoinMode::Each),
        "
        START
        & both
          one
            START
            A
          & two
            p
              START
              END
            q
              START
              D
        > j
        E
        c/START -> both
        one/START -> A
        p/START -> p/END
        q/START -> D
        A -> j : [false]
        p -> j
        both -> D {internal} : f
        j -> E
        ",
        "1 f; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/p, both/two/p/START, both/two/q, both/two/q/START
        0.000 s -: both/one/START -> both/one/A, both/two/p/START -> both/two/p/END, both/two/q/START -> both/two/q/D; exit both/one/START, both/two/p/START, both/two/q/START; enter both/one/A, both/two/p/END, both/two/q/D
        0.000 s -: both/two/p -> j; exit both/two/p/END, both/two/p, both/two/q/D, both/two/q
        0.001 s f: both -> both/two/q/D; exit both/one/A, both/one, both/two; enter both/one, both/one/START, both/two, both/two/p, both/two/p/START, both/two/q, both/two/q/D
        0.001 s -: both/one/START -> both/one/A, both/two/p/START -> both/two/p/END; exit both/one/START, both/two/p/START; enter both/one/A, both/two/p/END
        0.001 s -: both/two/p -> j; exit both/two/p/END, both/two/p, both/two/q/D, both/two/q
        ",
    );
}

#[test]
fn r06_a_region_that_gets_a_child_again_is_complete_no_more() {
    check_with(
        with(|it| it.ancestor = TransitionToAncestor::Completed),
        "
        START
        & both
          one
            START
            A
          two
            START
            B
            END
        D
        c/START -> both
        one/START -> A
        two/START -> B
        A -> one : f
        one -> A {internal} : e
        B -> two/END : g
        both -> D
        ",
        "1 f; 2 e; 3 g; 4 f; 5",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        0.001 s f: both/one/A -> both/one; exit both/one/A
        0.002 s e: both/one -> both/one/A; enter both/one/A
        0.003 s g: both/two/B -> both/two/END; exit both/two/B; enter both/two/END
        0.004 s f: both/one/A -> both/one; exit both/one/A
        0.004 s -: both -> D; exit both/one, both/two/END, both/two, both; enter D
        ",
    );
}

#[test]
fn r12_a_region_without_states_that_is_left_has_to_arrive_again() {
    check_with(
        with(|it| it.join = JoinMode::Each),
        "
        START
        & both
          one
            START
            A
            END
          r
        > j
        E
        c/START -> both
        one/START -> A
        A -> END : f
        one -> j
        r -> j : [A.n == 0]
        both -> both : h
        j -> E
        ",
        "1 A=0; 2 A=1; 3 h; 4 f; 5 A=0; 6",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/r
        0.000 s -: both/one/START -> both/one/A; exit both/one/START; enter both/one/A
        0.001 s -: both/r -> j
        0.003 s h: both -> both; exit both/one/A, both/one, both/r, both; enter both, both/one, both/one/START, both/r
        0.003 s -: both/one/START -> both/one/A; exit both/one/START; enter both/one/A
        0.004 s f: both/one/A -> both/one/END; exit both/one/A; enter both/one/END
        0.004 s -: both/one -> j; exit both/one/END
        0.005 s -: both/r -> j -> E; exit both/one, both/r, both; enter E
        ",
    );
}

#[test]
fn r12_a_join_of_some_regions_is_looked_at_when_the_last_of_them_arrives() {
    for eventless in [
        CompletionTrigger::Once,
        CompletionTrigger::Quiescent,
        CompletionTrigger::AsWritten,
        CompletionTrigger::Always,
    ] {
        check_with(
            with(|it| {
                it.join = JoinMode::Each;
                it.eventless = eventless;
            }),
            "
            START
            & both
              one
                START
                A
                END
              two
                START
                B
                END
              three
                START
                C
              four
                START
                D
                END
            > j
            E
            c/START -> both
            one/START -> A
            two/START -> B
            three/START -> C
            four/START -> D
            D -> four/END : h
            four -> j
            A -> one/END : f
            B -> two/END : g
            one -> j
            two -> j
            j -> E
            ",
            "1 f; 2 g; 3 h; 4",
            "
            0.000 s start; enter c, START
            0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START, both/three, both/three/START, both/four, both/four/START
            0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B, both/three/START -> both/three/C, both/four/START -> both/four/D; exit both/one/START, both/two/START, both/three/START, both/four/START; enter both/one/A, both/two/B, both/three/C, both/four/D
            0.001 s f: both/one/A -> both/one/END; exit both/one/A; enter both/one/END
            0.001 s -: both/one -> j; exit both/one/END
            0.002 s g: both/two/B -> both/two/END; exit both/two/B; enter both/two/END
            0.002 s -: both/two -> j; exit both/two/END
            0.003 s h: both/four/D -> both/four/END; exit both/four/D; enter both/four/END
            0.003 s -: both/four -> j -> E; exit both/one, both/two, both/three/C, both/three, both/four/END, both/four, both; enter E
            ",
        );
    }
}
