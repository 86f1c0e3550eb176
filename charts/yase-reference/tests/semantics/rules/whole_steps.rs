//! A run-to-completion step in one call does what it does one micro-step at a time, traced or not.

use std::time::Duration;

use yase::{Machine, Timestamp};

use crate::rules::check;
use yase_reference::chart;
use yase_reference::script::{self, ByMicroSteps, Interpreter, Script};
use yase_reference::test_host::TestHost;

/// Plays a script in whole steps and in micro-steps, and returns the log, guards included.
fn with_reads(text: &str, script: &str) -> Vec<String> {
    let (chart, script) = (chart(text), Script::parse(script));
    let played = |machine: &mut dyn Play| {
        let mut host = TestHost { reads: true, ..TestHost::new(&chart) };
        machine.play(&script, &mut host);
        host.log
    };
    let compiled = script::compile(&chart);
    let whole = played(&mut Machine::new(compiled.clone()));
    assert_eq!(whole, played(&mut ByMicroSteps(Machine::new(compiled))));
    whole
}

trait Play {
    fn play(&mut self, script: &Script, host: &mut TestHost);
}

impl<T: Interpreter> Play for T {
    fn play(&mut self, script: &Script, host: &mut TestHost) {
        script::run(self, script, host);
    }
}

#[test]
fn r23_guards_that_are_read_stand_in_the_record() {
    let text = "
        START
        A
        B
        c/START -> A
        A -> B : e [A.n > 0]
        A -> A {internal} : e [A.n < 0]
        A -> A {internal,!-1} : e [false]
        B -> A : e
    ";
    let log = with_reads(text, "1 A=0; 2 e; 3 A=1; 4 e; 5 e; 6");
    let reported: Vec<&str> = log[2..].iter().map(|line| line.trim()).collect();
    assert_eq!(
        reported,
        [
            "0.002 s e: dropped; read A -> B = false, A -> A = false",
            "0.004 s e: A -> B; exit A; enter B; read A -> B = true",
            "0.005 s e: B -> A; exit B; enter A",
        ]
    );
}

#[test]
fn r03_a_guard_that_failed_is_read_again_and_reported_again_when_what_it_reads_has_changed() {
    check(
        "
        START
        A
        c/START -> A
        A -> A {internal} : e [1 / A.n > 0] / raise(f)
        A -> A {internal} : error.guard
        ",
        "1 A=0; 2 e; 3 e; 4 A=0; 5 e; 6 A=1; 7 e; 8",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        guard failed: division by zero
        0.002 s e: dropped
        0.002 s error.guard: A -> A
        0.003 s e: dropped
        guard failed: division by zero
        0.005 s e: dropped
        0.005 s error.guard: A -> A
        0.007 s e: A -> A; do raise(f) (A -> A)
        0.007 s f: dropped
        ",
    );
}

#[test]
fn r21_a_timer_that_was_over_long_ago_expires_in_the_next_step() {
    let chart = chart(
        "
        START
        A
        B
        C
        c/START -> A
        A -> B : set / StartTimeout(v, 10ms)
        B -> C : e
        C -> A : v
        ",
    );
    for silent in [false, true] {
        let mut host = TestHost { silent, ..TestHost::new(&chart) };
        let mut machine = Machine::new(script::compile(&chart));
        machine.start(Timestamp::ZERO, &mut host);
        machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
        machine.dispatch_name("set");
        machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
        assert_eq!(machine.next_deadline(), Some(Timestamp::from_millis(10)));
        machine.dispatch_name("e");
        let late = Timestamp::ZERO + Duration::from_millis(25);
        let summary = machine.run_to_completion(late, &mut host).unwrap();
        assert_eq!((summary.transitions, machine.next_deadline()), (2, None), "B -> C at e, C -> A at v");
    }
}

#[test]
fn r13_beside_others_nothing_fires_after_the_end_of_the_chart() {
    let chart = chart(
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
            x stop
          three
            START
            E
            F
        c/START -> both
        one/START -> A
        two/START -> C
        three/START -> E
        A -> B : go
        C -> stop : go
        E -> F : go
        ",
    );
    let played = [false, true].map(|silent| {
        let mut host = TestHost { silent, ..TestHost::new(&chart) };
        let mut machine = Machine::new(script::compile(&chart));
        machine.start(Timestamp::ZERO, &mut host);
        machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
        machine.dispatch_name("go");
        let summary = machine.run_to_completion(Timestamp::from_millis(1), &mut host).unwrap();
        (summary.transitions, machine.status(), machine.configuration())
    });
    assert_eq!(played[0], played[1]);
    assert_eq!((played[1].0, played[1].1), (2, yase::Status::Stopped), "the third does not fire any more");
}

