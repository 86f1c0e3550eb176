//! The charts executed by YASE.

use std::hint::black_box;
use std::sync::Arc;

use yase::expression::{CallError, EventId, MessageSource, ScriptId, parse_actions, parse_transition};
use yase::statechart::{Node, NodeId, NodeKind, Transition};
use yase::vocabulary::{FieldEntry, MessageEntry, TopicEntry, TopicKind, ValueType};
use yase::{
    Activation, CompiledChart, FieldId, Host, Machine, ScopeId, ScriptContext, Statechart, Timestamp,
    TopicId, TraceRecord, TypeEnvironment, Value,
};

use crate::counts::{Counts, Event, FLAT, HIER, ORTHO, Toggle};

pub(crate) fn flat() -> Statechart {
    let mut chart = Statechart::new("flat");
    pair(&mut chart, Statechart::ROOT, 0, FLAT);
    chart
}

pub(crate) fn hier() -> Statechart {
    branches("hier", HIER)
}

/// Two branches of this depth; the outermost state of each leads to the innermost of the other.
pub(crate) fn branches(name: &str, depth: usize) -> Statechart {
    let mut chart = Statechart::new(name);
    let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let first = branch(&mut chart, 0..depth);
    let second = branch(&mut chart, depth..2 * depth);
    connect(&mut chart, start, first.1, "");
    connect(&mut chart, first.0, second.1, "toggle");
    connect(&mut chart, second.0, first.1, "toggle");
    chart
}

/// Nested states with these counters; returns the outermost and the innermost.
fn branch(chart: &mut Statechart, counters: std::ops::Range<usize>) -> (NodeId, NodeId) {
    let last = counters.end - 1;
    let mut nodes = vec![Statechart::ROOT];
    for counter in counters {
        let around = nodes[nodes.len() - 1];
        let kind = if counter == last { NodeKind::Basic } else { NodeKind::Or };
        let node = state(chart, around, kind, counter);
        if around != Statechart::ROOT {
            let start = chart.add(around, Node::new(NodeKind::Start, ""));
            connect(chart, start, node, "");
        }
        nodes.push(node);
    }
    (nodes[1], nodes[nodes.len() - 1])
}

pub(crate) fn ortho() -> Statechart {
    let mut chart = Statechart::new("ortho");
    let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let both = chart.add(Statechart::ROOT, Node::new(NodeKind::And, "both"));
    connect(&mut chart, start, both, "");
    for region in 0..ORTHO {
        let around = chart.add(both, Node::new(NodeKind::Or, ""));
        pair(&mut chart, around, region, ORTHO + region);
    }
    chart
}

/// Two states that alternate.
fn pair(chart: &mut Statechart, around: NodeId, first: usize, second: usize) {
    let start = chart.add(around, Node::new(NodeKind::Start, ""));
    let first = state(chart, around, NodeKind::Basic, first);
    let second = state(chart, around, NodeKind::Basic, second);
    connect(chart, start, first, "");
    connect(chart, first, second, "toggle");
    connect(chart, second, first, "toggle");
}

/// A state that counts.
pub(crate) fn state(chart: &mut Statechart, around: NodeId, kind: NodeKind, counter: usize) -> NodeId {
    let node = Node::new(kind, format!("s{counter}"));
    let entry = parse_actions(&format!("script(\"enter {counter}\")")).0;
    let exit = parse_actions(&format!("script(\"leave {counter}\")")).0;
    chart.add(around, Node { entry, exit, ..node })
}

/// The counter of the state of that name.
pub(crate) fn counter(name: &str) -> Option<usize> {
    name.strip_prefix('s')?.parse().ok()
}

pub(crate) fn connect(chart: &mut Statechart, source: NodeId, target: NodeId, text: &str) {
    let (expression, wrong) = parse_transition(text);
    assert!(wrong.is_empty(), "{wrong:?}");
    chart.connect(Transition { expression, ..Transition::new(source, target) });
}

