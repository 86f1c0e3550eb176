//! Flattened charts against the machine: for equal events and conditions both must behave equally.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

use std::sync::Arc;

use yase::expression::{
    Action, ActionKind, CallError, Expression, ExpressionKind, ScriptId, TextPosition, Trigger,
};
use yase::statechart::Statechart;
use yase::{
    Activation, ActiveStates, CompiledChart, ConflictResolution, Host, Machine, Node, NodeKind, ScopeId,
    ScriptContext, Status, Timestamp, Transition, TypeEnvironment,
};
use yase_codegen::flatten::{FlatEvent, FlatMachine, FlatOp, FlatPath, flatten};

use yase_reference::random::Case;
use yase_reference::script::Input;

/// The number of charts, in the short form of the test and in the long one, as in `.ci/run`; those
/// with too many configurations are not flattened.
const CHART_COUNTS: [u64; 2] = [1_000, 4_000];

/// Maximum number of states.
const MAX_STATES: usize = 40;

#[test]
fn a_flat_chart_does_what_the_machine_does() {
    let (mut flat_ones, mut actions, mut questions, mut together) = (0, 0, 0, 0);
    let charts = CHART_COUNTS[usize::from(std::env::var_os("MONAS_LONG_TESTS").is_some())];
    for number in 0..charts {
        let mut case = Case::numbered(number);
        case.semantics.conflict = ConflictResolution::Declared;
        let chart = simple(&case.chart);
        let flat = match flatten(&chart, case.semantics, MAX_STATES) {
            Ok(flat) => flat,
            Err(found) => {
                let is_expected = found.iter().all(|it| ["E0161", "E0162"].contains(&it.code));
                assert!(is_expected, "{number}: {found:?}");
                continue;
            }
        };
        let events: Vec<String> = case.script.inputs.iter().filter_map(|(_, input)| named(input)).collect();
        let events = [events.as_slice(); 3].concat();
        let vocabulary = TypeEnvironment { scripts: true, ..TypeEnvironment::default() };
        let compiled = Arc::new(chart.compile_with(&vocabulary, case.semantics).expect("it was flattened"));
        let expected = play(&compiled, &flat, &events, number);
        let seen = walk(&compiled, &flat, &events, number);
        assert_eq!(
            seen,
            expected,
            "chart {number}, events {events:?}, {:?}\n{}\n{flat:#?}",
            case.semantics,
            yase_export::to_mermaid(&chart).text
        );
        flat_ones += 1;
        actions += expected.iter().map(|line| line.actions.len()).sum::<usize>();
        questions += usize::from(flat.conditions.len() > 1);
        together += usize::from(flat.states.iter().any(|state| state.leaves.len() > 1));
    }
    println!(
        "{flat_ones} flat charts, {actions} actions, {questions} with conditions, {together} with regions"
    );
    let min = |of_4000: u64| of_4000 * charts / 4_000;
    assert!(flat_ones > charts / 4 && actions as u64 > min(5_000), "{flat_ones} charts, {actions} actions");
    assert!(questions as u64 > min(200) && together as u64 > min(100), "{questions}, {together}");
}

fn named(input: &Input) -> Option<String> {
    match input {
        Input::Event(name) => Some(name.clone()),
        _ => None,
    }
}

/// The observable part of a step.
#[derive(Clone, PartialEq, Debug)]
struct Line {
    actions: Vec<String>,
    active: Vec<String>,
}

/// Removes the features that prevent flattening; conditions and actions become scripts.
fn simple(chart: &Statechart) -> Statechart {
    let mut simple = chart.clone();
    let mut count = 0;
    for (id, node) in chart.nodes() {
        let changed = simple.node_mut(id);
        (changed.activity, changed.duration) = (None, None);
        changed.defer.clear();
        changed.entry = actions(&node.entry, &mut count);
        changed.exit = actions(&node.exit, &mut count);
    }
    for (id, transition) in chart.transitions() {
        let changed = simple.transition_mut(id);
        changed.weight = None;
        changed.expression.actions = actions(&transition.expression.actions, &mut count);
        if let Some(guard) = &mut changed.expression.guard {
            condition(guard, &mut count);
        }
        let messages = |name: &yase::expression::Path| name.text().starts_with("Message.");
        if let Some(Trigger::OneOf(names)) = &mut changed.expression.trigger {
            names.retain(|name| !messages(name));
            if names.is_empty() {
                changed.expression.trigger = None;
            }
        }
    }
    simple
}

fn actions(actions: &[Action], count: &mut usize) -> Vec<Action> {
    let simple = |action: &Action| match action.kind {
        ActionKind::Raise(_) => action.clone(),
        _ => Action { kind: ActionKind::Script(fresh("do", count)), position: TextPosition::default() },
    };
    actions.iter().map(simple).collect()
}

