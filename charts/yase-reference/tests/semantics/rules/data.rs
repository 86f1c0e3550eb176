//! R19 and R20: blackboards, and the activities that work on them.

use yase::{Delivery, Semantics};

use crate::rules::{check, check_with, compare};
use yase_reference::test_host::TestHost;
use yase_reference::{chart, script};

/// Plays a script and gives every line, with those of the blackboards, of a chart whose text begins
/// at margin zero.
pub(crate) fn verbose(text: &str, script: &str, semantics: Semantics) -> Vec<String> {
    let chart = chart(text);
    let mut machine = yase::Machine::new(script::compile_with(&chart, semantics));
    let mut host = TestHost { verbose: true, ..TestHost::new(&chart) };
    script::run(&mut machine, &script::Script::parse(script), &mut host);
    host.log
}

const REGIONS: &str = "
    START
    & both
      one
        START
        A | run | for=20ms
        B
      two
        START
        P
          START
          C
          D
    c/START -> both
    one/START -> A
    two/START -> P
    P/START -> C
    A -> B : [A.n > 0]
    C -> D : [A.n > 0] / B.n = A.n + 1
";

#[test]
fn r19_each_region_has_a_blackboard_which_nested_composites_share() {
    let chart = script::compile(&chart(REGIONS));
    let region = |path: &str| chart.region_of(chart.statechart().find(path).unwrap()).unwrap().0;
    assert_eq!(["c", "both", "one", "one/A", "two", "P", "C"].map(region), [0, 0, 1, 1, 2, 2, 2]);
    let regions: Vec<_> = chart
        .regions()
        .map(|region| (chart.short_path(chart.region_node(region).unwrap()), chart.parent_region(region)))
        .collect();
    let root = Some(yase::ScopeId::ROOT);
    assert_eq!(regions, [("c".into(), None), ("both/one".into(), root), ("both/two".into(), root)]);
}

#[test]
fn r19_messages_are_delivered_at_the_beginning_of_a_step_where_no_activity_runs() {
    let log = verbose(REGIONS, "10 A=4; 30", Semantics::yase());
    let from = log.iter().position(|line| line.contains("start A")).unwrap();
    compare(
        &log[from..],
        "start A
         deliver 0
         deliver 2
         B on 2 = 5
         0.010 s -: both/two/P/C -> both/two/P/D; exit both/two/P/C; do B.n = A.n + 1 (both/two/P/C -> both/two/P/D); enter both/two/P/D
         publish 2
         A returns Done
         deliver 0
         deliver 1
         deliver 2
         0.020 s -: both/one/A -> both/one/B; exit both/one/A; enter both/one/B",
    );
}

#[test]
fn r19_a_region_that_is_entered_takes_over_the_values_of_the_blackboard_it_lies_in() {
    let text = "
        START
        S
        & both
          one
            START
            A
            X
          two
            START
            & inner
              three
                START
                B
                Y
              four
                START
                Z
        c/START -> S
        S -> both : e
        one/START -> A
        A -> X : [A.n == 3]
        two/START -> inner
        three/START -> B
        four/START -> Z
        B -> Y : [A.n == 3]
    ";
    let log = verbose(text, "1 A=3; 2 e; 3", Semantics::yase());
    let inherits: Vec<&str> =
        log.iter().map(|line| line.trim()).filter(|line| line.starts_with("inherit")).collect();
    assert_eq!(inherits, ["inherit 1 from 0", "inherit 2 from 0", "inherit 3 from 2", "inherit 4 from 2"]);
    assert!(log.iter().any(|line| line.contains("both/one/A -> both/one/X")), "{log:#?}");
    assert!(log.iter().any(|line| line.contains("three/B -> both/two/inner/three/Y")), "{log:#?}");
}

#[test]
fn r19_what_an_action_writes_is_seen_there_at_once_and_by_others_in_the_next_step() {
    check(
        "
        START
        & both
          one
            START
            A
            A2
            A3
          two
            START
            C
            C2
        c/START -> both
        one/START -> A
        two/START -> C
        A -> A2 : e / A.n = 1
        A2 -> A3 : [A.n == 1]
        C -> C2 : [A.n == 1]
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/C; exit both/one/START, both/two/START; enter both/one/A, both/two/C
        0.001 s e: both/one/A -> both/one/A2; exit both/one/A; do A.n = 1 (both/one/A -> both/one/A2); enter both/one/A2
        0.001 s -: both/one/A2 -> both/one/A3; exit both/one/A2; enter both/one/A3
        0.001 s -: both/two/C -> both/two/C2; exit both/two/C; enter both/two/C2
        ",
    );
}

#[test]
fn r19_what_was_written_is_published_once_at_the_end_of_the_step_or_where_publish_all_stands() {
    let text = "
        START
        S
        T
        U
        c/START -> S
        S -> T : e / A.n = 1, B.n = 2
        T -> U : / A.n = 3
        S -> U : f / A.n = 1, publish_all
        S -> U : g / publish.C
    ";
    let published = |script: &str| -> Vec<String> {
        let log = verbose(text, script, Semantics::yase());
        let is_write = |line: &&str| line.starts_with("publish") || line.contains(" on 0 = ");
        log.iter().map(|line| line.trim()).filter(is_write).map(str::to_owned).collect()
    };
    assert_eq!(published("1 e; 2"), ["A on 0 = 1", "B on 0 = 2", "A on 0 = 3", "publish 0"]);
    assert_eq!(published("1 f; 2"), ["A on 0 = 1", "publish 0"]);
    assert_eq!(published("1 g; 2"), ["publish 0"]);
    assert_eq!(published("1 h; 2"), [] as [&str; 0]);
}

