//! Micro-steps of the goalie and the attacker: `cargo bench -p monas-soccer --bench role_step`.
//!
//! The step benches of yase run charts of two states without activities. This one runs the roles
//! of this repository: guards that read fields of soccer messages by reflection, timers, regions,
//! an activity in every innermost state that is started and returns. The unit is nanoseconds a
//! micro-step; the return of an activity begins a run-to-completion step of its own, as it does in
//! Monas.
//!
//! Contestants take turns in one process, timed by the processor time of the thread:
//!
//! - **table**: a table interpreter that does what the micro-steps of the role did, read from a
//!   recorded cycle: exits, entries and activity starts, and nothing else. It selects nothing and
//!   reads no guard, so it is the floor.
//! - **machine**: [`yase::Machine`] with a host that stores one message for each topic, trace off.
//! - **machine, traced**: the same with a host that takes trace records, as Monas does.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench that cannot go on ends")]

use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;

use monas::Registry;
use monas::linked::FUNCTIONS;
use monas_soccer::{Ball, GameState, PlayerState, topics};
use narukom::AnyMessage;
use rustix::time::{ClockId, clock_gettime};
use yase::expression::{CallError, MessageSource};
use yase::{
    Activation, CompiledChart, FieldId, FunctionId, Host, Machine, Outcome, ScopeId, Source, Timestamp,
    TraceRecord, TypeEnvironment, Value,
};

fn main() {
    let measures = std::env::args().any(|argument| argument == "--bench");
    let (rounds, turn) = if measures { (15, 20_000_000) } else { (1, 100_000) };
    for role in ["goalie", "attacker"] {
        let vocabulary = Registry::linked().vocabulary().expect("the vocabulary is in order");
        let chart = Arc::new(compile(role, &vocabulary));
        let mut contestants: Vec<Box<dyn Contestant>> = vec![
            Box::new(Table::record(Role::new(&chart, &vocabulary))),
            Box::new(Role::new(&chart, &vocabulary)),
            Box::new(Role::new(&chart, &vocabulary).traced()),
        ];
        race(role, rounds, turn, &mut contestants);
    }
}

fn compile(role: &str, vocabulary: &TypeEnvironment) -> CompiledChart {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").join(role).with_extension("srm");
    let text = std::fs::read_to_string(&path).expect("the model is readable");
    let (chart, findings) = aseme_models::statechart_of(&Source::new(path.to_string_lossy(), text));
    assert!(findings.is_empty(), "{findings:?}");
    chart.compile(vocabulary).expect("the chart compiles")
}

trait Contestant {
    fn name(&self) -> &'static str;

    /// Executes a tenth of a second of the role. Returns the number of micro-steps.
    fn cycle(&mut self) -> u64;
}