#[test]
fn r10_what_leaves_nothing_does_not_fire_when_another_has_left_its_source_before() {
    // the transition of `P` comes first, in the order of the document
    check(
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
          X
        c/START -> P
        P/START -> both
        one/START -> A
        two/START -> B
        A -> A {internal} : e / raise(never)
        P -> X {internal} : e
        ",
        "1 e; 2",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> P; exit START; enter P, P/START
        0.000 s -: P/START -> P/both; exit P/START; enter P/both, P/both/one, P/both/one/START, P/both/two, P/both/two/START
        0.000 s -: P/both/one/START -> P/both/one/A, P/both/two/START -> P/both/two/B; exit P/both/one/START, P/both/two/START; enter P/both/one/A, P/both/two/B
        0.001 s e: P -> P/X; exit P/both/one/A, P/both/one, P/both/two/B, P/both/two, P/both; enter P/X
        ",
    );
}

#[test]
fn r14_what_an_event_led_to_goes_on_without_an_event() {
    let text = "
        START
        A
        B
        & both
          one
            START
            C
            D
            F
          two
            START
            G
            H
            I
        c/START -> A
        A -> B : e
        B -> both : [true]
        one/START -> C
        two/START -> G
        C -> D : e
        D -> F : [true]
        G -> H : e
        H -> I : [true]
    ";
    let chart = chart(text);
    for silent in [false, true] {
        let mut host = TestHost { silent, ..TestHost::new(&chart) };
        let mut machine = Machine::new(script::compile(&chart));
        machine.start(Timestamp::ZERO, &mut host);
        machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
        let counts = [1, 2].map(|millis| {
            machine.dispatch_name("e");
            let summary = machine.run_to_completion(Timestamp::from_millis(millis), &mut host).unwrap();
            (summary.micro_steps, summary.transitions)
        });
        assert_eq!(counts, [(3, 4), (2, 4)]);
        machine.start(Timestamp::ZERO, &mut host);
        machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
        machine.dispatch_name("e");
        machine.dispatch_name("e");
        let summary = machine.run_to_completion(Timestamp::from_millis(1), &mut host).unwrap();
        assert_eq!((summary.micro_steps, summary.transitions), (5, 8));
    }
}

#[test]
fn r10_what_one_state_does_at_an_event_says_nothing_of_others() {
    let text = "
        A
        START
        B
        & both
          one
            START
            C
          two
            START
            F
        D
        c/START -> A
        A -> B : e
        B -> both : e
        one/START -> C
        two/START -> F
        both -> D : e
    ";
    let chart = chart(text);
    for silent in [false, true] {
        let mut host = TestHost { silent, ..TestHost::new(&chart) };
        let mut machine = Machine::new(script::compile(&chart));
        machine.start(Timestamp::ZERO, &mut host);
        machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
        let transitions = [1, 2, 3].map(|millis| {
            machine.dispatch_name("e");
            machine.run_to_completion(Timestamp::from_millis(millis), &mut host).unwrap().transitions
        });
        assert_eq!(transitions, [1, 3, 1]);
    }
}

#[test]
fn r03_a_guard_that_failed_is_reported_again_when_its_own_blackboard_was_written_and_not_when_another_topic_was()
 {
    check(
        "
        START
        A
        c/START -> A
        A -> A {internal} : e [1 / A.n > 0]
        A -> A {internal} : w / A.n = 0
        A -> A {internal} : v / B.n = 1
        ",
        "1 A=0; 2 e; 3 v; 4 e; 5 w; 6 e; 7 B=1; 8 e; 9",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> A; exit START; enter A
        guard failed: division by zero
        0.002 s e: dropped
        0.002 s error.guard: dropped
        0.003 s v: A -> A; do B.n = 1 (A -> A)
        0.004 s e: dropped
        0.005 s w: A -> A; do A.n = 0 (A -> A)
        guard failed: division by zero
        0.006 s e: dropped
        0.006 s error.guard: dropped
        0.008 s e: dropped
        ",
    );
}

/// The effect of one call: the number of micro-steps, and the resulting states.
fn handled(prepare: impl Fn(&mut Machine), at: u64) -> (u32, String) {
    let text = "
        START
        S | entry=StartTimeout(v, 10ms)
        A
        B
        c/START -> S
        S -> A : e
        A -> B : v
        S -> B : f
    ";
    let chart = chart(text);
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost { silent: true, ..TestHost::new(&chart) };
    machine.start(Timestamp::ZERO, &mut host);
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    prepare(&mut machine);
    machine.dispatch_name("e");
    let summary = machine.run_to_completion(Timestamp::from_millis(at), &mut host).unwrap();
    let leaf = machine.configuration().pop().unwrap();
    (summary.micro_steps, machine.chart().short_path(leaf))
}

#[test]
fn r21_an_event_is_taken_before_an_expiry_of_the_same_step() {
    assert_eq!(handled(|_| {}, 9), (1, "A".to_owned()));
    for at in [10, 12] {
        assert_eq!(handled(|_| {}, at), (2, "B".to_owned()), "at {at} ms");
    }
}

#[test]
fn r04_an_event_waits_for_those_that_came_before() {
    let before = |machine: &mut Machine| assert!(machine.dispatch_name("f"));
    assert_eq!(handled(before, 5), (2, "B".to_owned()));
}
