//! Explores a chart for a violation of a property.

use std::collections::BTreeMap;
use std::time::Duration;

use yase::expression::{Action, ActionKind, Expression, ScriptId};
use yase::{CompiledChart, NodeId, Statechart};
use yase_explore::{ClockModel, Environment, LabelledGraph, StepLabeler, StepObservation, explore_labelled};

use super::compiled_property::{AtomicProposition, CompiledProperty};
use super::names::BoundProperty;
use super::product::{self, SearchOutcome, Violation};
use crate::abstraction::Abstraction;
use crate::cone_of_influence;
use crate::logic::{Claim, GuardSolver};
use aseme::path::shortest_path;

/// The result of an exploration for a property.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum ExplorationVerdict {
    Holds,
    /// A violating run, as text that [`yase_explore::Trace::parse`] reads, and whether it ends in a
    /// cycle.
    Violated(String, bool),
    /// The limit of states was reached.
    NotDecided,
}

/// Explores a chart up to `limit` states. Also returns how many were found.
pub(crate) fn explored(
    abstraction: &Abstraction,
    bound: &BoundProperty,
    limit: usize,
) -> (ExplorationVerdict, usize) {
    let plan = &*bound.plan;
    let chart = abstraction.chart.clone();
    let idle = idle(chart.statechart(), plan);
    let pace = plan.is_bounded().then(|| pace(chart.statechart(), plan));
    let has_idle = !idle.is_empty();
    let mut surroundings = surroundings(abstraction, plan, has_idle);
    let mut asked = StepLabeler {
        conditions: conditions(plan).count() as u32,
        idle,
        pace,
        letter: Box::new(|seen: &StepObservation<'_>| letter(plan, seen)),
    };
    let found = explore_labelled(&chart, &mut surroundings, &mut asked, limit);
    let tick = pace.map_or(1, |pace| nanoseconds(pace.tick));
    let contrary = bound.contrary.clone().in_units(tick);
    let states = found.states().len();
    let answer =
        match product::violation(&found, &contrary, pace.is_some(), has_idle, limit.saturating_mul(4)) {
            SearchOutcome::Violation(violation) => {
                let is_circle = !violation.cycle.is_empty();
                ExplorationVerdict::Violated(
                    trace_text(&found, &violation, plan, chart.as_ref(), pace),
                    is_circle,
                )
            }
            SearchOutcome::Nothing if found.is_finished() => ExplorationVerdict::Holds,
            SearchOutcome::Nothing | SearchOutcome::TooMuch => ExplorationVerdict::NotDecided,
        };
    (answer, states)
}

fn conditions(plan: &CompiledProperty) -> impl Iterator<Item = &Expression> {
    plan.atoms().iter().filter_map(|atom| match atom {
        AtomicProposition::Condition(condition) => Some(condition),
        _ => None,
    })
}

/// The atoms that are true of a step, as bits.
fn letter(plan: &CompiledProperty, seen: &StepObservation<'_>) -> u64 {
    let mut conditions = seen.conditions.iter();
    let holds = |atom: &AtomicProposition, next: &mut std::slice::Iter<'_, bool>| match atom {
        AtomicProposition::In(node) => seen.configuration.contains(node),
        AtomicProposition::Entering(node) => seen.entered.contains(node),
        AtomicProposition::Leaving(node) => seen.left.contains(node),
        AtomicProposition::Event(event) => seen.events.contains(event),
        AtomicProposition::Condition(_) => next.next().copied().unwrap_or(false),
    };
    plan.atoms()
        .iter()
        .enumerate()
        .fold(0, |letter, (bit, atom)| letter | u64::from(holds(atom, &mut conditions)) << bit)
}

/// The environment of the chart. Conditions of the property follow those of the chart.
fn surroundings<'a>(
    abstraction: &'a Abstraction,
    plan: &'a CompiledProperty,
    has_idle: bool,
) -> Environment<'a> {
    let own = abstraction.conditions.len();
    let asked: Vec<&Expression> = conditions(plan).collect();
    let mut surroundings = abstraction.surroundings();
    // a step of an idle region looks like one in which only messages arrive
    surroundings.messages |= has_idle || !asked.is_empty();
    let logic = GuardSolver::new(&abstraction.constants);
    let mut known: BTreeMap<Vec<(ScriptId, bool)>, bool> = BTreeMap::new();
    surroundings.allows = Box::new(move |script, value, decided| {
        let mut together: Vec<(ScriptId, bool)> = decided.to_vec();
        together.push((script, value));
        together.sort_unstable();
        together.dedup();
        *known.entry(together).or_insert_with_key(|together| {
            let claims = together.iter().filter_map(|&(script, value)| {
                let place = script.0 as usize;
                let condition = match place.checked_sub(own) {
                    Some(place) => *asked.get(place)?,
                    None => abstraction.conditions[place].as_ref()?,
                };
                Some(if value { Claim::Holds(condition) } else { Claim::DoesNotHold(condition) })
            });
            !logic.together(&claims.collect::<Vec<_>>()).is_no()
        })
    });
    surroundings
}

