//! R25 to R27: segment by segment, deferral by the innermost claim, TERMINATE; and the forms that
//! only UML allows.

use yase::Semantics;

use crate::rules::check_with;

const ENTRY_POINT: &str = "
    START
    W
    P | entry=raise(n)
      i in
      START
      A
    c/START -> W
    P/START -> A
    W -> in : e / raise(t1)
    in -> A : / raise(t2)
    ";

#[test]
fn r25_a_composite_is_entered_between_the_segments_at_its_entry_point() {
    check_with(
        Semantics::uml(),
        ENTRY_POINT,
        "1 e; 2",
        "
        0.000 s start; then START -> W; enter c, W
        0.001 s e: W -> P/in -> P/A; exit W; do raise(t1) (W -> P/in), raise(n) (entry P), raise(t2) (P/in -> P/A); enter P, P/A
        0.001 s t1: dropped
        0.001 s n: dropped
        0.001 s t2: dropped
        ",
    );
}

#[test]
fn r10_a_compound_transition_is_taken_as_a_whole() {
    check_with(
        Semantics::yase(),
        ENTRY_POINT,
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> W; exit START; enter W
        0.001 s e: W -> P/in -> P/A; exit W; do raise(t1) (W -> P/in), raise(t2) (P/in -> P/A), raise(n) (entry P); enter P, P/A
        0.001 s t1: dropped
        0.001 s t2: dropped
        0.001 s n: dropped
        ",
    );
}

#[test]
fn r25_regions_that_reach_an_exit_point_by_one_event_pass_it_together() {
    check_with(
        Semantics::uml(),
        "
        START
        & P | exit=raise(x)
          o out
          one
            START
            A
          two
            START
            B
        Z
        c/START -> P
        one/START -> A
        two/START -> B
        A -> out : e / raise(t1)
        B -> out : e | f / raise(t2)
        out -> Z : / raise(t3)
        Z -> P : g
        ",
        "1 e; 2 g; 3 f; 4 f; 5 e; 6",
        "
        0.000 s start; then START -> P + P/one/START -> P/one/A + P/two/START -> P/two/B; enter c, P, P/one, P/one/A, P/two, P/two/B
        0.001 s e: P/one/A -> P/out, P/two/B -> P/out -> Z; exit P/one/A, P/one, P/two/B, P/two, P; do raise(t1) (P/one/A -> P/out), raise(t2) (P/two/B -> P/out), raise(x) (exit P), raise(t3) (P/out -> Z); enter Z
        0.001 s t1: dropped
        0.001 s t2: dropped
        0.001 s x: dropped
        0.001 s t3: dropped
        0.002 s g: Z -> P; exit Z; then P/one/START -> P/one/A + P/two/START -> P/two/B; enter P, P/one, P/one/A, P/two, P/two/B
        0.003 s f: P/two/B -> P/out; exit P/two/B; do raise(t2) (P/two/B -> P/out)
        0.003 s t2: dropped
        0.004 s f: dropped
        0.005 s e: P/one/A -> P/out -> Z; exit P/one/A, P/one, P/two, P; do raise(t1) (P/one/A -> P/out), raise(x) (exit P), raise(t3) (P/out -> Z); enter Z
        0.005 s t1: dropped
        0.005 s x: dropped
        0.005 s t3: dropped
        ",
    );
}

#[test]
fn r25_a_history_remembers_what_an_exit_point_emptied() {
    check_with(
        Semantics::uml(),
        "
        START
        P
          START
          A
          B
          o out
          h past
        Z
        c/START -> P
        P/START -> A
        A -> B : e
        B -> out : f
        out -> Z
        Z -> past : g
        ",
        "1 e; 2 f; 3 g; 4",
        "
        0.000 s start; then START -> P + P/START -> P/A; enter c, P, P/A
        0.001 s e: P/A -> P/B; exit P/A; enter P/B
        0.002 s f: P/B -> P/out -> Z; exit P/B, P; enter Z
        0.003 s g: Z -> P/past; exit Z; enter P, P/B
        ",
    );
}

#[test]
fn r25_a_local_transition_into_one_region_enters_the_others_again() {
    check_with(
        Semantics::uml(),
        "
        START
        & P
          one
            START
            A
            B
          two
            START
            C
            D
        c/START -> P
        one/START -> A
        two/START -> C
        C -> D : e
        P -> B {internal} : f
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; then START -> P + P/one/START -> P/one/A + P/two/START -> P/two/C; enter c, P, P/one, P/one/A, P/two, P/two/C
        0.001 s e: P/two/C -> P/two/D; exit P/two/C; enter P/two/D
        0.002 s f: P -> P/one/B; exit P/one/A, P/one, P/two/D, P/two; then P/two/START -> P/two/C; enter P/one, P/one/B, P/two, P/two/C
        ",
    );
}

const DEFERRING: &str = "
    START
    P
      START
      A | defer=e
      B
    Q
    c/START -> P
    P/START -> A
    P -> Q : e
    A -> B : f
    B -> B : g
    ";

