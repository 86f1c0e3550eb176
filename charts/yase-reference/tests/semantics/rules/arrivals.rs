//! R12: JOINs at which each region arrives by itself.

use yase::{Chooser, CompletionTrigger, Firing, JoinMode, Machine, TransitionToAncestor};

use crate::rules::{check_with, with};
use yase_reference::test_host::TestHost;
use yase_reference::{chart, script};

/// `one` is complete without an active child, and can arrive when the AND is left and entered
/// again.
const TWICE: &str = "
    START
    & both
      one
        START
        A
      two
        START
        B
    > j
    E
    c/START -> both
    one/START -> A
    two/START -> B
    A -> one : f
    one -> j : [A.n == 1]
    two -> j
    both -> both : [A.n == 1] / A.n = 2
    j -> E
";

#[test]
fn r12_a_region_that_is_entered_again_while_it_arrives_keeps_what_is_in_it() {
    let semantics = with(|it| {
        it.join = JoinMode::Each;
        it.firing = Firing::Phases;
        it.eventless = CompletionTrigger::Always;
        it.ancestor = TransitionToAncestor::Completed;
    });
    check_with(
        semantics,
        TWICE,
        "1 f; 2 A=1; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        0.001 s f: both/one/A -> both/one; exit both/one/A
        0.002 s -: both/one -> j, both -> both; exit both/one, both/two/B, both/two, both; do A.n = 2 (both -> both); enter both, both/one, both/one/START, both/two, both/two/START
        0.002 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        ",
    );
}

/// The random draws, in order: the number of alternatives of each.
fn draws(join: JoinMode) -> Vec<u32> {
    let chart = chart(
        "
        START
        & both
          one
            START
            A
          two
            START
            B
        > j
        E
        X
        Y
        c/START -> both
        one/START -> A
        two/START -> B
        one -> X {w0.5}
        one -> Y {w0.5}
        B -> X {w0.4}
        B -> X {w0.3}
        B -> Y {w0.3}
        one -> j
        two -> j
        j -> E
        ",
    );
    let semantics = with(|it| {
        it.join = join;
        it.eventless = CompletionTrigger::Quiescent;
    });
    let mut machine = Machine::new(script::compile_with(&chart, semantics));
    machine.set_chooser(Chooser::scripted(vec![0]));
    let mut host = TestHost::new(&chart);
    script::run(&mut machine, &script::Script::parse("1"), &mut host);
    machine.chooser().choices().iter().map(|&(_, of)| of).collect()
}

#[test]
fn r12_what_lies_in_other_sources_is_looked_at_first_only_if_all_are_joined_together() {
    assert_eq!(draws(JoinMode::Each), [2, 3]);
    assert_eq!(draws(JoinMode::Together), [3, 2]);
}

#[test]
fn r12_a_region_without_states_arrives_and_does_not_end_by_that() {
    let semantics = with(|it| {
        it.join = JoinMode::Each;
        it.completion_events = true;
    });
    check_with(
        semantics,
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
        A -> one/END : f
        one -> j : [A.n == 1]
        r -> j
        j -> E
        ",
        "1 f; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/r
        0.000 s -: both/one/START -> both/one/A, both/r -> j; exit both/one/START; enter both/one/A
        0.001 s f: both/one/A -> both/one/END; exit both/one/A; enter both/one/END
        0.001 s done.state.one: dropped
        ",
    );
}
