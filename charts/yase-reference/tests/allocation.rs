//! After a warm-up, the steps of a machine do not allocate, for any feature of a chart, traced or
//! not.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]
#![allow(unsafe_code, reason = "counting allocations takes an allocator")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

use yase::expression::{CallError, MessageSource};
use yase::vocabulary::{FieldEntry, FunctionEntry, MessageEntry, TopicEntry, TopicKind, ValueType};
use yase::{
    Activation, CompiledChart, FieldId, FunctionId, Host, Machine, Outcome, ScopeId, Timestamp, TopicId,
    TraceRecord, TypeEnvironment, Value,
};

thread_local! {
    /// Each test has a thread of its own.
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: all calls are forwarded unchanged to the system allocator, which upholds the contract.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller upholds the contract of `alloc`; `layout` is passed on unchanged.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: the caller guarantees that `block` was allocated here with `layout`; `alloc` took
        // it from `System` with the same layout.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const A: TopicId = TopicId(0);

/// For each blackboard one number and one activity, and nothing that grows.
#[derive(Default)]
struct TestHost {
    traces: bool,
    boards: [i64; 8],
    jobs: [Option<Activation>; 3],
    /// Accumulates data of trace records, so that they are read.
    seen: usize,
    published: u64,
}

impl Host for TestHost {
    fn field(&self, region: ScopeId, _: &MessageSource, _: &[FieldId]) -> Value<'_> {
        Value::Int(self.boards[region.0 as usize])
    }

    fn call(&self, _: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        match arguments {
            [Value::Int(value)] => Ok(Value::Int(value * 2)),
            _ => Err(CallError::new("not a number")),
        }
    }

    fn inherit(&mut self, region: ScopeId, from: ScopeId) {
        self.boards[region.0 as usize] = self.boards[from.0 as usize];
    }

    fn assign(
        &mut self,
        region: ScopeId,
        _: TopicId,
        _: &[FieldId],
        value: Value<'_>,
    ) -> Result<(), CallError> {
        let Value::Int(value) = value else { return Err(CallError::new("not a number")) };
        self.boards[region.0 as usize] = value;
        Ok(())
    }

    fn publish_all(&mut self, _: ScopeId) {
        self.published += 1;
    }

    fn start(&mut self, activation: Activation) {
        assert!(self.jobs[activation.region.0 as usize].replace(activation).is_none());
    }

    fn cancel(&mut self, _: Activation) {}

    fn stop(&mut self, activation: Activation) {
        assert_eq!(self.jobs[activation.region.0 as usize].take(), Some(activation));
    }

    fn wants_trace(&self) -> bool {
        self.traces
    }

    fn trace(&mut self, _: &CompiledChart, record: &TraceRecord<'_>) {
        self.seen += record.selected.len() + record.exits.len() + record.effects.len() + record.entries.len();
        self.seen += record.held.len() + record.guards.len() + usize::from(record.deferred.is_some());
    }
}

fn vocabulary() -> TypeEnvironment {
    let number = FieldEntry { id: FieldId(0), name: "n".into(), kind: ValueType::Number };
    let topic = TopicEntry { id: A, path: "a".into(), kind: TopicKind::State, message: "A".into() };
    let double = FunctionEntry {
        id: FunctionId(0),
        name: "double".into(),
        parameters: vec![ValueType::Number],
        result: ValueType::Number,
    };
    TypeEnvironment {
        topics: vec![topic],
        messages: vec![MessageEntry { name: "A".into(), fields: vec![number] }],
        functions: vec![double],
        ..TypeEnvironment::default()
    }
}

/// A machine with its host.
struct Run {
    machine: Machine,
    host: TestHost,
    now: u64,
    transitions: u32,
}

impl Run {
    /// A machine of a chart, at rest for the first time.
    fn new(text: &str, traces: bool) -> Run {
        let chart =
            yase_reference::chart(text).compile(&vocabulary()).unwrap_or_else(|found| panic!("{found:?}"));
        let machine = Machine::new(Arc::new(chart));
        let host = TestHost { traces, ..TestHost::default() };
        let mut run = Run { machine, host, now: 0, transitions: 0 };
        run.machine.start(Timestamp::ZERO, &mut run.host);
        run.step(0);
        run
    }

    /// A step so many milliseconds later.
    fn step(&mut self, millis: u64) {
        self.now += millis;
        let summary =
            self.machine.run_to_completion(Timestamp::from_millis(self.now), &mut self.host).unwrap();
        self.transitions += summary.transitions;
    }

    /// An event, and the step that it leads to, a millisecond later.
    fn event(&mut self, name: &str) {
        self.machine.dispatch_name(name);
        self.step(1);
    }

    /// The activity of a region returns for good.
    fn returns(&mut self, region: usize) {
        let activation = self.host.jobs[region].take().unwrap();
        assert!(self.machine.activity_returned(activation, Outcome::Done));
        self.step(1);
    }

    /// The activity of a region returns, and is called again.
    fn is_called_again(&mut self, region: usize) {
        let activation = self.host.jobs[region].unwrap();
        assert!(self.machine.activity_returned(activation, Outcome::Ongoing));
        self.step(1);
        assert!(self.machine.activity_resumed(activation));
    }
}