/// A function that guards can call.
type RegisteredFunction = fn(&[Value<'_>]) -> Option<Value<'static>>;

/// A host with one message for each topic, shown on every blackboard.
struct Messages {
    by_topic: Vec<Option<Box<dyn AnyMessage>>>,
    functions: Vec<RegisteredFunction>,
    started: Vec<Activation>,
    traces: bool,
    traced: u64,
    /// The effects of the micro-steps of a cycle, while it is recorded.
    recorded: Option<Vec<RecordedStep>>,
}

#[derive(Clone, Default)]
struct RecordedStep {
    exits: Vec<u32>,
    entries: Vec<u32>,
}

impl Host for Messages {
    fn field(&self, _: ScopeId, source: &MessageSource, path: &[FieldId]) -> Value<'_> {
        let ([field], Some(Some(message))) = (path, self.by_topic.get(source.topic.0 as usize)) else {
            return Value::Missing;
        };
        match message.field(field.0 as usize) {
            narukom::FieldValue::Bool(value) => Value::Bool(value),
            narukom::FieldValue::Float(value) => Value::Float(value),
            narukom::FieldValue::Enum(value) => Value::Enum(value),
            _ => Value::Missing,
        }
    }

    fn call(&self, function: FunctionId, arguments: &[Value<'_>]) -> Result<Value<'_>, CallError> {
        self.functions[function.0 as usize](arguments).ok_or_else(|| CallError::new("other arguments"))
    }

    fn start(&mut self, activation: Activation) {
        self.started.push(activation);
    }

    fn cancel(&mut self, _: Activation) {}
    fn stop(&mut self, _: Activation) {}

    fn wants_trace(&self) -> bool {
        self.traces
    }

    fn trace(&mut self, _: &CompiledChart, record: &TraceRecord<'_>) {
        self.traced += black_box(record).selected.len() as u64;
        if let Some(recorded) = &mut self.recorded {
            recorded.push(RecordedStep {
                exits: record.exits.iter().map(|node| node.0).collect(),
                entries: record.entries.iter().map(|node| node.0).collect(),
            });
        }
    }
}

/// A machine of a role, stable during play.
struct Role {
    machine: Machine,
    host: Messages,
    now: u64,
    beat: u64,
}

impl Role {
    fn new(chart: &Arc<CompiledChart>, vocabulary: &TypeEnvironment) -> Role {
        let call = |name: &str| {
            FUNCTIONS.iter().find(|function| function.name == name).expect("it is registered").call
        };
        let host = Messages {
            by_topic: vocabulary.topics.iter().map(|_| None).collect(),
            functions: vocabulary.functions.iter().map(|function| call(&function.name)).collect(),
            started: Vec::new(),
            traces: false,
            traced: 0,
            recorded: None,
        };
        let mut role = Role { machine: Machine::new(chart.clone()), host, now: 0, beat: 0 };
        role.show(
            vocabulary,
            topics::GAME_STATE.path(),
            GameState { player_state: PlayerState::Playing.into(), ..GameState::default() },
        );
        role.show(
            vocabulary,
            topics::BALL.path(),
            Ball {
                found: true,
                distance: 0.2,
                x: 0.15,
                y: 0.05,
                approaching: true,
                time_to_cross: 0.5,
                crossing_bearing: 0.3,
                ..Ball::default()
            },
        );
        role.machine.start(Timestamp::ZERO, &mut role.host);
        for _ in 0..20 {
            role.cycle();
        }
        role
    }

    fn traced(mut self) -> Role {
        self.host.traces = true;
        self
    }

    fn show(&mut self, vocabulary: &TypeEnvironment, path: &str, message: impl AnyMessage) {
        let topic = vocabulary.topics.iter().find(|topic| topic.path == path).expect("the topic is declared");
        self.host.by_topic[topic.id.0 as usize] = Some(Box::new(message));
    }

    fn step(&mut self) -> u64 {
        let now = Timestamp::from_nanos(self.now);
        u64::from(self.machine.run_to_completion(now, &mut self.host).expect("it comes to rest").micro_steps)
    }
}

impl Contestant for Role {
    fn name(&self) -> &'static str {
        if self.host.traces { "machine, traced" } else { "machine" }
    }

    fn cycle(&mut self) -> u64 {
        self.beat += 1;
        self.now = self.beat * 100_000_000;
        let mut micro_steps = self.step();
        while let Some(activation) = self.host.started.pop() {
            // returns are reported one by one at increasing times, or the time would not advance
            self.now += 1;
            assert!(self.machine.activity_returned(activation, Outcome::Done));
            micro_steps += self.step();
        }
        micro_steps
    }
}

/// Repeats the effects of recorded micro-steps without selecting transitions.
struct Table {
    steps: Vec<RecordedStep>,
    active: Vec<bool>,
    entered: Vec<u64>,
}

impl Table {
    fn record(mut role: Role) -> Table {
        (role.host.traces, role.host.recorded) = (true, Some(Vec::new()));
        role.cycle();
        let steps = role.host.recorded.take().expect("it was recorded");
        let nodes = role.machine.chart().statechart().nodes().len();
        Table { steps, active: vec![false; nodes], entered: vec![0; nodes] }
    }
}

impl Contestant for Table {
    fn name(&self) -> &'static str {
        "table"
    }

    fn cycle(&mut self) -> u64 {
        for step in black_box(&self.steps) {
            step.exits.iter().for_each(|&node| self.active[node as usize] = false);
            for &node in &step.entries {
                self.active[node as usize] = true;
                self.entered[node as usize] += 1;
            }
        }
        self.steps.len() as u64
    }
}

fn race(role: &str, rounds: usize, turn: u64, contestants: &mut [Box<dyn Contestant>]) {
    let mut taken: Vec<Vec<f64>> = vec![Vec::new(); contestants.len()];
    let mut steps = 0;
    for _ in 0..rounds {
        for (contestant, taken) in contestants.iter_mut().zip(&mut taken) {
            let (begin, mut micro_steps, mut cycles) = (now(), 0, 0_u64);
            while now() - begin < turn {
                for _ in 0..100 {
                    micro_steps += contestant.cycle();
                }
                cycles += 100;
            }
            taken.push((now() - begin) as f64 / micro_steps as f64);
            steps = micro_steps / cycles;
        }
    }
    println!(
        "\n{role}, {steps} micro-steps a cycle; ns a micro-step {:>15} {:>19} {:>8}",
        "median", "from .. to", "ratio"
    );
    let first = taken[0].clone();
    for (contestant, taken) in contestants.iter().zip(&taken) {
        let ratio = median(taken.iter().zip(&first).map(|(one, first)| one / first));
        let min = taken.iter().copied().fold(f64::INFINITY, f64::min);
        let max = taken.iter().copied().fold(0.0, f64::max);
        let spread = format!("{min:.1} .. {max:.1}");
        println!(
            "  {:<34} {:>20.1} {spread:>19} {ratio:>8.1}",
            contestant.name(),
            median(taken.iter().copied())
        );
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The processor time of this thread, in nanoseconds.
fn now() -> u64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}
