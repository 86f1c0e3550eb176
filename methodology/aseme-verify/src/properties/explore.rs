//! Explores a chart for a violation of a property.

use std::time::Duration;

use yase::expression::{Action, ActionKind, Expression, Path};
use yase::{CompiledChart, NodeId, Statechart};
use yase_explore::{
    ClockModel, Environment, LabelledGraph, StepLabeler, StepObservation, Trace, TraceStep, explore_labelled,
};

use super::compiled_property::{AtomicProposition, CompiledProperty};
use super::names::BoundProperty;
use super::product::{self, SearchOutcome, Violation};
use crate::abstraction::Abstraction;
use crate::check_settings::CheckSettings;
use crate::cone_of_influence;
use crate::program_symbols::ProgramSymbols;
use crate::run_replay::{MessageSources, RunReplay, Unconfirmed};
use aseme::path::shortest_path;

/// The result of an exploration for a property.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum ExplorationVerdict {
    Holds,
    /// A violating run, as text that [`yase_explore::Trace::parse`] reads, and whether it ends in a
    /// cycle.
    Violated(String, bool),
    /// The exploration has such a run, but the machine is not known to make it: why.
    NotConfirmed(String, String),
    /// The limit of states was reached.
    NotDecided,
}

/// Explores a chart up to `limit` states. Also returns how many were found.
pub(crate) fn explored(
    abstraction: &Abstraction,
    bound: &BoundProperty,
    settings: &CheckSettings,
) -> (ExplorationVerdict, usize) {
    let limit = settings.states;
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
    let found = explore_labelled(&chart, &mut surroundings, &mut asked, settings.limits());
    let tick = pace.map_or(1, |pace| nanoseconds(pace.tick));
    let negation = bound.negation.clone().in_units(tick);
    let states = found.states().len();
    let mut confirm = |run: &Violation| confirmed(abstraction, plan, &found, run, settings);
    let (is_timed, max) = (pace.is_some(), limit.saturating_mul(4));
    let text = |violation: &Violation| trace_text(&found, violation, plan, chart.as_ref(), pace);
    let answer = match product::violation(&found, &negation, is_timed, has_idle, max, &mut confirm) {
        SearchOutcome::Violation(violation) => {
            ExplorationVerdict::Violated(text(&violation), !violation.cycle.is_empty())
        }
        SearchOutcome::NotConfirmed(violation, why) => {
            ExplorationVerdict::NotConfirmed(text(&violation), why)
        }
        SearchOutcome::Nothing if found.is_finished() => ExplorationVerdict::Holds,
        SearchOutcome::Nothing | SearchOutcome::TooMuch => ExplorationVerdict::NotDecided,
    };
    (answer, states)
}

/// Executes a run of the graph on the machine: first as if nothing else published what the chart
/// assigns itself, then with messages of others. A circle is executed twice.
fn confirmed(
    abstraction: &Abstraction,
    plan: &CompiledProperty,
    found: &LabelledGraph,
    run: &Violation,
    settings: &CheckSettings,
) -> Result<(), Unconfirmed> {
    let indices: Vec<usize> = run.prefix.iter().chain(&run.cycle).chain(&run.cycle).copied().collect();
    let replayed = |sources| replayed(abstraction, plan, found, &indices, sources);
    let is_own = |path: &Path| abstraction.is_assigned(path);
    let alone = replayed(MessageSources { is_own: &is_own, announced: abstraction.awaited.clone() });
    if alone.is_ok() || abstraction.assignments.iter().all(Option::is_none) {
        return alone;
    }
    let is_own = |path: &Path| is_own(path) && !others_publish(path, settings.world.as_ref());
    replayed(MessageSources { is_own: &is_own, announced: abstraction.awaited.clone() })
}

fn replayed(
    abstraction: &Abstraction,
    plan: &CompiledProperty,
    found: &LabelledGraph,
    indices: &[usize],
    sources: MessageSources<'_>,
) -> Result<(), Unconfirmed> {
    let chart = &abstraction.chart;
    let idle = yase_explore::idle_regions(chart, &idle(chart.statechart(), plan));
    let mut replay = RunReplay::new(abstraction, idle, sources);
    let trace = found.trace_along(indices);
    for ((number, step), &index) in trace.steps().iter().enumerate().zip(indices) {
        let at = |why: String| {
            let reason = format!("at step {}, `{}`: {why}", number + 1, first_line(&trace, step));
            Unconfirmed { step: number, reason }
        };
        replay.step(step).map_err(at)?;
        let known = &found.steps()[index];
        if replay.configuration() != found.states()[known.to].configuration {
            return Err(at("the machine comes to other states".into()));
        }
        for (bit, atom) in plan.atoms().iter().enumerate() {
            if let AtomicProposition::Condition(condition) = atom {
                replay.claim(condition, known.letter & (1 << bit) != 0);
            }
        }
    }
    replay.verdict()
}

fn first_line(trace: &Trace, step: &TraceStep) -> String {
    trace.text_of(step).lines().next().unwrap_or_default().to_owned()
}

/// Whether others than the chart may publish the message of a field, as far as the program says.
fn others_publish(path: &Path, world: Option<&ProgramSymbols>) -> bool {
    world.is_some_and(|world| world.may_publish(path))
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
    let asked: Vec<&Expression> = conditions(plan).collect();
    let mut surroundings = abstraction.surroundings();
    // a step of an idle region looks like one in which only messages arrive
    surroundings.messages |= has_idle || !asked.is_empty();
    surroundings.allows = Box::new(abstraction.satisfiable(&asked));
    surroundings.effects = abstraction.effects(&asked);
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
    let indices: Vec<usize> = violation.prefix.iter().chain(&violation.cycle).copied().collect();
    let trace = found.trace_along(&indices);
    let mut text = String::new();
    for (index, (&position, step)) in indices.iter().zip(trace.steps()).enumerate() {
        let known = &found.steps()[position];
        if index == violation.prefix.len() {
            text += "# repeats forever from here\n";
        }
        if let Some(pace) = pace.filter(|_| known.elapsed > 0) {
            let milliseconds = pace.tick.as_nanos() as f64 * known.elapsed as f64 / 1e6;
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
