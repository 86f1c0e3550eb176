//! R10 to R13: leaving, acting, entering, and the end.

use yase::{Activation, Host, Machine, Status, Timestamp};

use crate::rules::{check, compare};
use yase_reference::test_host::TestHost;
use yase_reference::{chart, script};

#[test]
fn r10_exits_innermost_first_then_effects_then_entries_outermost_first() {
    check(
        "
        START
        outer | exit=raise(x1)
          START
          & both | exit=raise(x2)
            one | exit=raise(x3)
              START
              A | exit=raise(x4)
            two
              START
              B | exit=raise(x5)
        other | entry=raise(n1)
          START
          & pair | entry=raise(n2)
            three | entry=raise(n3)
              START
              C
            four
              START
              D | entry=raise(n4)
        c/START -> outer
        outer/START -> both
        one/START -> A
        two/START -> B
        three/START -> C
        four/START -> D
        A -> D : e / raise(t)
        c/outer -> c/outer {internal,!-1} : * / process_messages
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> outer; exit START; enter outer, outer/START
        0.000 s -: outer/START -> outer/both; exit outer/START; enter outer/both, outer/both/one, outer/both/one/START, outer/both/two, outer/both/two/START
        0.000 s -: outer/both/one/START -> outer/both/one/A, outer/both/two/START -> outer/both/two/B; exit outer/both/one/START, outer/both/two/START; enter outer/both/one/A, outer/both/two/B
        0.001 s e: outer -> outer, outer/both/one/A -> other/pair/four/D; exit outer/both/one/A, outer/both/one, outer/both/two/B, outer/both/two, outer/both, outer; do process_messages (outer -> outer), raise(x4) (exit outer/both/one/A), raise(x3) (exit outer/both/one), raise(x5) (exit outer/both/two/B), raise(x2) (exit outer/both), raise(x1) (exit outer), raise(t) (outer/both/one/A -> other/pair/four/D), raise(n1) (entry other), raise(n2) (entry other/pair), raise(n3) (entry other/pair/three), raise(n4) (entry other/pair/four/D); enter other, other/pair, other/pair/three, other/pair/three/START, other/pair/four, other/pair/four/D
        0.001 s -: other/pair/three/START -> other/pair/three/C; exit other/pair/three/START; enter other/pair/three/C
        0.001 s x4: dropped
        0.001 s x3: dropped
        0.001 s x5: dropped
        0.001 s x2: dropped
        0.001 s x1: dropped
        0.001 s t: dropped
        0.001 s n1: dropped
        0.001 s n2: dropped
        0.001 s n3: dropped
        0.001 s n4: dropped
        ",
    );
}

#[test]
fn r10_each_transition_exits_acts_and_enters_before_the_next_does() {
    let log = script::play(
        &chart(
            "
            START
            & both
              one
                START
                A | exit=raise(a)
                B | entry=raise(b)
              two
                START
                C | exit=raise(c)
                D | entry=raise(d)
            c/START -> both
            one/START -> A
            two/START -> C
            A -> B : e
            C -> D : e
            ",
        ),
        "1 e; 2",
    );
    let raised: Vec<&str> = log.iter().filter_map(|line| line.strip_suffix(": dropped")).collect();
    assert_eq!(raised, ["0.001 s a", "0.001 s b", "0.001 s c", "0.001 s d"]);
}

#[test]
fn r10_no_state_exits_or_enters_twice_in_a_transition_across_levels() {
    let log = script::play(
        &chart(
            "
            START
            P
              START
              Q
                START
                A
            R
              START
              S
                START
                B
            c/START -> P
            P/START -> Q
            Q/START -> A
            R/START -> S
            S/START -> B
            A -> B : e
            B -> A : e
            ",
        ),
        "1 e; 2 e; 3",
    );
    compare(
        &log[4..],
        "0.001 s e: P/Q/A -> R/S/B; exit P/Q/A, P/Q, P; enter R, R/S, R/S/B
         0.002 s e: R/S/B -> P/Q/A; exit R/S/B, R/S, R; enter P, P/Q, P/Q/A",
    );
}

#[test]
fn r10_a_region_that_another_transition_has_left_does_not_fire() {
    // the AND is left by one region; the other, which takes the event too, is preempted and does
    // nothing
    let log = script::play(
        &chart(
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
            X
            c/START -> both
            one/START -> A
            two/START -> B
            A -> X : e
            B -> C : e / raise(never)
            ",
        ),
        "1 e; 2",
    );
    compare(
        &log[3..],
        "0.001 s e: both/one/A -> X; preempt both/two/B -> both/two/C; \
         exit both/one/A, both/one, both/two/B, both/two, both; enter X",
    );
}

#[test]
fn r10_entering_stops_at_start_whose_way_out_is_the_next_micro_step_of_the_same_step() {
    let chart = chart("START\nP\n  START\n  A\nB\nc/START -> B\nB -> P : e\nP/START -> A\n");
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost::new(&chart);
    machine.start(Timestamp::ZERO, &mut host);
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    machine.dispatch_name("e");
    let summary = machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    assert_eq!((summary.micro_steps, summary.transitions, summary.started), (2, 2, 0));
    compare(
        &host.log[2..],
        "0.000 s e: B -> P; exit B; enter P, P/START
         0.000 s -: P/START -> P/A; exit P/START; enter P/A",
    );
}