/// Keeps `In` and the operators around it; everything else becomes a script.
fn condition(guard: &mut Expression, count: &mut usize) {
    let is_in = |part: &Expression| matches!(part.kind, ExpressionKind::In(_)).then_some(());
    let has_in = guard.find_map(&mut |part| is_in(part)).is_some();
    match &mut guard.kind {
        ExpressionKind::Or(parts) | ExpressionKind::And(parts) if has_in => {
            parts.iter_mut().for_each(|part| condition(part, count));
        }
        ExpressionKind::Not(operand) => condition(operand, count),
        ExpressionKind::Bool(_) | ExpressionKind::In(_) => {}
        kind => *kind = ExpressionKind::Script(fresh("if", count)),
    }
}

fn fresh(word: &str, count: &mut usize) -> String {
    *count += 1;
    format!("{word}{count}")
}

/// The value of a condition, determined by its text, the step and the number of actions in it.
fn holds(text: &str, seed: u64, step: usize, done: usize) -> bool {
    let start = seed.wrapping_mul(31).wrapping_add(step as u64 * 1_009 + done as u64 * 7_919);
    let sum = text.bytes().fold(start, |sum, byte| (sum ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
    (sum ^ sum >> 29).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 63 == 1
}

struct TestHost<'c> {
    chart: &'c CompiledChart,
    seed: u64,
    step: usize,
    actions: Vec<String>,
}

impl Host for TestHost<'_> {
    fn condition(&self, script: ScriptId, _: ScopeId, _: &ActiveStates<'_>) -> Result<bool, CallError> {
        Ok(holds(self.chart.script(script), self.seed, self.step, self.actions.len()))
    }

    fn perform(&mut self, script: ScriptId, _: ScopeId, _: &mut ScriptContext<'_>) -> Result<(), CallError> {
        self.actions.push(self.chart.script(script).to_owned());
        Ok(())
    }

    fn start(&mut self, _: Activation) {}

    fn cancel(&mut self, _: Activation) {}

    fn stop(&mut self, _: Activation) {}
}

/// The behaviour of the machine.
fn play(chart: &Arc<CompiledChart>, flat: &FlatMachine, events: &[String], seed: u64) -> Vec<Line> {
    let mut machine = Machine::new(chart.clone());
    let mut host = TestHost { chart, seed, step: 0, actions: Vec::new() };
    machine.start(Timestamp::ZERO, &mut host);
    machine.run_to_completion(Timestamp::ZERO, &mut host).expect("it comes to rest");
    let mut lines = vec![line(&machine, flat, std::mem::take(&mut host.actions))];
    for (event, step) in events.iter().zip(1..) {
        host.step = step;
        let now = Timestamp::from_nanos(step as u64);
        machine.dispatch_name(event);
        machine.run_to_completion(now, &mut host).expect("it comes to rest");
        lines.push(line(&machine, flat, std::mem::take(&mut host.actions)));
    }
    lines
}

fn line(machine: &Machine, flat: &FlatMachine, actions: Vec<String>) -> Line {
    let configuration = machine.configuration();
    let runs = machine.status() == Status::Running;
    let state =
        flat.states.iter().find(|state| runs && !state.is_over && state.configuration == configuration);
    Line { actions, active: state.map_or_else(Vec::new, |state| state.leaves.clone()) }
}

/// The behaviour of the flattened chart.
fn walk(chart: &CompiledChart, flat: &FlatMachine, events: &[String], seed: u64) -> Vec<Line> {
    let mut lines = Vec::new();
    let mut state = follow(flat, &flat.start, (seed, 0), &mut lines);
    for (event, step) in events.iter().zip(1..) {
        let known = |it: &FlatEvent| match it {
            FlatEvent::Named(name) => chart.events().find(name) == Some(chart.event(event).0),
            _ => false,
        };
        let index = flat.events.iter().position(known);
        let kinds = [FlatEvent::Other, FlatEvent::Nothing];
        let unknown = || kinds.iter().find_map(|kind| flat.events.iter().position(|it| it == kind));
        let index = index.or_else(unknown);
        let stays = FlatPath { pieces: Vec::new(), to: state };
        let path = index.map_or(&stays, |index| &flat.paths[state][index]);
        state = follow(flat, path, (seed, step), &mut lines);
    }
    lines
}

fn follow(flat: &FlatMachine, path: &FlatPath, (seed, step): (u64, usize), lines: &mut Vec<Line>) -> usize {
    let mut actions: Vec<String> = Vec::new();
    let (mut taken, mut index) = (path, 0);
    while let Some(piece) = taken.pieces.get(index) {
        index += 1;
        match piece {
            FlatOp::Do(action) => actions.push(flat.actions[*action].clone()),
            FlatOp::If(condition, other) => {
                if holds(&flat.conditions[*condition], seed, step, actions.len()) {
                    (taken, index) = (other, 0);
                }
            }
        }
    }
    lines.push(Line { actions, active: flat.states[taken.to].leaves.clone() });
    taken.to
}

