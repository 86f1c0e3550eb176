//! R4 to R8: events, guards, paths, and who wins.

use yase::{FailureEvents, Semantics};

use crate::rules::{check, check_with, compare, refusal, with};

#[test]
fn r04_a_micro_step_takes_one_occurrence_or_none() {
    check(
        "
        START
        A
        B
        C
        c/START -> A
        A -> B : e
        B -> C : e
        ",
        "1 e; 1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> B; exit A; enter B
        0.001 s e: B -> C; exit B; enter C
        ",
    );
}

#[test]
fn r04_a_trigger_names_one_event_several_all_but_one_or_any() {
    check(
        "
        START
        A
        c/START -> A
        A -> A {internal,!3} : e | f
        A -> A {internal,!2} : not g
        A -> A {internal,!1} : * / raise(any)
        ",
        "1 f; 2 h; 3 g; 4",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s f: A -> A
        0.002 s ?: A -> A
        0.003 s g: A -> A; do raise(any) (A -> A)
        0.003 s any: A -> A
        ",
    );
}

#[test]
fn r04_not_and_any_need_an_event() {
    check(
        "
        START
        A
        B
        c/START -> A
        A -> B : not e
        A -> B : *
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> B; exit A; enter B
        ",
    );
}

#[test]
fn r04_each_arrival_of_a_message_is_one_occurrence() {
    check(
        "
        START
        A
        c/START -> A
        A -> A {internal} : B
        ",
        "1 B=1; 1 B=2; 1 C=3; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s b: A -> A
        0.001 s b: A -> A
        ",
    );
}

#[test]
fn r05_guards_see_the_beginning_of_the_micro_step() {
    // the second segment's guard is read before the first one's action; the region on the right
    // before the left one acts
    check(
        "
        START
        & both
          one
            START
            A
            ? c1
            B
            C
          two
            START
            D
            E
        c/START -> both
        one/START -> A
        two/START -> D
        A -> c1 : e / A.n = 5
        c1 -> B : [A.n == 5]
        c1 -> C
        D -> E : e [In(A)]
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/D; exit both/one/START, both/two/START; enter both/one/A, both/two/D
        0.001 s e: both/one/A -> both/one/c1 -> both/one/C, both/two/D -> both/two/E; exit both/one/A, both/two/D; do A.n = 5 (both/one/A -> both/one/c1); enter both/one/C, both/two/E
        ",
    );
}

#[test]
fn r05_a_guard_that_errs_is_false_and_says_so_once_until_its_input_changes() {
    check(
        "
        START
        A
        B
        c/START -> A
        A -> B : [A.n > 0 && 1 / (A.n - 1) > 0]
        A -> A {internal} : error.guard / raise(seen)
        ",
        "1 A=1; 2 poke; 3 A=1; 4 A=0; 5 A=1; 6 A=2; 7",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        guard failed: division by zero
        0.001 s error.guard: A -> A; do raise(seen) (A -> A)
        0.001 s seen: dropped
        0.002 s ?: dropped
        guard failed: division by zero
        0.003 s error.guard: A -> A; do raise(seen) (A -> A)
        0.003 s seen: dropped
        guard failed: division by zero
        0.005 s error.guard: A -> A; do raise(seen) (A -> A)
        0.005 s seen: dropped
        0.006 s -: A -> B; exit A; enter B
        ",
    );
}

#[test]
fn r05_a_guard_that_has_succeeded_since_says_again_that_it_errs() {
    check(
        "
        START
        & both
          one
            START
            A
          two
            START
            X
            Y
        c/START -> both
        one/START -> A
        two/START -> X
        A -> A {internal} : e [In(Y) || fail() > 0]
        X -> Y : to
        Y -> X : fro
        ",
        "1 e; 2 e; 3 to; 4 e; 5 fro; 6 e; 7",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/X; exit both/one/START, both/two/START; enter both/one/A, both/two/X
        guard failed: the function failed: it always fails
        0.001 s e: dropped
        0.001 s error.guard: dropped
        0.002 s e: dropped
        0.003 s to: both/two/X -> both/two/Y; exit both/two/X; enter both/two/Y
        0.004 s e: both/one/A -> both/one/A
        0.005 s fro: both/two/Y -> both/two/X; exit both/two/Y; enter both/two/X
        guard failed: the function failed: it always fails
        0.006 s e: dropped
        0.006 s error.guard: dropped
        ",
    );
}

