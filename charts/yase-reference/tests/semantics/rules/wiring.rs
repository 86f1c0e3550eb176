//! R18: what wakes a chart.

use yase::expression::EventId;
use yase::{Host, Machine, Outcome, ScopeId, Timestamp, TopicId};

use crate::rules::check;
use yase_reference::test_host::TestHost;
use yase_reference::{chart, script};

const A: TopicId = TopicId(0);
const B: TopicId = TopicId(1);
const C: TopicId = TopicId(2);

fn machine(text: &str) -> (Machine, TestHost) {
    let chart = chart(text);
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost::new(&chart);
    machine.start(Timestamp::ZERO, &mut host);
    assert!(machine.needs_step(Timestamp::ZERO), "a start is a reason to step");
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    (machine, host)
}

const WAITING: &str = "
    START
    S | run
    T
    U
    c/START -> S
    S -> T : [A.n > 0] / StartTimeout(v, 50ms), B.n = A.n
    T -> U : e
    U -> U {internal} : B
";

#[test]
fn r18_the_machine_sleeps_until_something_happens() {
    let (mut machine, mut host) = machine(WAITING);
    let activation = host.jobs[0].activation;
    assert!(!machine.needs_step(Timestamp::from_millis(1)), "an activity runs");

    machine.activity_returned(activation, Outcome::Done);
    assert!(machine.needs_step(Timestamp::from_millis(1)), "an activity has returned");
    machine.run_to_completion(Timestamp::from_millis(1), &mut host).unwrap();
    assert!(!machine.needs_step(Timestamp::from_millis(1)));

    host.send(A, 1, [ScopeId::ROOT].into_iter());
    machine.message_arrived(A, 1);
    assert!(machine.needs_step(Timestamp::from_millis(2)), "a guard reads it");
    machine.run_to_completion(Timestamp::from_millis(2), &mut host).unwrap();

    assert!(!machine.needs_step(Timestamp::from_millis(51)));
    assert_eq!(machine.next_deadline(), Some(Timestamp::from_millis(52)));
    assert!(machine.needs_step(Timestamp::from_millis(52)), "a timer expires");
    machine.run_to_completion(Timestamp::from_millis(52), &mut host).unwrap();
    assert_eq!((machine.needs_step(Timestamp::from_millis(60)), machine.next_deadline()), (false, None));

    assert!(machine.dispatch_name("e"));
    assert!(machine.needs_step(Timestamp::from_millis(60)), "an event was raised");
}

#[test]
fn r18_only_topics_that_a_guard_or_a_trigger_reads_wake_it() {
    let (mut machine, _) = machine(WAITING);
    assert_eq!([A, B, C].map(|topic| machine.reads_topic(topic)), [true, true, false]);
    machine.message_arrived(C, 1);
    machine.message_arrived(A, 0);
    assert!(!machine.needs_step(Timestamp::ZERO));
    machine.message_arrived(B, 1);
    assert!(machine.needs_step(Timestamp::ZERO));
}

#[test]
fn r18_a_message_that_arrives_while_its_region_is_locked_is_not_lost() {
    check(
        "
        START
        S | run | for=20ms
        T
        c/START -> S
        S -> T : [A.n > 0]
        ",
        "10 A=1; 30",
        "
        0.000 s start; enter c, START
        0.000 s -: START -> S; exit START; enter S
        start S
        S returns Done
        0.020 s -: S -> T; exit S; enter T
        ",
    );
}

#[test]
fn r18_what_arrives_during_a_step_makes_another_one_due() {
    let (mut machine, mut host) = machine(WAITING);
    let activation = host.jobs[0].activation;
    machine.activity_returned(activation, Outcome::Done);
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    // nothing to do: but before the caller falls asleep the message comes
    machine.message_arrived(A, 1);
    host.send(A, 1, [ScopeId::ROOT].into_iter());
    assert!(machine.needs_step(Timestamp::ZERO));
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    assert!(host.log.last().unwrap().contains("S -> T"), "{:?}", host.log);
}

#[test]
fn r18_events_by_number_or_by_name_are_the_same() {
    let (mut machine, mut host) =
        machine("START\nS\nc/START -> S\nS -> S {internal} : e\nS -> S {internal} : not e\n");
    let event: EventId = machine.chart().events().find("e").unwrap();
    machine.dispatch(event);
    assert!(machine.dispatch_name("e"));
    assert!(!machine.dispatch_name("strange"), "no expression names it, but `not e` takes it");
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    let lines: Vec<&str> = host.log.iter().skip(2).map(String::as_str).collect();
    assert_eq!(lines, ["0.000 s e: S -> S", "0.000 s e: S -> S", "0.000 s ?: S -> S"]);
    assert!(host.wants_trace());
}

#[test]
fn r14_what_ran_before_a_start_is_forgotten() {
    let chart = chart(
        "
        START
        S | run
        T
        c/START -> S
        S -> T : v
        S -> S {internal} : e / StartTimeout(v, 10ms)
        ",
    );
    let mut host = TestHost::new(&chart);
    let mut machine = Machine::new(script::compile(&chart));
    machine.start(Timestamp::ZERO, &mut host);
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    let first = host.jobs[0].activation;
    machine.activity_returned(first, Outcome::Done);
    machine.dispatch_name("e");
    machine.run_to_completion(Timestamp::ZERO, &mut host).unwrap();
    assert_eq!(machine.next_deadline(), Some(Timestamp::from_millis(10)));

    machine.start(Timestamp::from_millis(1), &mut host);
    machine.run_to_completion(Timestamp::from_millis(1), &mut host).unwrap();
    assert_eq!(machine.next_deadline(), None);
    assert_eq!(host.jobs.len(), 2, "the activity is started again");
    machine.start(Timestamp::from_millis(2), &mut host);
    machine.run_to_completion(Timestamp::from_millis(2), &mut host).unwrap();
    assert_eq!(host.jobs.len(), 3, "also if it has not returned");
}
