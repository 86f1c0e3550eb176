//! A property held against all that a chart can do.

use std::collections::BTreeMap;
use std::time::Duration;

use yase::explore::{Pace, Seen, Surroundings, Watch, Watched, watch};
use yase::expression::{Action, ActionKind, Expression, ScriptId};
use yase::{Chart, Statechart};

use super::cone;
use super::names::Bound;
use super::plan::{Atom, Plan};
use super::product::{self, Found, Violation};
use crate::check::abstraction::Abstraction;
use crate::check::logic::{Claim, Logic};
use crate::path::shortest_path;

/// What an exploration says of a property.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Answer {
    Holds,
    /// A run that violates it, as text that [`yase::explore::Trace::parse`] reads; and whether it goes round in a circle.
    Violated(String, bool),
    /// There was more than was looked at.
    NotDecided,
}

/// Explores a chart, looking at no more than `limit` states. Gives how many it found too.
pub(super) fn explored(abstraction: &Abstraction, bound: &Bound, limit: usize) -> (Answer, usize) {
    let plan = &*bound.plan;
    let chart = abstraction.chart.clone();
    let idle = cone::idle(chart.statechart(), plan);
    let pace = plan.is_bounded().then(|| pace(chart.statechart(), plan));
    let has_idle = !idle.is_empty();
    let mut surroundings = surroundings(abstraction, plan, has_idle);
    let mut asked = Watch {
        conditions: conditions(plan).count() as u32,
        idle,
        pace,
        letter: Box::new(|seen: &Seen<'_>| letter(plan, seen)),
    };
    let found = watch(&chart, &mut surroundings, &mut asked, limit);
    let tick = pace.map_or(1, |pace| nanoseconds(pace.tick));
    let contrary = bound.contrary.clone().in_units(tick);
    let states = found.states().len();
    let answer =
        match product::violation(&found, &contrary, pace.is_some(), has_idle, limit.saturating_mul(4)) {
            Found::Violation(violation) => {
                let is_circle = !violation.circle.is_empty();
                Answer::Violated(told(&found, &violation, plan, chart.as_ref(), pace), is_circle)
            }
            Found::Nothing if found.is_finished() => Answer::Holds,
            Found::Nothing | Found::TooMuch => Answer::NotDecided,
        };
    (answer, states)
}

fn conditions(plan: &Plan) -> impl Iterator<Item = &Expression> {
    plan.atoms().iter().filter_map(|atom| match atom {
        Atom::Condition(condition) => Some(condition),
        _ => None,
    })
}

/// What is true of a step.
fn letter(plan: &Plan, seen: &Seen<'_>) -> u64 {
    let mut conditions = seen.conditions.iter();
    let holds = |atom: &Atom, next: &mut std::slice::Iter<'_, bool>| match atom {
        Atom::In(node) => seen.configuration.contains(node),
        Atom::Entering(node) => seen.entered.contains(node),
        Atom::Leaving(node) => seen.left.contains(node),
        Atom::Event(event) => seen.events.contains(event),
        Atom::Condition(_) => next.next().copied().unwrap_or(false),
    };
    plan.atoms()
        .iter()
        .enumerate()
        .fold(0, |letter, (bit, atom)| letter | u64::from(holds(atom, &mut conditions)) << bit)
}

/// What may happen around the chart. Conditions of the property stand behind those of the chart.
fn surroundings<'a>(abstraction: &'a Abstraction, plan: &'a Plan, has_idle: bool) -> Surroundings<'a> {
    let own = abstraction.conditions.len();
    let asked: Vec<&Expression> = conditions(plan).collect();
    let mut surroundings = abstraction.surroundings();
    // a step of a part that is left to do nothing looks like one in which messages come
    surroundings.messages |= has_idle || !asked.is_empty();
    let logic = Logic::new(&abstraction.constants);
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

/// The largest unit of which every delay is a whole number.
fn pace(chart: &Statechart, plan: &Plan) -> Pace {
    let of_transitions = chart.transitions().flat_map(|(_, it)| &it.expression.actions);
    let of_nodes = chart.nodes().flat_map(|(_, node)| node.entry.iter().chain(&node.exit));
    let timers = of_transitions.chain(of_nodes).filter_map(delay);
    let durations = chart.nodes().filter_map(|(_, node)| node.duration);
    let delays = timers.chain(durations).map(nanoseconds).chain(plan.bounds());
    let tick = delays.filter(|&delay| delay > 0).fold(0, greatest_common_divisor).max(1);
    let longest = plan.bounds().max().unwrap_or(0) / tick + 1;
    Pace { tick: Duration::from_nanos(tick), longest }
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

/// A run as text: its steps, and as comments what is true of them and how much time goes by.
fn told(found: &Watched, violation: &Violation, plan: &Plan, chart: &Chart, pace: Option<Pace>) -> String {
    let way: Vec<usize> = violation.way.iter().chain(&violation.circle).copied().collect();
    let trace = found.trace_along(&way);
    let mut text = String::new();
    for (index, (&place, step)) in way.iter().zip(trace.steps()).enumerate() {
        let known = &found.steps()[place];
        if index == violation.way.len() {
            text += "# from here on again and again\n";
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

/// What an atom says.
pub(super) fn named(atom: &Atom, chart: &Chart) -> String {
    let path = |node| shortest_path(chart.statechart(), node);
    match atom {
        Atom::In(node) => format!("in {}", path(*node)),
        Atom::Entering(node) => format!("entering {}", path(*node)),
        Atom::Leaving(node) => format!("leaving {}", path(*node)),
        Atom::Event(event) => format!("event {}", chart.events().name(*event)),
        Atom::Condition(condition) => format!("[{condition}]"),
    }
}