/// Two regions, one of which waits for the other, and a history of the second.
const WAITING_REGIONS: &str = r#"
    START
    & both
      one
        START
        A | exit=script("leave A")
        B
      two
        START
        C
        D
        h last
    Z
    c/START -> both
    one/START -> A
    two/START -> C
    last -> C
    A -> B : go [script("ready")] / raise(moved); script("move")
    C -> D : moved [In(B) && !script("tired")]
    both -> Z : stop / script("stop")
    Z -> last : back
"#;

/// The output of `to_rust` for it.
#[rustfmt::skip]
#[allow(unreachable_pub)]
mod written;

/// A host with fixed conditions that records its calls.
#[derive(Default)]
struct Surroundings {
    ready: bool,
    tired: bool,
    actions: Vec<&'static str>,
}

impl written::Host for Surroundings {
    fn ready(&self) -> bool {
        self.ready
    }

    fn tired(&self) -> bool {
        self.tired
    }

    fn leave_a(&mut self) {
        self.actions.push("leave A");
    }

    fn move_(&mut self) {
        self.actions.push("move");
    }

    fn stop(&mut self) {
        self.actions.push("stop");
    }
}

#[test]
fn a_chart_that_was_written_as_rust_runs() {
    let chart = yase_reference::chart::chart(WAITING_REGIONS);
    let code = flatten(&chart, yase::Semantics::yase(), 20).expect("it is simple").to_rust();
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/flat/written.rs");
    if std::env::var_os("MONAS_BLESS").is_some() {
        std::fs::write(file, &code).expect("it can be written");
    }
    assert_eq!(std::fs::read_to_string(file).expect("it is there"), code, "MONAS_BLESS=1 writes it anew");

    use written::Event::{Back, Go, Stop};
    let mut host = Surroundings::default();
    let mut state = written::State::start(&mut host);
    assert_eq!(state.active(), ["both/one/A", "both/two/C"]);
    state.handle(Go, &mut host);
    assert_eq!(
        (state.active(), host.actions.as_slice()),
        (["both/one/A", "both/two/C"].as_slice(), [].as_slice())
    );
    host.ready = true;
    state.handle(Go, &mut host);
    assert_eq!(state.active(), ["both/one/B", "both/two/D"], "what it raises is taken in the same step");
    state.handle(Stop, &mut host);
    state.handle(Back, &mut host);
    assert_eq!(state.active(), ["both/one/A", "both/two/D"], "the second region remembers");
    assert_eq!(host.actions, ["leave A", "move", "stop"]);
    host.tired = true;
    state.handle(Stop, &mut host);
    assert_eq!(state.active(), ["Z"]);
}

/// Regions of one state each, which a condition lets act again and again.
fn restless(regions: usize) -> Statechart {
    let mut chart = Statechart::new("restless");
    let start = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let and = chart.add(Statechart::ROOT, Node::new(NodeKind::And, "all"));
    chart.connect(Transition::new(start, and));
    for number in 0..regions {
        let region = chart.add(and, Node::new(NodeKind::Or, format!("r{number}")));
        let start = chart.add(region, Node::new(NodeKind::Start, ""));
        let state = chart.add(region, Node::new(NodeKind::Basic, format!("s{number}")));
        chart.connect(Transition::new(start, state));
        let text = format!("[script(\"c{number}\")] / script(\"act{number}\")");
        let (expression, found) = yase::expression::parse_transition(&text);
        assert_eq!(found, []);
        chart.connect(Transition { expression, ..Transition::new(state, state) });
    }
    chart
}

/// Each condition that holds is one level of the search.
#[test]
fn a_step_in_which_conditions_hold_without_end_is_a_livelock() {
    for regions in [1, 3, 16] {
        let found = flatten(&restless(regions), yase::Semantics::yase(), 1_000).expect_err("it is endless");
        let codes: Vec<&str> = found.iter().map(|it| it.code).collect();
        assert_eq!(codes, ["E0162"], "{regions}: {found:?}");
    }
}

#[test]
fn a_path_with_too_many_conditions_is_refused() {
    let chart = |length: usize| {
        let mut chart = Statechart::new("long");
        let mut last = chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
        for number in 0..=length {
            let next = chart.add(Statechart::ROOT, Node::new(NodeKind::Basic, format!("s{number}")));
            let guard = format!("[script(\"c{number}\")]");
            let text = if number == 0 { "" } else { &guard };
            let expression = yase::expression::parse_transition(text).0;
            chart.connect(Transition { expression, ..Transition::new(last, next) });
            last = next;
        }
        chart
    };
    let flat = flatten(&chart(250), yase::Semantics::yase(), 1_000).expect("it is not too long");
    assert!(flat.to_rust().contains("c249"));
    let found = flatten(&chart(400), yase::Semantics::yase(), 1_000).expect_err("it is too long");
    let messages: Vec<(&str, &str)> = found.iter().map(|it| (it.code, it.message.as_str())).collect();
    assert_eq!(messages, [("E0161", "more than 256 of its conditions hold on one path")]);
}
