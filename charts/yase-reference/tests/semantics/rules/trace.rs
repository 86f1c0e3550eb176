//! R23: a record for every micro-step.

use yase::statechart::TransitionId;
use yase::{
    ActionLocation, Activation, CompiledChart, Host, Machine, MicroStepCause, NodeId, Timestamp, TraceRecord,
};

use crate::rules::compare;
use yase_reference::test_host::TestHost;
use yase_reference::{chart, script};

const CHART: &str = "
    START
    A | exit=raise(left)
    ? c1
    B | entry=raise(entered)
    c/START -> A
    A -> c1 : e [A.n > 0] / raise(on the way)
    c1 -> B : [A.n > 5]
    c1 -> A
";

/// Keeps what records hold.
#[derive(Default)]
struct Listener {
    occasions: Vec<MicroStepCause>,
    exits: Vec<NodeId>,
    entries: Vec<NodeId>,
    effects: Vec<ActionLocation>,
    segments: Vec<TransitionId>,
    guards: Vec<(TransitionId, Option<bool>)>,
    times: Vec<Timestamp>,
}

impl Host for Listener {
    fn start(&mut self, _: Activation) {}

    fn cancel(&mut self, _: Activation) {}

    fn stop(&mut self, _: Activation) {}

    fn wants_trace(&self) -> bool {
        true
    }

    fn trace(&mut self, chart: &CompiledChart, record: &TraceRecord<'_>) {
        self.times.push(record.time);
        self.occasions.push(record.cause);
        self.exits.extend(record.exits);
        self.entries.extend(record.entries);
        self.effects.extend(record.effects);
        self.guards.extend(record.guards);
        self.segments.extend(record.selected.iter().flat_map(|&compound| chart.segments(compound)));
    }
}

#[test]
fn r23_a_record_names_what_was_taken_left_done_and_entered() {
    let chart = chart(
        &CHART.replace("on the way", "through").replace("[A.n > 0]", "").replace("[A.n > 5]", "[A == NULL]"),
    );
    let mut machine = Machine::new(script::compile(&chart));
    let mut listener = Listener::default();
    let node = |path: &str| chart::find(&chart, path);
    machine.start(Timestamp::from_millis(3), &mut listener);
    machine.dispatch_name("e");
    machine.run_to_completion(Timestamp::from_millis(5), &mut listener).unwrap();
    let event = |name: &str| MicroStepCause::Event(machine.chart().events().find(name).unwrap());
    assert_eq!(
        listener.occasions,
        [
            MicroStepCause::Start,
            MicroStepCause::Eventless,
            event("e"),
            event("left"),
            event("through"),
            event("entered")
        ]
    );
    assert_eq!(listener.times[0], Timestamp::from_millis(3));
    assert!(listener.times[1..].iter().all(|&time| time == Timestamp::from_millis(5)));
    assert_eq!(listener.exits, [node("START"), node("A")]);
    assert_eq!(listener.entries, [node("c"), node("START"), node("A"), node("B")].map(|node| node));
    assert_eq!(listener.segments, [0, 1, 2].map(TransitionId));
    assert_eq!(
        listener.effects,
        [
            ActionLocation::Exit(node("A")),
            ActionLocation::Transition(TransitionId(1)),
            ActionLocation::Entry(node("B"))
        ]
    );
    assert_eq!(listener.guards, [(TransitionId(2), Some(true))]);
}

#[test]
fn r23_a_record_shows_the_guards_that_were_read() {
    let chart = chart(&CHART.replace("on the way", "through"));
    let mut machine = Machine::new(script::compile(&chart));
    let mut host = TestHost { reads: true, ..TestHost::new(&chart) };
    script::run(&mut machine, &script::Script::parse("1 A=0; 2 e; 2 A=3; 3 e; 4"), &mut host);
    compare(
        &host.log[2..],
        "0.002 s e: A -> c1 -> A; exit A; do raise(left) (exit A), raise(through) (A -> c1); enter A; read A -> c1 = true, c1 -> B = false
         0.002 s left: dropped
         0.002 s through: dropped
         0.003 s e: A -> c1 -> A; exit A; do raise(left) (exit A), raise(through) (A -> c1); enter A; read A -> c1 = true, c1 -> B = false
         0.003 s left: dropped
         0.003 s through: dropped",
    );
}

#[test]
fn r23_nothing_is_written_down_for_a_host_that_does_not_want_it() {
    struct Deaf;
    impl Host for Deaf {
        fn start(&mut self, _: Activation) {}
        fn cancel(&mut self, _: Activation) {}
        fn stop(&mut self, _: Activation) {}
        fn trace(&mut self, _: &CompiledChart, record: &TraceRecord<'_>) {
            panic!("{record:?}");
        }
    }
    let chart = chart(&CHART.replace("on the way", "through"));
    let mut machine = Machine::new(script::compile(&chart));
    machine.start(Timestamp::ZERO, &mut Deaf);
    machine.dispatch_name("e");
    assert_eq!(machine.run_to_completion(Timestamp::ZERO, &mut Deaf).unwrap().micro_steps, 2);
}