#[test]
fn r05_a_timer_that_a_failing_guard_reads_makes_it_say_so_again() {
    // the guard on the left reads a timer of its own blackboard; that on the right has the same
    // number on another
    check(
        "
        START
        & both
          one
            START
            A
            A2
          two
            START
            B
        c/START -> both
        one/START -> A
        two/START -> B
        A -> A2 : [fail() > 0 || v]
        A -> A {internal} : own / StartTimeout(v, 10ms)
        B -> B {internal} : other / StartTimeout(w, 30ms)
        ",
        "1 other; 5 own; 40",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        guard failed: the function failed: it always fails
        0.000 s error.guard: dropped
        0.001 s other: both/two/B -> both/two/B; do StartTimeout(w, 30ms) (both/two/B -> both/two/B)
        0.005 s own: both/one/A -> both/one/A; do StartTimeout(v, 10ms) (both/one/A -> both/one/A)
        guard failed: the function failed: it always fails
        0.005 s error.guard: dropped
        guard failed: the function failed: it always fails
        0.015 s error.guard: dropped
        ",
    );
}

#[test]
fn r05_a_message_that_has_not_arrived_is_unknown_and_does_not_fire() {
    check(
        "
        START
        A
        B
        c/START -> A
        A -> B : [A.n == 0]
        A -> B : [!(A.n == 0)]
        A -> A {internal} : e [A.n == 0 || A == NULL]
        ",
        "1 e; 2 A=0; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: A -> A
        0.002 s -: A -> B; exit A; enter B
        ",
    );
}

#[test]
fn r06_all_of_a_compound_transition_happens_or_none() {
    check(
        "
        START
        A | exit=raise(left)
        ? c1
        % j
        B
        c/START -> A
        A -> c1 : e / raise(one)
        c1 -> j : / raise(two)
        j -> B : [A.n > 0] / raise(three)
        ",
        "1 e; 2 A=1; 3 e; 4",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        0.001 s e: dropped
        0.003 s e: A -> c1 -> j -> B; exit A; do raise(left) (exit A), raise(one) (A -> c1), raise(two) (c1 -> j), raise(three) (j -> B); enter B
        0.003 s left: dropped
        0.003 s one: dropped
        0.003 s two: dropped
        0.003 s three: dropped
        ",
    );
}

#[test]
fn r06_connectors_in_a_circle_or_without_a_way_on_are_refused() {
    assert_eq!(
        refusal("START\n? a\n? b\n? d\nc/START -> a\na -> b\nb -> a\na -> d"),
        "error[M06]: connectors lead in a circle: `c/a` -> `c/b` -> `c/a`\n\
         error[M06]: no path continues from `c/d`"
    );
}

#[test]
fn r06_a_chain_of_connectors_without_end_is_refused() {
    let mut text = String::from("START\nA\n? n0\nc/START -> n0\n");
    for number in 1..300 {
        text += &format!("? n{number}\n");
    }
    for number in 1..300 {
        text += &format!("n{} -> n{number}\n", number - 1);
    }
    text += "n299 -> A";
    assert_eq!(refusal(&text), "error[M06]: more than 256 connectors follow one another at `c/n44`");
}

#[test]
fn r06_connectors_that_multiply_beyond_measure_are_refused() {
    let mut text = String::from("START\nA\n? n0\nc/START -> n0\n");
    for number in 1..24 {
        text += &format!("? n{number}\nn{} -> n{number}\nn{} -> n{number}\n", number - 1, number - 1);
    }
    text += "n23 -> A";
    assert_eq!(
        refusal(&text),
        "error[M06]: more than 1000000 compound transitions, up to those out of `c/START`"
    );
}

const NESTED: &str = "
    START
    outer
      START
      inner
        START
        A
    X
    Y
    Z
    c/START -> outer
    outer/START -> inner
    inner/START -> A
    outer -> X : e
    inner -> Y : e
";

