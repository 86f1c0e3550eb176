//! R21: deadlines.

use crate::rules::{check, refusal};

#[test]
fn r21_a_timer_is_over_from_its_deadline_until_it_is_set_again() {
    // a loop as in the thesis: the bare name is true while the timer was never set
    check(
        "
        START
        S | run
        c/START -> S
        S -> S : [v] / StartTimeout(v, 30ms)
        ",
        "70",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> S; exit START; enter S
        start S
        S returns Done
        0.000 s -: S -> S; exit S; do StartTimeout(v, 30ms) (S -> S); enter S
        start S
        S returns Done
        0.030 s -: S -> S; exit S; do StartTimeout(v, 30ms) (S -> S); enter S
        start S
        S returns Done
        0.060 s -: S -> S; exit S; do StartTimeout(v, 30ms) (S -> S); enter S
        start S
        S returns Done
        ",
    );
}

#[test]
fn r21_timeout_check_is_false_while_the_timer_was_never_set() {
    check(
        "
        START
        S
        T
        c/START -> S
        S -> T : [TimeoutCheck(v)]
        S -> S {internal} : e / TimeoutAction.v.20
        ",
        "10 e; 50",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> S; exit START; enter S
        0.010 s e: S -> S; do TimeoutAction.v.20 (S -> S)
        0.030 s -: S -> T; exit S; enter T
        ",
    );
}

#[test]
fn r21_deadlines_of_different_names_and_blackboards_never_meet() {
    check(
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
        c/START -> both
        one/START -> A : / StartTimeout(v, 20ms), StartTimeout(w, 30ms)
        two/START -> C : / StartTimeout(v, 10ms)
        A -> B : [v && !w]
        B -> A : [w]
        C -> D : [v]
        ",
        "50",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/C; exit both/one/START, both/two/START; do StartTimeout(v, 20ms), StartTimeout(w, 30ms) (both/one/START -> both/one/A), StartTimeout(v, 10ms) (both/two/START -> both/two/C); enter both/one/A, both/two/C
        0.010 s -: both/two/C -> both/two/D; exit both/two/C; enter both/two/D
        0.020 s -: both/one/A -> both/one/B; exit both/one/A; enter both/one/B
        0.030 s -: both/one/B -> both/one/A; exit both/one/B; enter both/one/A
        ",
    );
}

#[test]
fn r21_deadlines_survive_the_exit_of_states_and_regions() {
    check(
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
        X
        c/START -> both
        one/START -> A
        A -> A {internal} : set / StartTimeout(v, 30ms)
        A -> B : [TimeoutCheck(v)]
        two/START -> C
        both -> X : out
        X -> both : in
        ",
        "1 set; 2 out; 3 in; 50",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/C; exit both/one/START, both/two/START; enter both/one/A, both/two/C
        0.001 s set: both/one/A -> both/one/A; do StartTimeout(v, 30ms) (both/one/A -> both/one/A)
        0.002 s out: both -> X; exit both/one/A, both/one, both/two/C, both/two, both; enter X
        0.003 s in: X -> both; exit X; enter both, both/one, both/one/START, both/two, both/two/START
        0.003 s -: both/one/START -> both/one/A, both/two/START -> both/two/C; exit both/one/START, both/two/START; enter both/one/A, both/two/C
        0.031 s -: both/one/A -> both/one/B; exit both/one/A; enter both/one/B
        ",
    );
}

#[test]
fn r21_expiry_raises_an_event_that_matches_only_triggers_that_name_it() {
    check(
        "
        START
        S | entry=StartTimeout(v, 10ms)
        T
        c/START -> S
        S -> T {!1} : *
        S -> T {!1} : not e
        S -> S {internal} : e | v
        ",
        "30",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> S; exit START; do StartTimeout(v, 10ms) (entry S); enter S
        0.010 s v: S -> S
        ",
    );
}

