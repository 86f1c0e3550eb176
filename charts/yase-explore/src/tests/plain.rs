//! The explorer against a plain reference without optimisations, on random charts.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use super::super::host::ChoosingHost;
use super::super::search::take_step;
use super::{ChartSketch, events};
use crate::{Environment, StepCause, WriteEffects, explore};
use yase::expression::ScriptId;
use yase::state_key::RelevantState;
use yase::statechart::TransitionId;
use yase::{Chooser, Machine, Status};
use yase::{CompiledChart, Node, NodeId, NodeKind, Statechart, Transition};

/// Maximum number of states.
const MAX_STATES: usize = 400;

/// The complete description of a step, and its target.
type StepOutcomes = BTreeSet<(String, usize)>;

/// All behaviour of a chart.
#[derive(Default)]
struct ReferenceExploration {
    /// The observable part of each state.
    states: Vec<(Vec<NodeId>, Status, Vec<NodeId>)>,
    outcomes: Vec<StepOutcomes>,
    taken: BTreeSet<TransitionId>,
    entered: BTreeSet<NodeId>,
    failures: BTreeSet<String>,
}

/// Explores without optimisations; `None` if there are too many states.
fn plain(
    chart: &Arc<CompiledChart>,
    names: &[String],
    sight: &RelevantState,
) -> Option<ReferenceExploration> {
    let (mut found, mut known) = (ReferenceExploration::default(), BTreeMap::new());
    let mut open = VecDeque::from([(None, Machine::new(chart.clone()))]);
    while let Some((from, machine)) = open.pop_front() {
        for cause in causes(&machine, names, from) {
            for (label, next) in steps(&machine, &cause, &mut found) {
                let mut key = Vec::new();
                next.write_key(sight, &mut key);
                let to = *known.entry(key).or_insert_with(|| {
                    let running = next.running().into_iter().map(|activation| activation.node).collect();
                    found.states.push((next.configuration(), next.status(), running));
                    found.outcomes.push(StepOutcomes::new());
                    open.push_back((Some(found.states.len() - 1), next));
                    found.states.len() - 1
                });
                if let Some(from) = from {
                    let indices: &mut StepOutcomes = &mut found.outcomes[from];
                    indices.insert((label, to));
                }
            }
        }
        if found.states.len() > MAX_STATES {
            return None;
        }
    }
    Some(found)
}

fn causes(machine: &Machine, names: &[String], from: Option<usize>) -> Vec<StepCause> {
    match (from, machine.status()) {
        (None, _) => vec![StepCause::Start],
        (_, Status::Running) => {
            let returns = machine.running().into_iter().map(|activation| StepCause::Return(activation.node));
            let timers = machine.timers_set().into_iter().map(StepCause::Timer);
            let events = names.iter().filter(|name| !machine.is_waiting(name)).cloned().map(StepCause::Event);
            returns.chain(timers).chain(events).chain([StepCause::Messages]).collect()
        }
        _ => Vec::new(),
    }
}

/// Executes all alternatives of a step: values of conditions and choices are enumerated like
/// digits.
fn steps(machine: &Machine, cause: &StepCause, found: &mut ReferenceExploration) -> Vec<(String, Machine)> {
    let (mut steps, mut plans) = (Vec::new(), vec![(Vec::new(), Vec::new())]);
    while let Some((values, options)) = plans.pop() {
        let mut next = machine.clone();
        let mut allows = |_: ScriptId, _: bool, _: &[(ScriptId, bool)]| true;
        let effects = WriteEffects::default();
        let mut host = ChoosingHost::new(&mut allows, &effects);
        host.begin(&values);
        let result = take_step(&mut next, cause, options.clone(), &mut host);
        let made = next.chooser().choices().to_vec();
        next.set_chooser(Chooser::declared());
        found.taken.extend(&host.notes.taken);
        found.entered.extend(&host.notes.entered);
        let observed = (host.notes.taken.clone(), host.notes.held.clone());
        let decided: Vec<(ScriptId, bool)> =
            host.step_decisions().iter().map(|it| (it.script, it.value)).collect();
        let decisions: Vec<bool> = decided.iter().map(|it| it.1).collect();
        for index in values.len()..decisions.len() {
            plans.push(([&decisions[..index], &[!decisions[index]]].concat(), options.clone()));
        }
        for index in options.len()..made.len() {
            let before: Vec<u32> = made[..index].iter().map(|it| it.0).collect();
            plans.extend((1..made[index].1).map(|other| (values.clone(), [&before[..], &[other]].concat())));
        }
        match result {
            Ok(()) => steps.push((format!("{cause:?} {decided:?} {made:?} {observed:?}"), next)),
            Err(error) => {
                found.failures.insert(format!("{:?}", error.kind()));
            }
        }
    }
    steps
}

