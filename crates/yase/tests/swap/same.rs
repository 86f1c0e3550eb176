//! Swapping a chart for itself, or for a copy whose nodes are numbered otherwise, changes nothing.

use std::collections::{BTreeMap, VecDeque};
use std::num::NonZeroU32;
use std::sync::Arc;

use proptest::collection::vec;
use proptest::prelude::any;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};
use yase::statechart::{NodeId, Statechart, Transition};
use yase::swap::plan;
use yase::{Activation, Chart, Machine, Moment, Outcome, Semantics, TopicId};

use crate::kit::script::{self, Interpreter, Script};
use crate::kit::world::World;
use crate::random;
use crate::world::rekey;

const CHARTS: u32 = 300;

/// Charts that never rest are stopped soon.
const LIMIT: NonZeroU32 = NonZeroU32::new(40).unwrap();

#[test]
fn swapping_a_chart_for_itself_or_a_renumbered_copy_at_every_stable_point_changes_no_line() {
    let config =
        Config { cases: CHARTS, failure_persistence: None, max_shrink_iters: 200, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let swaps = std::cell::Cell::new(0);
    let result = runner.run(&vec(any::<u8>(), 200..2000), |bytes| {
        let (chart, script) = random::case(&mut random::Choices::new(&bytes));
        let compiled = compile(&chart);
        let expected = run(&mut Machine::new(compiled.clone()), &chart, &script);
        for other in [chart.clone(), renumbered(&chart)] {
            let charts = [compiled.clone(), compile(&other)];
            let mut swapping = Swapping { machine: Machine::new(compiled.clone()), charts, swaps: 0 };
            let found = run(&mut swapping, &chart, &script);
            swaps.set(swaps.get() + swapping.swaps);
            if expected != found {
                let same = expected.iter().zip(&found).take_while(|(a, b)| a == b).count();
                let text = format!("{:?}\n{:?}", expected.get(same), found.get(same));
                return Err(TestCaseError::fail(text));
            }
        }
        Ok(())
    });
    match result {
        Ok(()) => println!("{} swaps in {CHARTS} runs", swaps.get()),
        Err(TestError::Fail(reason, _)) => panic!("{reason}"),
        Err(error) => panic!("{error}"),
    }
    assert!(swaps.get() > 20 * CHARTS, "the runs are too short");
}

#[test]
fn a_renumbered_copy_numbers_otherwise() {
    let chart = crate::kit::chart(
        "& both\n  one\n    START\n    A\n    both/one/START -> both/one/A\nSTART\nSTART -> both",
    );
    let chart = plan(&compile(&chart), &compile(&renumbered(&chart)));
    let a = NodeId(4);
    assert!(chart.is_same());
    assert_ne!(chart.node(a), Some(a));
}

fn compile(chart: &Statechart) -> Arc<Chart> {
    let mut semantics = Semantics::yase();
    semantics.limit = LIMIT;
    script::compile_with(chart, semantics)
}

fn run(interpreter: &mut impl Interpreter, chart: &Statechart, script: &Script) -> Vec<String> {
    let mut world = World { verbose: true, ..World::new(chart) };
    script::run(interpreter, script, &mut world);
    world.log
}

/// The same chart with its nodes added level by level.
fn renumbered(chart: &Statechart) -> Statechart {
    let mut copy = Statechart::new(chart.name.clone());
    copy.constants = chart.constants.clone();
    *copy.node_mut(Statechart::ROOT) = chart.node(Statechart::ROOT).clone();
    let mut numbers = BTreeMap::from([(Statechart::ROOT, Statechart::ROOT)]);
    let mut open = VecDeque::from([Statechart::ROOT]);
    while let Some(node) = open.pop_front() {
        for &child in chart.children(node) {
            numbers.insert(child, copy.add(numbers[&node], chart.node(child).clone()));
            open.push_back(child);
        }
    }
    for (_, transition) in chart.transitions() {
        let (source, target) = (numbers[&transition.source], numbers[&transition.target]);
        copy.connect(Transition { source, target, ..transition.clone() });
    }
    copy
}

/// A machine whose chart is swapped before and after each step, to and fro.
struct Swapping {
    machine: Machine,
    charts: [Arc<Chart>; 2],
    swaps: u32,
}

impl Swapping {
    fn swap(&mut self, world: &mut World) {
        let [one, other] = &self.charts;
        let plan = plan(one, other);
        assert!(plan.is_same());
        let report = self.machine.swap(&plan).unwrap_or_else(|refusal| panic!("{refusal}"));
        rekey(world, other, &report);
        self.charts.reverse();
        self.swaps += 1;
    }
}

impl Interpreter for Swapping {
    fn start(&mut self, now: Moment, world: &mut World) {
        self.machine.start(now, world);
    }

    fn event(&mut self, name: &str) {
        self.machine.dispatch_name(name);
    }

    fn message(&mut self, topic: TopicId) {
        self.machine.message_arrived(topic, 1);
    }

    fn returned(&mut self, activation: Activation, outcome: Outcome) -> bool {
        self.machine.activity_returned(activation, outcome)
    }

    fn resumed(&mut self, activation: Activation) -> bool {
        self.machine.activity_resumed(activation)
    }

    fn step(&mut self, now: Moment, world: &mut World) -> Result<(), String> {
        self.swap(world);
        self.machine.run_to_completion(now, world).map_err(|error| error.to_string())?;
        self.swap(world);
        Ok(())
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