const REQUEST: &str = "
    START
    S
    T
    U
    c/START -> S
    S -> T : e / process_messages, B.n = A.n
    T -> U : [B.n == 7]
";

#[test]
fn r19_process_messages_delivers_where_it_stands_and_explicit_delivery_only_there() {
    let mut semantics = Semantics::yase();
    semantics.delivery = Delivery::Explicit;
    let log = verbose(REQUEST, "1 A=7; 2 e; 3", semantics);
    compare(
        &log,
        "0.000 s start; enter c, START
         0.000 s -: START -> S; exit START; enter S
         deliver 0
         B on 0 = 7
         0.002 s e: S -> T; exit S; do process_messages, B.n = A.n (S -> T); enter T
         0.002 s -: T -> U; exit T; enter U
         publish 0",
    );
    let guarded = REQUEST.replace("e / process", "e [A.n == 7] / process");
    let log = verbose(&guarded, "1 A=7; 2 e; 3", semantics);
    assert!(log.last().unwrap().contains("e: dropped"), "{log:?}");
    let log = verbose(&guarded, "1 A=7; 2 e; 3", Semantics::yase());
    assert!(log.iter().any(|line| line.contains("e: S -> T")), "{log:?}");
}

#[test]
fn r19_an_action_that_cannot_be_done_says_so_and_the_others_go_on() {
    check(
        "
        START
        S
        T
        c/START -> S
        S -> T : e / A.n = C.n, A.n = 2000000, A.n = 1 / 0, raise(last)
        T -> T {internal} : error.action
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> S; exit START; enter S
        action failed: the value depends on a message that has not arrived
        action failed: the value cannot be assigned: too large
        action failed: division by zero
        0.001 s e: S -> T; exit S; do A.n = C.n, A.n = 2000000, A.n = 1 / 0, raise(last) (S -> T); enter T
        0.001 s error.action: T -> T
        0.001 s error.action: T -> T
        0.001 s error.action: T -> T
        0.001 s last: dropped
        ",
    );
}

#[test]
fn r20_an_activity_starts_after_the_step_that_entered_its_state_once_for_each_activation() {
    check_with(
        Semantics::yase(),
        "
        START
        S
        A | run
        B | run
        c/START -> S
        S -> A : e / raise(after)
        A -> B
        B -> A : f
        ",
        "1 e; 2 f; 3",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> S; exit START; enter S
        0.001 s e: S -> A; exit S; do raise(after) (S -> A); enter A
        0.001 s after: dropped
        start A
        A returns Done
        0.001 s -: A -> B; exit A; enter B
        start B
        B returns Done
        0.002 s f: B -> A; exit B; enter A
        start A
        A returns Done
        0.002 s -: A -> B; exit A; enter B
        start B
        B returns Done
        ",
    );
}

#[test]
fn r20_ongoing_keeps_its_state_incomplete_and_leaves_the_region_unlocked() {
    check(
        "
        START
        ongoing | run | for=5ms
        B
        c/START -> ongoing
        ongoing -> B
        ongoing -> ongoing {internal} : e
        ",
        "7 e; 16 e; 40",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> ongoing; exit START; enter ongoing
        start ongoing
        ongoing returns Ongoing
        0.007 s e: ongoing -> ongoing
        0.016 s e: nothing; hold ongoing -> ongoing
        ongoing returns Ongoing
        0.020 s e: ongoing -> ongoing
        ongoing returns Done
        0.035 s -: ongoing -> B; exit ongoing; enter B
        ",
    );
}

#[test]
fn r20_stop_is_called_when_the_state_of_an_ongoing_activity_is_left() {
    check(
        "
        START
        ongoing | run
        B
        c/START -> ongoing
        ongoing -> B : [A.n > 0]
        ongoing -> B : e
        ",
        "5 e; 40",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> ongoing; exit START; enter ongoing
        start ongoing
        ongoing returns Ongoing
        stop ongoing
        0.005 s e: ongoing -> B; exit ongoing; enter B
        ",
    );
}

#[test]
fn r20_a_failing_activity_releases_the_lock_and_can_run_again() {
    use yase::{Machine, Outcome, Timestamp};
    let chart = chart("START\nS | run\nT\nc/START -> S\nS -> T\nS -> S {internal} : error.activity\n");
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost::new(&chart);
    machine.start(Timestamp::ZERO, &mut host);
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    let activation = host.jobs[0].activation;
    assert!(machine.is_running(activation.region));
    assert!(machine.activity_returned(activation, Outcome::Failed));
    assert!(!machine.is_running(activation.region));
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    assert_eq!(host.log.last().unwrap(), "0.000 s error.activity: S -> S");
    assert!(machine.activity_resumed(activation) && machine.is_running(activation.region));
    assert!(!machine.activity_resumed(activation), "it runs already");
    assert!(machine.activity_returned(activation, Outcome::Done));
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    assert_eq!(host.log.last().unwrap(), "0.000 s -: S -> T; exit S; enter T");
    assert!(!machine.activity_resumed(activation), "its state has been left");
}

#[test]
fn r20_two_states_with_one_activity_do_not_share_a_running_flag() {
    check(
        "
        START
        & both
          one
            START
            A | run=same | for=10ms
            A2
          two
            START
            B | run=same | for=30ms
            B2
        c/START -> both
        one/START -> A
        two/START -> B
        A -> A2
        B -> B2
        ",
        "40",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/B; exit both/one/START, both/two/START; enter both/one/A, both/two/B
        start same
        start same
        same returns Done
        0.010 s -: both/one/A -> both/one/A2; exit both/one/A; enter both/one/A2
        same returns Done
        0.030 s -: both/two/B -> both/two/B2; exit both/two/B; enter both/two/B2
        ",
    );
}