#[test]
fn r07_the_innermost_state_with_an_enabled_transition_contributes_it() {
    let enter = "
        0.000 s start; enter c, START
        0.000 s -: START -> outer; exit START; enter outer, outer/START
        0.000 s -: outer/START -> outer/inner; exit outer/START; enter outer/inner, outer/inner/START
        0.000 s -: outer/inner/START -> outer/inner/A; exit outer/inner/START; enter outer/inner/A";
    let exits = "exit outer/inner/A, outer/inner, outer";
    check(NESTED, "1 e; 2", &format!("{enter}\n0.001 s e: outer/inner -> Y; {exits}; enter Y"));
    let chart = format!("{NESTED}    A -> Z {{!-5}} : e");
    check(&chart, "1 e; 2", &format!("{enter}\n0.001 s e: outer/inner/A -> Z; {exits}; enter Z"));
    let chart = format!("{NESTED}    A -> Z {{!-5}} : e [A.n > 0]");
    check(&chart, "1 e; 2", &format!("{enter}\n0.001 s e: outer/inner -> Y; {exits}; enter Y"));
}

const CONFLICT: &str = "
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
    X
    Y
    c/START -> both
    one/START -> A
    two/START -> C
";

fn last(chart: &str) -> String {
    yase_reference::play(&yase_reference::chart(chart), "1 e; 2").pop().unwrap()
}

#[test]
fn r08_what_is_nested_wins_and_losers_are_preempted() {
    // from the leaf in `two` outward only the AND's transition is found; it would exit what `one`
    // takes
    compare(
        &[last(&format!("{CONFLICT}    A -> B : e\n    both -> X : e"))],
        "0.001 s e: both/one/A -> both/one/B; preempt both -> X; exit both/one/A; enter both/one/B",
    );
}

#[test]
fn r08_else_the_smaller_key_wins() {
    compare(
        &[last(&format!("{CONFLICT}    C -> Y : e\n    A -> X : e"))],
        "0.001 s e: both/one/A -> X; preempt both/two/C -> Y; \
         exit both/one/A, both/one, both/two/C, both/two, both; enter X",
    );
    compare(
        &[last(&format!("{CONFLICT}    C -> Y : e\n    A -> B : e"))],
        "0.001 s e: both/one/A -> both/one/B; preempt both/two/C -> Y; exit both/one/A; enter both/one/B",
    );
}

#[test]
fn r08_what_stays_inside_conflicts_with_nothing_and_fires_first() {
    let chart =
        format!("{CONFLICT}    A -> X : e / publish_all\n    C -> C {{internal}} : e / process_messages");
    compare(
        &[last(&chart)],
        "0.001 s e: both/two/C -> both/two/C, both/one/A -> X; \
         exit both/one/A, both/one, both/two/C, both/two, both; \
         do process_messages (both/two/C -> both/two/C), publish_all (both/one/A -> X); enter X",
    );
}

#[test]
fn r05_a_guard_that_errs_is_reported_once_in_a_micro_step_however_often_it_is_read() {
    let text = "
        START
        & both
          one
            START
            A
          two
            START
            B
        ? p
        D
        c/START -> both
        one/START -> A
        two/START -> B
        A -> p : e
        B -> p : e
        p -> D : [A.n < fail()]
        ";
    let reported = |event: &str| {
        format!(
            "
            0.000 s start; enter c, START
            0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
            0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
            guard failed: the function failed: it always fails
            0.001 s e: dropped
            0.001 s {event}: dropped
            "
        )
    };
    let again = "guard failed: the function failed: it always fails\n0.002 s e: dropped\n0.002 s error.execution: dropped";
    check(text, "1 e; 2 e; 3", &format!("{}0.002 s e: dropped", reported("error.guard")));
    let every_time = with(|it| it.failures = FailureEvents::EveryTime);
    check_with(every_time, text, "1 e; 2 e; 3", &format!("{}{again}", reported("error.execution")));
}

#[test]
fn r15_what_can_step_in_another_region_keeps_no_composite_from_being_left() {
    let one = "
          one
            START
            P
              START
              A
            X";
    let two = "
          two
            START
            B
            C";
    for (first, second) in [(one, two), (two, one)] {
        let text = format!(
            "
        START
        & both{first}{second}
        c/START -> both
        one/START -> P
        P/START -> A
        two/START -> B
        P -> X : [A.n > 0]
        B -> C : [A.n > 0]
            "
        );
        let lines =
            yase_reference::script::play_with(&yase_reference::chart(&text), "1 A=1; 2", Semantics::yase());
        let last = lines.last().unwrap();
        assert!(
            last.contains("both/one/P -> both/one/X") && last.contains("both/two/B -> both/two/C"),
            "{lines:#?}"
        );
    }
}
