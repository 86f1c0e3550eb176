//! Migration to the same chart, or to a copy with other node indices, changes nothing.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use yase::migrate::plan;
use yase::statechart::{NodeId, Statechart, Transition};
use yase::{Activation, Chooser, CompiledChart, Machine, Outcome, Semantics, Timestamp, TopicId};

use crate::swap::stage::rekey;
use yase_reference::chooser::ChoicePolicy;
use yase_reference::random::Case;
use yase_reference::script::{self, Interpreter};
use yase_reference::test_host::TestHost;

/// The number of runs: shortly, and at length.
const RUNS: [u64; 2] = [100, 300];

#[test]
fn swapping_a_chart_for_itself_or_a_renumbered_copy_at_every_stable_point_changes_no_line() {
    let runs = RUNS[usize::from(crate::is_long())];
    let swaps: u64 = (0..runs).map(swapped).sum();
    println!("{swaps} swaps in {runs} runs");
    assert!(swaps > 20 * runs, "the runs are too short");
}

/// Plays a case without and with swaps, and says how many there were.
fn swapped(number: u64) -> u64 {
    let case = Case::numbered(number);
    let compiled = compile(&case.chart, case.semantics);
    let expected = run(&mut machine(compiled.clone(), &case), &case);
    let mut swaps = 0;
    for other in [case.chart.clone(), renumbered(&case.chart)] {
        let charts = [compiled.clone(), compile(&other, case.semantics)];
        let mut swapping = Swapping { machine: machine(compiled.clone(), &case), charts, swaps: 0 };
        let found = run(&mut swapping, &case);
        swaps += swapping.swaps;
        let same = expected.iter().zip(&found).take_while(|(a, b)| a == b).count();
        assert!(expected == found, "case {number}: {:?} {:?}", expected.get(same), found.get(same));
    }
    swaps
}

#[test]
fn a_renumbered_copy_numbers_otherwise() {
    let chart = yase_reference::chart(
        "& both\n  one\n    START\n    A\n    both/one/START -> both/one/A\nSTART\nSTART -> both",
    );
    let [one, other] = [chart.clone(), renumbered(&chart)].map(|chart| script::compile(&chart));
    let chart = plan(&one, &other);
    let a = NodeId(4);
    assert!(chart.is_same());
    assert_ne!(chart.node(a), Some(a));
}

fn compile(chart: &Statechart, semantics: Semantics) -> Arc<CompiledChart> {
    script::compile_with(chart, semantics)
}

fn machine(chart: Arc<CompiledChart>, case: &Case) -> Machine {
    let mut machine = Machine::new(chart);
    machine.set_chooser(match &case.policy {
        ChoicePolicy::Declared => Chooser::declared(),
        ChoicePolicy::Seeded(seed) => Chooser::seeded(*seed),
        ChoicePolicy::Scripted(choices) => Chooser::scripted(choices.clone()),
    });
    machine
}

fn run(interpreter: &mut impl Interpreter, case: &Case) -> Vec<String> {
    let mut host = TestHost { verbose: true, ..TestHost::new(&case.chart) };
    script::run(interpreter, &case.script, &mut host);
    host.log
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
    charts: [Arc<CompiledChart>; 2],
    swaps: u64,
}

impl Swapping {
    fn swap(&mut self, host: &mut TestHost) {
        let [one, other] = &self.charts;
        let plan = plan(one, other);
        assert!(plan.is_same());
        let report = self.machine.swap(&plan).unwrap_or_else(|refusal| panic!("{refusal}"));
        rekey(host, other, &report);
        self.charts.reverse();
        self.swaps += 1;
    }
}

impl Interpreter for Swapping {
    fn start(&mut self, now: Timestamp, host: &mut TestHost) {
        self.machine.start(now, host);
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

    fn step(&mut self, now: Timestamp, host: &mut TestHost) -> Result<(), String> {
        self.swap(host);
        self.machine.run_to_completion(now, host).map_err(|error| error.to_string())?;
        self.swap(host);
        Ok(())
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