/// Whether the initial states of two explorations are equivalent: states are partitioned into
/// classes, which are split while states of one class have different steps.
fn are_alike(one: &ReferenceExploration, other: &ReferenceExploration) -> bool {
    let shift = one.states.len();
    let states: Vec<_> = one.states.iter().chain(&other.states).collect();
    let indices: Vec<Vec<(&str, usize)>> = (one.outcomes.iter().map(|positions| (0, positions)))
        .chain(other.outcomes.iter().map(|edges| (shift, edges)))
        .map(|(shift, edges)| edges.iter().map(|(label, to)| (label.as_str(), to + shift)).collect())
        .collect();
    let (mut classes, mut count) = (vec![0; states.len()], 0);
    loop {
        let mut numbers = BTreeMap::new();
        let mut next = Vec::new();
        for (state, edges) in states.iter().zip(&indices) {
            let edges: BTreeSet<(&str, usize)> =
                edges.iter().map(|&(label, to)| (label, classes[to])).collect();
            let (number, shown) = (numbers.len(), format!("{state:?}"));
            next.push(*numbers.entry((shown, classes[next.len()], edges)).or_insert(number));
        }
        if numbers.len() == count {
            return next[0] == next[shift];
        }
        (classes, count) = (next, numbers.len());
    }
}

/// A transition of a random chart: indices of its source and target in a region, and its text.
type PlainTransition = (usize, usize, &'static str);

const TEXTS: &[&str] = &[
    "",
    "go",
    "[t]",
    "[t] / StartTimeout(t, 1s)",
    "/ StartTimeout(t, 1s)",
    "go / StartTimeout(t, 1s)",
    "go [script(\"x\")]",
    "[script(\"x\")]",
    "[t && script(\"x\")] / StartTimeout(t, 1s)",
    "[TimeoutCheck(t)]",
    "t",
    "back / raise(go)",
];

/// One region or two, each with three states.
fn sketch(regions: &[(bool, Vec<PlainTransition>)]) -> ChartSketch {
    const NAMES: [[&str; 3]; 2] = [["A", "b", "C"], ["D", "E", "f"]];
    let mut sketch = ChartSketch::new();
    let start = sketch.chart.add(Statechart::ROOT, Node::new(NodeKind::Start, ""));
    let and = sketch.add(Statechart::ROOT, NodeKind::And, "both");
    sketch.chart.connect(Transition::new(start, and));
    for (names, (defers, arrows)) in NAMES.iter().zip(regions) {
        let region = sketch.chart.add(and, Node::new(NodeKind::Or, ""));
        sketch.states(region, names);
        if *defers {
            let first = sketch.node(names[0]);
            sketch.chart.node_mut(first).defer.push("t".into());
        }
        // starts the timer that the others read
        let starts = (0, 1, "go / StartTimeout(t, 1s)");
        for &(source, target, text) in arrows.iter().chain([&starts]) {
            sketch.connect(names[source], names[target], text);
        }
    }
    sketch
}

fn regions() -> impl Strategy<Value = Vec<(bool, Vec<PlainTransition>)>> {
    let arrow = (0..3_usize, 0..3_usize, prop::sample::select(TEXTS));
    let region = (prop::bool::weighted(0.2), prop::collection::vec(arrow, 2..6));
    prop::collection::vec(region, 1..3)
}

#[test]
fn charts_of_chance_are_explored_as_by_the_plain_way() {
    let mut runner = TestRunner::deterministic();
    let (mut judged, mut smaller) = (0, 0);
    for _ in 0..150 {
        let regions = regions().new_tree(&mut runner).unwrap().current();
        let chart = sketch(&regions).compile();
        let surroundings = || Environment { messages: true, ..events(&["go", "back"]) };
        let names = surroundings().events;
        let Some(all) = plain(&chart, &names, &RelevantState::of_all(&chart)) else { continue };
        let seen = plain(&chart, &names, &RelevantState::new(&chart)).unwrap();
        assert!(are_alike(&all, &seen), "{regions:?}");

        let found = explore(&chart, &mut surroundings(), MAX_STATES + 1);
        assert!(found.is_finished());
        let shown = |state: &super::super::ExploredState| {
            (state.configuration.clone(), state.status, state.running.clone())
        };
        assert_eq!(found.states().iter().map(shown).collect::<Vec<_>>(), seen.states, "{regions:?}");
        let statechart = chart.statechart();
        for (id, _) in statechart.transitions() {
            assert_eq!(found.was_taken(id), all.taken.contains(&id), "{regions:?}");
        }
        for (id, _) in statechart.nodes() {
            assert_eq!(found.was_entered(id), all.entered.contains(&id), "{regions:?}");
        }
        let failures: BTreeSet<String> = found.failures().iter().map(|it| format!("{:?}", it.kind)).collect();
        assert_eq!(failures, all.failures, "{regions:?}");
        for (number, state) in found.states().iter().enumerate() {
            let again = super::replay(&found.trace_to(number), |_, _, _| {}).unwrap();
            assert_eq!(again.configuration(), state.configuration, "{regions:?}");
        }
        judged += 1;
        smaller += usize::from(seen.states.len() < all.states.len());
    }
    assert!(judged >= 60 && smaller >= 15, "{judged} were small enough, {smaller} became smaller");
}

/// Timers that have expired differ from those never started where a chart distinguishes them.
#[test]
fn distinguishable_states_are_not_merged() {
    let states = |guard: &str| {
        let mut sketch = ChartSketch::new();
        sketch.states(Statechart::ROOT, &["a", "b"]);
        sketch.connect("a", "b", "go / StartTimeout(t, 1s)");
        sketch.connect("b", "a", guard);
        let found = explore(&sketch.compile(), &mut events(&["go", "back"]), 100);
        assert!(found.is_finished());
        found.states().len()
    };
    // `a`, `b` while the timer runs, and `a` again after its expiry
    assert_eq!((states("back [t]"), states("back [TimeoutCheck(t)]")), (3, 4));
}