#[test]
fn r21_setting_a_timer_again_withdraws_its_queued_expiry() {
    // the expiry is held while S runs; what returns first sets the timer again
    let chart = |action: &str| {
        format!(
            "
            START
            & both
              one
                START
                S | run | for=30ms
              two
                START
                T
            X
            c/START -> both
            one/START -> S
            two/START -> T
            T -> T {{internal}} : again / {action}
            both -> both {{internal}} : e / StartTimeout(v, 10ms)
            both -> X : v
            "
        )
    };
    let enter = "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/S, both/two/START -> both/two/T; exit both/one/START, both/two/START; enter both/one/S, both/two/T
        start S
        0.001 s e: both -> both; do StartTimeout(v, 10ms) (both -> both)
        0.011 s v: nothing; hold both -> X";
    let leave = "both -> X; exit both/one/S, both/one, both/two/T, both/two, both; enter X";
    // a timer of the same name on another blackboard is another timer
    check(
        &chart("StartTimeout(v, 100ms)"),
        "1 e; 12 again; 60",
        &format!(
            "{enter}
            0.012 s again: both/two/T -> both/two/T; do StartTimeout(v, 100ms) (both/two/T -> both/two/T)
            S returns Done
            0.030 s v: {leave}"
        ),
    );
    check(
        &chart("process_messages"),
        "1 e; 12 e; 60",
        &format!(
            "{enter}
            0.012 s e: both -> both; do StartTimeout(v, 10ms) (both -> both)
            0.022 s v: nothing; hold both -> X
            S returns Done
            0.030 s v: {leave}"
        ),
    );
}

#[test]
fn r21_a_bare_name_that_nothing_sets_on_its_blackboard_is_an_error() {
    let text = "
        START
        & both
          one
            START
            A
            B
          two
            START
            C
        c/START -> both
        one/START -> A
        two/START -> C : / StartTimeout(vv, 10ms)
        A -> B : [vv]
        ";
    let found = refusal(text);
    assert!(found.contains("`vv`") && found.contains("(from `c/both/one/A` to `c/both/one/B`)"), "{found}");
    assert_eq!(refusal(&text.replace("A -> B : [vv]", "A -> B : [vv] / StartTimeout(vv, 1ms)")), "none");
    let found = refusal(&text.replace("[vv]", "[vv] / StartTimeout(vv, 0ms)"));
    assert!(found.contains("too short"), "{found}");
}

#[test]
fn r21_a_deferred_expiry_is_withdrawn_too() {
    check(
        "
        START
        S | entry=StartTimeout(v, 10ms) | defer=v
        T
        c/START -> S
        S -> S {internal} : e / StartTimeout(v, 50ms)
        S -> T : f
        T -> T {internal} : v
        ",
        "20 e; 30 f; 90",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> S; exit START; do StartTimeout(v, 10ms) (entry S); enter S
        0.010 s v: nothing; defer in S
        0.020 s e: S -> S; do StartTimeout(v, 50ms) (S -> S)
        0.030 s f: S -> T; exit S; enter T
        0.070 s v: T -> T
        ",
    );
}

#[test]
fn r21_the_clock_never_runs_backwards() {
    use yase::{Machine, Timestamp};

    use yase_reference::{TestHost, chart, script};

    let chart = chart("START\nS\nc/START -> S\nS -> S {internal} : e / StartTimeout(v, 10ms)\n");
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost::new(&chart);
    machine.start(Timestamp::from_millis(20), &mut host);
    machine.dispatch_name("e");
    machine.run_to_completion(Timestamp::from_millis(5), &mut host).unwrap();
    assert_eq!(machine.next_deadline(), Some(Timestamp::from_millis(30)));
}

#[test]
fn r22_of_timers_that_expire_at_one_moment_the_chooser_says_which_is_first() {
    use yase::{Chooser, Machine};
    use yase_reference::{TestHost, script};
    let chart = yase_reference::chart(
        "
        START
        A | entry=StartTimeout(u, 5ms); StartTimeout(v, 5ms); StartTimeout(w, 5ms)
        START -> A
        A -> A {internal} : u | v | w
        ",
    );
    let order = |chooser| {
        let mut machine = Machine::new(script::compile(&chart));
        machine.set_chooser(chooser);
        let mut host = TestHost::new(&chart);
        script::run(&mut machine, &script::Script::parse("9"), &mut host);
        let events = host.log.iter().filter_map(|line| line.strip_prefix("0.005 s ")?.split(':').next());
        (events.collect::<String>(), machine.chooser().choices().to_vec())
    };
    assert_eq!(order(Chooser::declared()), ("uvw".into(), vec![]));
    assert_eq!(order(Chooser::scripted(vec![2, 1])), ("wvu".into(), vec![(2, 3), (1, 2)]));
}
