//! The machine against a naive interpreter of the same rules: on random charts and scripts both must do the same.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

#[path = "../kit/mod.rs"]
mod kit;
mod random;
mod stepper;

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::num::NonZeroU32;

use proptest::collection::vec;
use proptest::prelude::any;
use proptest::test_runner::{Config, RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};
use yase::statechart::{NodeId, NodeKind, Statechart};
use yase::{Machine, Semantics};

use kit::script::{self, Script};
use kit::world::World;

const CHARTS: u32 = 500;

#[test]
fn machine_and_reference_write_the_same_lines() {
    let config =
        Config { cases: CHARTS, failure_persistence: None, max_shrink_iters: 200, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let histogram = RefCell::new(Histogram::default());
    let bytes = vec(any::<u8>(), 200..2000);
    let result = runner.run(&bytes, |bytes| {
        let (chart, script) = random::case(&mut random::Choices::new(&bytes));
        let (expected, found) = (by_reference(&chart, &script), by_machine(&chart, &script));
        histogram.borrow_mut().count(&chart, &expected);
        if expected == found {
            Ok(())
        } else {
            Err(TestCaseError::fail(difference(&chart, &script, &expected, &found)))
        }
    });
    match result {
        Ok(()) => histogram.borrow().assert_rich(),
        Err(TestError::Fail(reason, _)) => panic!("{reason}"),
        Err(error) => panic!("{error}"),
    }
}

fn by_reference(chart: &Statechart, script: &Script) -> Vec<String> {
    let mut world = World { verbose: true, ..World::new(chart) };
    script::run(&mut stepper::Stepper::new(chart), script, &mut world);
    normal(world.log)
}

fn by_machine(chart: &Statechart, script: &Script) -> Vec<String> {
    let mut semantics = Semantics::yase();
    semantics.limit = NonZeroU32::new(stepper::LIMIT).unwrap();
    let mut world = World { verbose: true, ..World::new(chart) };
    script::run(&mut Machine::new(script::compile_with(chart, semantics)), script, &mut world);
    normal(world.log)
}

/// How an endless chart is described may differ.
fn normal(log: Vec<String>) -> Vec<String> {
    log.into_iter().map(|line| if line.starts_with("error:") { "error".into() } else { line }).collect()
}

fn difference(chart: &Statechart, script: &Script, expected: &[String], found: &[String]) -> String {
    let same = expected.iter().zip(found).take_while(|(a, b)| a == b).count();
    let context = expected[same.saturating_sub(12)..same].join("\n");
    let one = |log: &[String]| log.get(same).cloned().unwrap_or_else(|| "(nothing)".into());
    format!(
        "{}{script:?}\n\n{context}\nexpected {}\nfound    {}\n",
        describe(chart),
        one(expected),
        one(found)
    )
}

fn describe(chart: &Statechart) -> String {
    let mut text = String::from("\n");
    for (id, node) in chart.nodes() {
        text += &format!("{} {:?}", chart.path(id), node.kind);
        for (title, actions) in [("entry", &node.entry), ("exit", &node.exit)] {
            for action in actions {
                text += &format!(" | {title} {action}");
            }
        }
        if !node.defer.is_empty() {
            text += &format!(" | defer {:?}", node.defer);
        }
        if let Some(activity) = &node.activity {
            text += &format!(" | {activity} {:?}", node.duration);
        }
        text.push('\n');
    }
    for (_, transition) in chart.transitions() {
        let flags = [(transition.interrupts, " interrupts"), (transition.internal, " internal")];
        text += &format!("{} -> {}", chart.path(transition.source), chart.path(transition.target));
        text.extend(flags.iter().filter(|(set, _)| *set).map(|(_, name)| *name));
        text += &format!(" !{} : {}\n", transition.priority, transition.expression);
    }
    text
}

/// In how many cases something occurred.
#[derive(Default)]
struct Histogram {
    rows: BTreeMap<&'static str, u32>,
}

/// What a line of a log contains when something has occurred.
const OCCURRENCES: [(&str, &str); 16] = [
    ("transition fired", "; exit "),
    ("conflict", "; preempt "),
    ("event held", "; hold "),
    ("event deferred", "; defer in "),
    ("event dropped", ": dropped"),
    ("action done", "; do "),
    ("activity started", "  start "),
    ("activity done", " returns Done"),
    ("activity ongoing", " returns Ongoing"),
    ("activity failed", " returns Failed"),
    ("activity cancelled", "  cancel "),
    ("activity stopped", "  stop "),
    ("guard failed", "  guard failed"),
    ("action failed", "  action failed"),
    ("region entered", "  inherit "),
    ("waits at START", "  waits at "),
];

impl Histogram {
    fn add(&mut self, row: &'static str, occurred: bool) {
        *self.rows.entry(row).or_insert(0) += u32::from(occurred);
    }

    fn count(&mut self, chart: &Statechart, log: &[String]) {
        let kinds = |wanted: NodeKind| chart.nodes().any(|(_, node)| node.kind == wanted);
        for (row, kind) in [
            ("CONDITION", NodeKind::Condition),
            ("JUNCTION", NodeKind::Junction),
            ("TERMINATE", NodeKind::Terminate),
        ] {
            self.add(row, kinds(kind));
        }
        let depth = |kind: NodeKind| chart.nodes().map(|(id, _)| depth(chart, id, kind)).max().unwrap_or(0);
        self.add("OR depth 2", depth(NodeKind::Or) >= 3);
        self.add("AND depth 2", depth(NodeKind::And) >= 2);
        self.add(
            "a duration",
            chart.nodes().any(|(_, node)| node.duration.is_some_and(|time| !time.is_zero())),
        );
        for (row, part) in OCCURRENCES {
            self.add(row, log.iter().any(|line| line.contains(part)));
        }
        for (row, event) in [
            ("timer event", " v"),
            ("message event", " a:"),
            ("eventless", " -:"),
            ("raised error", " error."),
        ] {
            self.add(row, log.iter().any(|line| line.contains(&format!(" s{event}"))));
        }
        self.add(
            "both in one AND",
            log.iter().any(|line| line.split("; ").next().is_some_and(|head| head.contains(", "))),
        );
        self.add("never rests", log.iter().any(|line| line == "error"));
        self.add("runs on", !log.iter().any(|line| line == "error"));
        self.add("long", log.len() > 60);
    }

    fn assert_rich(&self) {
        for (row, count) in &self.rows {
            println!("{count:5} {row}");
        }
        let poor: Vec<_> = self.rows.iter().filter(|(_, count)| **count < CHARTS / 50).collect();
        assert!(poor.is_empty(), "occur too rarely: {poor:?}");
        assert!(self.rows["runs on"] > CHARTS / 2, "most charts come to rest");
    }
}

/// How many nodes of a kind are around a node, itself included.
fn depth(chart: &Statechart, node: NodeId, kind: NodeKind) -> usize {
    std::iter::once(node).chain(chart.ancestors(node)).filter(|&node| chart.node(node).kind == kind).count()
}
