//! Random runs, under all semantics, that are interrupted at every micro-step: captured as text,
//! and continued by a machine restored from the text.

use std::sync::Arc;

use yase::snapshot::Snapshot;
use yase::{Activation, Chooser, CompiledChart, Machine, MicroStep, Outcome, Timestamp, TopicId};

use yase_reference::chooser::ChoicePolicy;
use yase_reference::random::Case;
use yase_reference::script::{self, Interpreter};
use yase_reference::test_host::{TestHost, vocabulary};

/// The number of runs that are interrupted: shortly, and at length.
const RUNS: [u64; 2] = [200, 1000];

/// In this many runs each interruption is also continued without further ones.
const WHOLE_RUNS: u64 = 10;

#[test]
fn a_machine_that_is_restored_at_every_micro_step_writes_the_same_lines() {
    let runs = RUNS[usize::from(crate::is_long())];
    let counts = std::thread::scope(|threads| {
        let second = threads.spawn(|| cut_everywhere(runs / 2..runs));
        let first = cut_everywhere(0..runs / 2);
        let second = second.join().expect("it does not panic");
        [first.0 + second.0, first.1 + second.1]
    });
    let [all, mid_step] = counts;
    println!("{all} snapshots of {runs} runs, {mid_step} of them in the middle of a step");
    assert!(mid_step > 20 * runs && all > mid_step, "the runs are too short");
}

/// The number of snapshots that were taken, and of those in the middle of a step.
fn cut_everywhere(numbers: std::ops::Range<u64>) -> (u64, u64) {
    let (mut all, mut mid_step) = (0, 0);
    for number in numbers {
        let case = Case::numbered(number);
        let chart = compile(&case);
        let expected = run(&mut machine(&chart, &case), &case);
        let mut cut = Cut::new(machine(&chart, &case), None);
        let found = run(&mut cut, &case);
        assert!(expected == found, "case {number}: {}", difference(&expected, &found));
        all += cut.snapshots;
        mid_step += cut.mid_step;
    }
    (all, mid_step)
}

#[test]
fn a_machine_that_is_restored_once_goes_on_to_the_end() {
    let mut restored = 0;
    for number in RUNS[1]..RUNS[1] + WHOLE_RUNS {
        let case = Case::numbered(number);
        let chart = compile(&case);
        let mut whole = Cut::new(machine(&chart, &case), Some(u64::MAX));
        let expected = run(&mut whole, &case);
        for at in 0..whole.calls {
            let mut cut = Cut::new(machine(&chart, &case), Some(at));
            let found = run(&mut cut, &case);
            assert!(expected == found, "case {number} at {at}: {}", difference(&expected, &found));
            restored += cut.snapshots;
        }
    }
    println!("{restored} machines were restored and ran to their end");
    assert!(restored > 20 * WHOLE_RUNS, "the runs are too short");
}

fn compile(case: &Case) -> Arc<CompiledChart> {
    match case.chart.compile_with(&vocabulary(), case.semantics) {
        Ok(chart) => Arc::new(chart),
        Err(found) => panic!("{found:?}"),
    }
}

fn machine(chart: &Arc<CompiledChart>, case: &Case) -> Machine {
    let mut machine = Machine::new(chart.clone());
    machine.set_chooser(match &case.policy {
        ChoicePolicy::Declared => Chooser::declared(),
        ChoicePolicy::Seeded(seed) => Chooser::seeded(*seed),
        ChoicePolicy::Scripted(choices) => Chooser::scripted(choices.clone()),
    });
    machine
}

fn run(interpreter: &mut impl Interpreter, case: &Case) -> Vec<String> {
    let mut host = TestHost { verbose: true, reads: true, ..TestHost::new(&case.chart) };
    script::run(interpreter, &case.script, &mut host);
    host.log
}

fn difference(expected: &[String], found: &[String]) -> String {
    let same = expected.iter().zip(found).take_while(|(a, b)| a == b).count();
    let one = |log: &[String]| log.get(same).cloned().unwrap_or_else(|| "(nothing)".into());
    let before = expected[same.saturating_sub(12)..same].join("\n");
    format!("\n{before}\nexpected {}\nfound    {}", one(expected), one(found))
}

/// A machine that is replaced by its restored copy before every call, or before one of these calls.
struct Cut {
    machine: Machine,
    only: Option<u64>,
    calls: u64,
    snapshots: u64,
    mid_step: u64,
}

impl Cut {
    fn new(machine: Machine, only: Option<u64>) -> Cut {
        Cut { machine, only, calls: 0, snapshots: 0, mid_step: 0 }
    }

    fn cut(&mut self) -> &mut Machine {
        if self.only.is_none_or(|only| only == self.calls) {
            self.replace();
        }
        self.calls += 1;
        &mut self.machine
    }

    fn replace(&mut self) {
        let snapshot = self.machine.snapshot();
        let text = serde_json::to_string(&snapshot).unwrap();
        let read: Snapshot = serde_json::from_str(&text).unwrap();
        assert_eq!(read, snapshot, "nothing is lost in the text");
        let restored = Machine::restore(self.machine.chart().clone(), &read)
            .unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(restored.snapshot(), snapshot, "the restored machine is as the one before");
        assert!(restored.activations().eq(self.machine.activations()));
        self.snapshots += 1;
        self.mid_step += u64::from(self.machine.is_mid_step());
        self.machine = restored;
    }
}

impl Interpreter for Cut {
    fn start(&mut self, now: Timestamp, host: &mut TestHost) {
        self.cut().start(now, host);
    }

    fn event(&mut self, name: &str) {
        self.cut().dispatch_name(name);
    }

    fn message(&mut self, topic: TopicId) {
        self.cut().message_arrived(topic, 1);
    }

    fn returned(&mut self, activation: Activation, outcome: Outcome) -> bool {
        self.cut().activity_returned(activation, outcome)
    }

    fn resumed(&mut self, activation: Activation) -> bool {
        self.cut().activity_resumed(activation)
    }

    fn step(&mut self, now: Timestamp, host: &mut TestHost) -> Result<(), String> {
        loop {
            match self.cut().micro_step(now, host).map_err(|error| error.to_string())? {
                MicroStep::Progressed => {}
                MicroStep::Stable(_) => return Ok(()),
            }
        }
    }

    fn needs_step(&self, now: Timestamp) -> bool {
        self.machine.needs_step(now)
    }

    fn next_deadline(&self) -> Option<Timestamp> {
        self.machine.next_deadline()
    }

    fn regions(&self) -> usize {
        self.machine.chart().regions().len()
    }
}