#[test]
fn r26_a_transition_of_an_outer_state_does_not_take_what_an_inner_one_defers() {
    check_with(
        Semantics::uml(),
        DEFERRING,
        "1 e; 2 f; 2 g; 3",
        "
        0.000 s start; then START -> P + P/START -> P/A; enter c, P, P/A
        0.001 s e: nothing; defer in P/A
        0.002 s f: P/A -> P/B; exit P/A; enter P/B
        0.002 s e: P -> Q; exit P/B, P; enter Q
        0.002 s g: dropped
        ",
    );
}

#[test]
fn r16_a_transition_takes_what_another_state_defers() {
    check_with(
        Semantics::yase(),
        DEFERRING,
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/A; exit P/START; enter P/A
        0.001 s e: P -> Q; exit P/A, P; enter Q
        ",
    );
}

#[test]
fn r26_a_transition_inside_the_deferring_state_takes_the_event() {
    check_with(
        Semantics::uml(),
        "
        START
        P | defer=e
          START
          A
          B
        c/START -> P
        P/START -> A
        A -> B : e
        ",
        "1 e; 2 e; 3",
        "
        0.000 s start; then START -> P + P/START -> P/A; enter c, P, P/A
        0.001 s e: P/A -> P/B; exit P/A; enter P/B
        0.002 s e: nothing; defer in P
        ",
    );
}

const STOPPING: &str = "
    START
    P | exit=raise(xp)
      START
      A | exit=raise(xa)
      x stop
    c/START -> P
    P/START -> A
    A -> stop : e / raise(t)
    ";

#[test]
fn r27_what_the_segment_to_terminate_leaves_is_left() {
    check_with(
        Semantics::uml(),
        STOPPING,
        "1 e; 2",
        "
        0.000 s start; then START -> P + P/START -> P/A; enter c, P, P/A
        0.001 s e: P/A -> P/stop; exit P/A; do raise(xa) (exit P/A), raise(t) (P/A -> P/stop)
        ",
    );
}

#[test]
fn r13_terminate_leaves_nothing() {
    check_with(
        Semantics::yase(),
        STOPPING,
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/A; exit P/START; enter P/A
        0.001 s e: P/A -> P/stop; do raise(t) (P/A -> P/stop)
        ",
    );
}

/// The codes of the errors under two semantics.
fn codes(chart: &str) -> [Vec<&'static str>; 2] {
    [Semantics::yase(), Semantics::uml()].map(|semantics| {
        let vocabulary = yase_reference::test_host::vocabulary();
        let found = yase_reference::chart(chart).compile_with(&vocabulary, semantics);
        found.err().unwrap_or_default().iter().map(|diagnostic| diagnostic.code).collect()
    })
}

#[test]
fn forms_that_only_uml_allows_are_errors_elsewhere() {
    let cases = [
        ("START\nP\n  A\nc/START -> P\n", "M01"),
        ("START\nP\n  i in\n  START\n  A\nc/START -> in\nP/START -> A\n", "M06"),
        ("START\nP | run\n  START\n  A\nc/START -> P\nP/START -> A\n", "E0503"),
        (
            "START\nP\n  START\n  A\n  o out\nZ\nc/START -> P\nP/START -> A\nout -> Z\nP -> out {internal} : e\n",
            "M03",
        ),
    ];
    for (chart, code) in cases {
        assert_eq!(codes(chart), [vec![code], vec![]], "{chart}");
    }
    let region = "START\n& P\n  one | run\n    START\n    A\n  two\nc/START -> P\none/START -> A\n";
    assert_eq!(codes(region), [vec!["E0503"], vec!["E0503"]], "a region is not a state of UML");
}

#[test]
fn m01_a_composite_without_start_counts_as_complete() {
    check_with(
        Semantics::uml(),
        "
        START
        P
          A
        Z
        c/START -> P
        P -> Z : / raise(t)
        ",
        "1",
        "
        0.000 s start; then START -> P; enter c, P
        0.000 s -: P -> Z; exit P; do raise(t) (P -> Z); enter Z
        0.000 s t: dropped
        ",
    );
}

#[test]
fn e0503_a_composite_runs_its_activity_beside_those_of_its_children() {
    check_with(
        Semantics::uml(),
        "
        START
        P | run=outer | for=30ms
          START
          A | run | for=10ms
          B | run | for=5ms
          END
        Z
        c/START -> P
        P/START -> A
        A -> B
        B -> P/END
        P -> Z
        ",
        "50",
        "
        0.000 s start; then START -> P + P/START -> P/A; enter c, P, P/A
        start A
        start outer
        A returns Done
        0.010 s -: P/A -> P/B; exit P/A; enter P/B
        start B
        B returns Done
        0.015 s -: P/B -> P/END; exit P/B; enter P/END
        outer returns Done
        0.030 s -: P -> Z; exit P/END, P; enter Z
        ",
    );
}