/// The largest unit of time that divides every delay.
fn pace(chart: &Statechart, plan: &CompiledProperty) -> ClockModel {
    let of_transitions = chart.transitions().flat_map(|(_, it)| &it.expression.actions);
    let of_nodes = chart.nodes().flat_map(|(_, node)| node.entry.iter().chain(&node.exit));
    let timers = of_transitions.chain(of_nodes).filter_map(delay);
    let durations = chart.nodes().filter_map(|(_, node)| node.duration);
    let delays = timers.chain(durations).map(nanoseconds).chain(plan.bounds());
    let tick = delays.filter(|&delay| delay > 0).fold(0, greatest_common_divisor).max(1);
    let longest = plan.bounds().max().unwrap_or(0) / tick + 1;
    ClockModel { tick: Duration::from_nanos(tick), longest }
}

fn delay(action: &Action) -> Option<Duration> {
    match &action.kind {
        ActionKind::StartTimeout { delay, .. } => Some(*delay),
        _ => None,
    }
}

fn nanoseconds(time: Duration) -> u64 {
    u64::try_from(time.as_nanos()).unwrap_or(u64::MAX)
}

fn greatest_common_divisor(mut one: u64, mut other: u64) -> u64 {
    while other != 0 {
        (one, other) = (other, one % other);
    }
    one
}

/// A run as text: its steps, with the true propositions and the elapsed time as comments.
fn trace_text(
    found: &LabelledGraph,
    violation: &Violation,
    plan: &CompiledProperty,
    chart: &CompiledChart,
    pace: Option<ClockModel>,
) -> String {
    let way: Vec<usize> = violation.prefix.iter().chain(&violation.cycle).copied().collect();
    let trace = found.trace_along(&way);
    let mut text = String::new();
    for (index, (&place, step)) in way.iter().zip(trace.steps()).enumerate() {
        let known = &found.steps()[place];
        if index == violation.prefix.len() {
            text += "# repeats forever from here\n";
        }
        if let Some(pace) = pace.filter(|_| known.elapsed > 0) {
            let milliseconds = pace.tick.as_secs_f64() * known.elapsed as f64 * 1e3;
            text += &format!("# after {milliseconds} ms\n");
        }
        text += &trace.text_of(step);
        let atoms = plan.atoms().iter().enumerate().filter(|(bit, _)| known.letter & (1 << bit) != 0);
        let names: Vec<String> = atoms.map(|(_, atom)| named(atom, chart)).collect();
        if !names.is_empty() {
            text += &format!("  # {}\n", names.join(", "));
        }
    }
    text
}

/// The text of an atom.
pub(crate) fn named(atom: &AtomicProposition, chart: &CompiledChart) -> String {
    let path = |node| shortest_path(chart.statechart(), node);
    match atom {
        AtomicProposition::In(node) => format!("in {}", path(*node)),
        AtomicProposition::Entering(node) => format!("entering {}", path(*node)),
        AtomicProposition::Leaving(node) => format!("leaving {}", path(*node)),
        AtomicProposition::Event(event) => format!("event {}", chart.events().name(*event)),
        AtomicProposition::Condition(condition) => format!("[{condition}]"),
    }
}

/// The regions without influence on a property.
fn idle(chart: &Statechart, plan: &CompiledProperty) -> Vec<NodeId> {
    cone_of_influence::idle_but(chart, &|region| is_mentioned(chart, plan, region))
}

fn is_mentioned(chart: &Statechart, plan: &CompiledProperty, region: NodeId) -> bool {
    plan.atoms().iter().any(|atom| match atom {
        AtomicProposition::In(node)
        | AtomicProposition::Entering(node)
        | AtomicProposition::Leaving(node) => cone_of_influence::is_within(chart, *node, region),
        AtomicProposition::Event(_) | AtomicProposition::Condition(_) => false,
    })
}