/// Repeats something in a running chart, with and without a trace, and asserts that it takes so
/// many transitions each time and, after the first few times, no memory.
fn assert_allocates_nothing(text: &str, transitions: u32, mut cycle: impl FnMut(&mut Run)) {
    for traces in [false, true] {
        let mut run = Run::new(text, traces);
        (0..10).for_each(|_| cycle(&mut run));
        (run.transitions, run.host.seen) = (0, 0);
        let before = ALLOCATIONS.get();
        (0..100).for_each(|_| cycle(&mut run));
        assert_eq!(ALLOCATIONS.get() - before, 0, "allocations, traced: {traces}");
        assert_eq!(run.transitions, 100 * transitions, "the chart does what is meant");
        assert_eq!(run.host.seen > 0, traces);
    }
}

#[test]
fn the_allocator_counts() {
    let before = ALLOCATIONS.get();
    drop(std::hint::black_box(Box::new(1)));
    assert_eq!(ALLOCATIONS.get() - before, 1);
}

#[test]
fn flat() {
    let text = "
        START
        s
        t
        START -> s
        s -> t : e
        t -> s : e
    ";
    assert_allocates_nothing(text, 1, |run| run.event("e"));
}

#[test]
fn an_action_at_exit() {
    let text = "
        START
        s | exit=A.n = A.n + 1
        t
        START -> s
        s -> t : e [A.n >= 0]
        t -> s : e
    ";
    assert_allocates_nothing(text, 1, |run| run.event("e"));
}

#[test]
fn hierarchy_with_actions() {
    let text = "
        START
        a | entry=raise(f) | exit=A.n = double(A.n) + 1
          START
          b | entry=publish.A | exit=publish_all
            START
            s
            b/START -> s
          a/START -> b
        c
          START
          d
            START
            t
            d/START -> t
          c/START -> d
        START -> a
        a -> d/t : e / A.n = 0; process_messages
        c -> a/b/s : e / raise(g)
    ";
    assert_allocates_nothing(text, 1, |run| run.event("e"));
}

#[test]
fn regions() {
    let text = "
        START
        & both
          one
            START
            s1
            t1
            one/START -> s1
            s1 -> t1 : e
            t1 -> s1 : e
          two
            START
            s2
            t2
            two/START -> s2
            s2 -> t2 : e
            t2 -> s2 : e
          three
            START
            s3
            three/START -> s3
            s3 -> s3 : e
        out
        START -> both
        both -> out : leave
        out -> both : back
    ";
    assert_allocates_nothing(text, 3 + 1 + 1 + 3, |run| {
        run.event("e");
        run.event("leave");
        run.event("back");
    });
}

#[test]
fn guards_and_messages() {
    let text = "
        START
        s
        t
        ? c
        START -> s
        s -> c : Message.A / A.n = A.n + 1
        c -> t : [A.n > 100 && In(s)]
        c -> s : [A.n / 0 > 1]
        c -> t
        t -> s : e [A == NULL || In(t)]
    ";
    assert_allocates_nothing(text, 2, |run| {
        run.machine.message_arrived(A, 1);
        run.step(1);
        run.event("e");
    });
}

#[test]
fn timers() {
    let text = "
        START
        s | entry=StartTimeout(v, 10ms), StartTimeout(w, 5ms)
        t | entry=StartTimeout(v, 20ms)
        START -> s
        s -> t : v
        t -> s : [TimeoutCheck(v) && w]
    ";
    assert_allocates_nothing(text, 2, |run| {
        run.step(5);
        run.step(5);
        run.step(20);
    });
}

#[test]
fn activities() {
    let text = "
        START
        & both
          one
            START
            s | run
            t | run
            one/START -> s
            s -> t
            t -> s
          two
            START
            u | run
            two/START -> u
            u -> u {interrupts} : e
        START -> both
    ";
    assert_allocates_nothing(text, 3, |run| {
        run.is_called_again(1);
        run.returns(1);
        run.event("e"); // u is asked to return, and left when it has
        run.returns(2);
        run.returns(1);
    });
}

#[test]
fn deferred_and_held_events() {
    let text = "
        START
        s | defer=e
        t | run
        u
        START -> s
        s -> t : f
        t -> u : e
        u -> s : g
    ";
    assert_allocates_nothing(text, 3, |run| {
        run.event("e"); // deferred by s
        run.event("f"); // held while t runs
        run.returns(0);
        run.event("g");
    });
}

#[test]
fn history() {
    let text = "
        START
        a
          START
          h shallow
          H deep
          b
            START
            s
            t
            b/START -> s
            s -> t : next
            t -> s : next
          d
          a/START -> b
          b -> d : over
          d -> b : over
        out
        START -> a
        a -> out : leave
        out -> shallow : children
        out -> deep : all
    ";
    // `b` restarts twice, with a step out of its START
    assert_allocates_nothing(text, 7 + 2, |run| {
        for event in ["next", "leave", "all", "leave", "children", "over", "over"] {
            run.event(event);
        }
    });
}

#[test]
fn forks_joins_and_choices() {
    let text = "
        START
        < fork
        > join
        ! choice
        s
        & both
          one
            START
            s1
            t1
            one/START -> s1
            s1 -> t1 : e
          two
            START
            s2
            t2
            two/START -> s2
            s2 -> t2 : e
        START -> s
        s -> fork : e
        fork -> both/one/t1
        fork -> both/two/s2
        both/one/t1 -> join
        both/two/t2 -> join
        join -> choice : / A.n = A.n + 1
        choice -> s : [A.n > 1000000]
        choice -> s
    ";
    assert_allocates_nothing(text, 3, |run| {
        run.event("e");
        run.event("e");
    });
}