#[test]
fn r11_guards_of_start_are_read_after_the_action_that_led_there() {
    let log = script::play(
        &chart(
            "
            START
            A
            & both
              one
                START
                B
                C
              two
                START
                D
                E
            c/START -> A
            A -> both : e / A.n = 7
            one/START -> B : [A.n == 7]
            one/START -> C
            two/START -> D : [A.n == 7]
            two/START -> E
            ",
        ),
        "1 A=1; 2 e; 3",
    );
    let last = log.last().unwrap();
    assert!(last.contains("both/one/START -> both/one/B, both/two/START -> both/two/D;"), "{last}");
}

#[test]
fn r13_terminate_stops_without_exits_and_cancels() {
    let text = "
        START
        & both | exit=raise(never)
          one
            START
            A | run | for=20ms
          two
            START
            B | exit=raise(never)
            ongoing | run
        x stop
        c/START -> both
        one/START -> A
        two/START -> ongoing
        ongoing -> B : f
        B -> stop : e / A.n = 1
        ";
    check(
        text,
        "5 f; 10 e; 40 e",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> both; exit START; enter both, both/one, both/one/START, both/two, both/two/START
        0.000 s -: both/one/START -> both/one/A, both/two/START -> both/two/ongoing; exit both/one/START, both/two/START; enter both/one/A, both/two/ongoing
        start A
        start ongoing
        ongoing returns Ongoing
        stop ongoing
        0.005 s f: both/two/ongoing -> both/two/B; exit both/two/ongoing; enter both/two/B
        cancel A
        0.010 s e: both/two/B -> stop; do A.n = 1 (both/two/B -> stop)
        A returns Done
        ",
    );
}

#[test]
fn r13_after_terminate_nothing_fires_nor_terminate_where_another_has_left() {
    let last = |ways: &str| {
        let text = format!(
            "START\n& both\n  one\n    START\n    A\n  two\n    START\n    B\n    C\nX\nx stop\n\
             c/START -> both\none/START -> A\ntwo/START -> B\n{ways}\n"
        );
        script::play(&chart(&text), "1 e; 2").pop().unwrap()
    };
    assert_eq!(last("A -> stop : e\nB -> C : e"), "0.001 s e: both/one/A -> stop");
    assert_eq!(
        last("A -> X : e\nB -> stop : e"),
        "0.001 s e: both/one/A -> X; exit both/one/A, both/one, both/two/B, both/two, both; enter X"
    );
}

#[test]
fn r13_at_root_end_a_chart_is_finished_and_idles_until_started_again() {
    let chart = chart("START\nA\nEND\nc/START -> A\nA -> c/END : e / raise(never)\n");
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost::new(&chart);
    assert_eq!((machine.status(), machine.needs_step(Timestamp::ZERO)), (Status::Idle, false));
    for _ in 0..2 {
        machine.start(Timestamp::ZERO, &mut host);
        machine.dispatch_name("e");
        machine.dispatch_name("e");
        machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
        assert!(machine.is_finished());
        machine.dispatch_name("e");
        assert!(!machine.needs_step(Timestamp::from_millis(1)));
        assert_eq!(machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap().micro_steps, 0);
    }
    let once = "0.000 s start; enter c, START
                0.000 s -: START -> A; exit START; enter A
                0.000 s e: A -> END; exit A; do raise(never) (A -> END); enter END\n";
    compare(&host.log, &once.repeat(2));
}

#[test]
fn r13_stop_cancels_and_what_returns_later_is_not_for_the_next_run() {
    let chart = chart("START\nA | run\nB\nc/START -> A\nA -> B\n");
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost { activities: TestHost::new(&chart).activities, ..TestHost::default() };
    machine.start(Timestamp::ZERO, &mut host);
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    let first: Activation = host.jobs[0].activation;
    machine.stop(&mut host);
    assert_eq!(machine.status(), Status::Stopped);
    assert!(!machine.is_running(first.region));
    machine.start(Timestamp::ZERO, &mut host);
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    assert!(!machine.activity_returned(first, yase::Outcome::Done));
    let second = host.jobs[1].activation;
    assert!(machine.activity_returned(second, yase::Outcome::Done));
    assert!(!machine.activity_returned(second, yase::Outcome::Done));
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    assert!(machine.is_active(chart::find(&chart, "B")));
    host.cancel(first);
}

#[test]
fn r13_what_has_been_asked_to_return_is_not_asked_again() {
    let chart = chart("START\nA | run | for=50ms\nX\nc/START -> A\nA -> X {interrupts} : e\n");
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost::new(&chart);
    machine.start(Timestamp::ZERO, &mut host);
    machine.dispatch_name("e");
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    machine.stop(&mut host);
    machine.stop(&mut host);
    assert_eq!(host.log.iter().filter(|line| line.contains("cancel A")).count(), 1, "{:?}", host.log);
}
