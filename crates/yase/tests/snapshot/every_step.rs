//! Random runs that are cut at every micro-step: taken down as text, and gone on with by a machine that was made of the text.

use std::num::NonZeroU32;

use proptest::collection::vec;
use proptest::prelude::any;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};
use yase::snapshot::Snapshot;
use yase::statechart::Statechart;
use yase::{Activation, Machine, MicroStep, Moment, Outcome, Semantics, TopicId};

use crate::kit::script::{self, Interpreter, Script};
use crate::kit::world::World;
use crate::random;

const CHARTS: u32 = 1000;

/// Charts that never rest are stopped soon.
const LIMIT: NonZeroU32 = NonZeroU32::new(40).unwrap();

#[test]
fn a_machine_that_is_restored_at_every_micro_step_writes_the_same_lines() {
    let config =
        Config { cases: CHARTS, failure_persistence: None, max_shrink_iters: 200, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let taken = std::cell::Cell::new((0, 0));
    let result = runner.run(&vec(any::<u8>(), 200..2000), |bytes| {
        let (chart, script) = random::case(&mut random::Choices::new(&bytes));
        let expected = run(&mut machine(&chart), &chart, &script);
        let mut cut = Cut { machine: machine(&chart), snapshots: 0, mid_step: 0 };
        let found = run(&mut cut, &chart, &script);
        let (all, mid_step) = taken.get();
        taken.set((all + cut.snapshots, mid_step + cut.mid_step));
        if expected == found { Ok(()) } else { Err(TestCaseError::fail(difference(&expected, &found))) }
    });
    match result {
        Ok(()) => {}
        Err(TestError::Fail(reason, _)) => panic!("{reason}"),
        Err(error) => panic!("{error}"),
    }
    let (all, mid_step) = taken.get();
    println!("{all} snapshots of {CHARTS} runs, {mid_step} of them in the middle of a step");
    assert!(mid_step > 20 * CHARTS && all > mid_step, "the runs are too short");
}

fn machine(chart: &Statechart) -> Machine {
    let mut semantics = Semantics::yase();
    semantics.limit = LIMIT;
    Machine::new(script::compile_with(chart, semantics))
}

fn run(interpreter: &mut impl Interpreter, chart: &Statechart, script: &Script) -> Vec<String> {
    let mut world = World { verbose: true, reads: true, ..World::new(chart) };
    script::run(interpreter, script, &mut world);
    world.log
}

fn difference(expected: &[String], found: &[String]) -> String {
    let same = expected.iter().zip(found).take_while(|(a, b)| a == b).count();
    let one = |log: &[String]| log.get(same).cloned().unwrap_or_else(|| "(nothing)".into());
    let before = expected[same.saturating_sub(12)..same].join("\n");
    format!("{before}\nexpected {}\nfound    {}", one(expected), one(found))
}

/// A machine that is replaced by its restored self before everything that happens to it.
struct Cut {
    machine: Machine,
    snapshots: u32,
    mid_step: u32,
}

impl Cut {
    fn cut(&mut self) -> &mut Machine {
        let snapshot = self.machine.snapshot();
        let text = serde_json::to_string(&snapshot).unwrap();
        let read: Snapshot = serde_json::from_str(&text).unwrap();
        assert_eq!(read, snapshot, "nothing is lost in the text");
        let chart = self.machine.chart().clone();
        let restored = Machine::restore(chart, &read).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(restored.snapshot(), snapshot, "the restored machine is as the one before");
        assert!(restored.activations().eq(self.machine.activations()));
        self.snapshots += 1;
        self.mid_step += u32::from(self.machine.is_mid_step());
        self.machine = restored;
        &mut self.machine
    }
}

impl Interpreter for Cut {
    fn start(&mut self, now: Moment, world: &mut World) {
        self.cut().start(now, world);
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

    fn step(&mut self, now: Moment, world: &mut World) -> Result<(), String> {
        loop {
            match self.cut().micro_step(now, world).map_err(|error| error.to_string())? {
                MicroStep::Made => {}
                MicroStep::AtRest(_) => return Ok(()),
            }
        }
    }

    fn needs_step(&self, now: Moment) -> bool {
        self.machine.needs_step(now)
    }

    fn next_deadline(&self) -> Option<Moment> {
        self.machine.next_deadline()
    }

    fn regions(&self) -> usize {
        self.machine.chart().regions().len()
    }
}