/// One topic to read, and actions in the language of the host.
pub(crate) fn vocabulary() -> TypeEnvironment {
    let message = MessageEntry { name: "M".into(), fields: fields() };
    let topic = TopicEntry { id: TopicId(0), path: "m".into(), kind: TopicKind::State, message: "M".into() };
    TypeEnvironment {
        topics: vec![topic],
        messages: vec![message],
        scripts: true,
        ..TypeEnvironment::default()
    }
}

fn fields() -> Vec<FieldEntry> {
    let field =
        |(name, id)| FieldEntry { id: FieldId(id), name: String::from(name), kind: ValueType::Number };
    ["n", "m"].into_iter().zip(0..).map(field).collect()
}

/// A host that counts, with one blackboard of numbers.
pub(crate) struct CountingHost {
    /// The meaning of each script of the chart.
    scripts: Vec<Count>,
    pub(crate) counts: Counts,
    board: [i64; 2],
    pub(crate) traces: bool,
    traced: u64,
}

/// The effect of an action.
#[derive(Clone, Copy)]
enum Count {
    Enter(usize),
    Leave(usize),
}

impl CountingHost {
    fn new(chart: &CompiledChart) -> CountingHost {
        let count = |text: &str| match text.split_once(' ') {
            Some(("enter", state)) => Count::Enter(state.parse().expect("a number")),
            Some(("leave", state)) => Count::Leave(state.parse().expect("a number")),
            _ => panic!("what is `{text}`?"),
        };
        let scripts = chart.scripts().map(|script| count(script.text)).collect();
        CountingHost { scripts, counts: Counts::default(), board: [0; 2], traces: false, traced: 0 }
    }
}

impl Host for CountingHost {
    fn field(&self, _: ScopeId, _: &MessageSource, path: &[FieldId]) -> Value<'_> {
        match path {
            [FieldId(field)] => {
                self.board.get(*field as usize).map_or(Value::Missing, |&value| Value::Int(value))
            }
            _ => Value::Missing,
        }
    }

    fn perform(&mut self, script: ScriptId, _: ScopeId, _: &mut ScriptContext<'_>) -> Result<(), CallError> {
        match self.scripts[script.0 as usize] {
            Count::Enter(state) => self.counts.enter(state),
            Count::Leave(state) => self.counts.leave(state),
        }
        Ok(())
    }

    fn start(&mut self, _: Activation) {}
    fn cancel(&mut self, _: Activation) {}
    fn stop(&mut self, _: Activation) {}

    fn wants_trace(&self) -> bool {
        self.traces
    }

    fn trace(&mut self, _: &CompiledChart, record: &TraceRecord<'_>) {
        self.traced += black_box(record).selected.len() as u64;
    }
}

/// A YASE machine and its host.
pub(crate) struct Ours {
    pub(crate) machine: Machine,
    pub(crate) host: CountingHost,
    now: u64,
    toggle: EventId,
}

impl Ours {
    pub(crate) fn new(chart: &Statechart) -> Ours {
        let chart = Arc::new(chart.compile(&vocabulary()).expect("the chart is in order"));
        let toggle = chart.events().find("toggle").expect("it is named");
        let mut host = CountingHost::new(&chart);
        let mut machine = Machine::new(chart);
        machine.start(Timestamp::ZERO, &mut host);
        machine.run_to_completion(Timestamp::ZERO, &mut host).expect("it rests");
        host.counts = Counts::default();
        Ours { machine, host, now: 0, toggle }
    }
}

impl Toggle for Ours {
    fn handle(&mut self, event: Event) {
        // a machine whose time does not advance is stopped as a livelock
        self.now += 1;
        let now = Timestamp::from_nanos(self.now);
        match event {
            Event::Toggle => {
                self.machine.dispatch(self.toggle);
                self.machine.run_to_completion(now, &mut self.host).expect("it rests")
            }
            Event::Other => {
                assert!(!self.machine.dispatch_name("other"));
                self.machine.run_to_completion(now, &mut self.host).expect("it rests")
            }
        };
    }

    fn counts(&self) -> Counts {
        self.host.counts.clone()
    }
}
