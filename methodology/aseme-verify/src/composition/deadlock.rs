//! Deadlocks: robots that wait for messages no other robot will send.

use super::product::{GlobalEvent, GlobalProduct, ProductEdge};
use crate::conformance::graph::LabelledEdge;

/// The number of further states of a deadlock that are tried if the path to the first is not
/// confirmed.
const MAX_FURTHER_STATES: usize = 32;

/// States in which some robots wait forever.
pub(crate) struct Deadlock {
    /// States in which they do, the one where most robots take part first.
    pub(crate) states: Vec<usize>,
    /// Robots and their waits.
    pub(crate) waits: Vec<(usize, usize)>,
}

/// The deadlocks, each reported once, in the state where most robots take part.
pub(crate) fn deadlocks(product: &GlobalProduct<'_>) -> Vec<Deadlock> {
    let waits = product.robots.iter().enumerate();
    let waits: Vec<(usize, usize)> =
        waits.flat_map(|(robot, it)| (0..it.waits.len()).map(move |wait| (robot, wait))).collect();
    let before = backwards(product);
    let ends: Vec<Vec<bool>> =
        waits.iter().map(|&(robot, wait)| may_end(product, &before, robot, wait)).collect();
    let is_stuck = |number: usize, state: usize| {
        let (robot, wait) = waits[number];
        let (behaviour, class) = (&product.behaviours[robot], product.states[state].classes[robot]);
        behaviour.waiting[class].contains(&wait) && behaviour.may_end[wait][class] && !ends[number][state]
    };
    let next = forwards(product);
    let mut reported = vec![false; waits.len()];
    let mut found = Vec::new();
    for state in 0..product.states.len() {
        if !(0..waits.len()).any(|number| !reported[number] && is_stuck(number, state)) {
            continue;
        }
        let stuck_in = |state: usize| (0..waits.len()).filter(|&it| is_stuck(it, state)).collect::<Vec<_>>();
        let worst = worst_from(state, &next, &|state| stuck_in(state).len());
        let stuck = stuck_in(worst);
        stuck.iter().for_each(|&number| reported[number] = true);
        (0..waits.len()).filter(|&it| is_stuck(it, state)).for_each(|number| reported[number] = true);
        let also = (0..product.states.len())
            .filter(|&it| it != worst && stuck.iter().all(|&number| is_stuck(number, it)));
        let states = std::iter::once(worst).chain(also.take(MAX_FURTHER_STATES)).collect();
        found.push(Deadlock { states, waits: stuck.into_iter().map(|it| waits[it]).collect() });
    }
    found
}

fn backwards(product: &GlobalProduct<'_>) -> Vec<Vec<usize>> {
    let mut before = vec![Vec::new(); product.states.len()];
    product.edges.iter().for_each(|edge| before[edge.to].push(edge.from));
    before
}

fn forwards(product: &GlobalProduct<'_>) -> Vec<Vec<usize>> {
    let mut next = vec![Vec::new(); product.states.len()];
    product.edges.iter().for_each(|edge| next[edge.from].push(edge.to));
    next
}

/// The states from which a wait can end. Unexplored states count as such, to avoid false alarms.
fn may_end(product: &GlobalProduct<'_>, before: &[Vec<usize>], robot: usize, wait: usize) -> Vec<bool> {
    let ends = |edge: &&ProductEdge| {
        let step = step_of(product, edge, robot);
        step.is_some_and(|edge| product.behaviours[robot].step_interface(&edge).exited_waits.contains(&wait))
    };
    let mut open: Vec<usize> = product.edges.iter().filter(ends).map(|edge| edge.from).collect();
    open.extend(&product.open_ended);
    let mut reaches = vec![false; product.states.len()];
    while let Some(state) = open.pop() {
        if !std::mem::replace(&mut reaches[state], true) {
            open.extend(&before[state]);
        }
    }
    reaches
}

/// The step of a robot on an edge, if it makes one.
fn step_of(product: &GlobalProduct<'_>, edge: &ProductEdge, robot: usize) -> Option<LabelledEdge> {
    match edge.by {
        GlobalEvent::Step { robot: it, edge } if it == robot => Some(edge),
        GlobalEvent::Arrival { passage, edge } if product.passages[passage].to == robot => edge,
        _ => None,
    }
}

/// The nearest state with the most endless waits; along a path their number never decreases.
fn worst_from(state: usize, next: &[Vec<usize>], count: &dyn Fn(usize) -> usize) -> usize {
    let mut seen = std::collections::BTreeSet::from([state]);
    let mut open = std::collections::VecDeque::from([state]);
    let (mut worst, mut max) = (state, count(state));
    while let Some(state) = open.pop_front() {
        let stuck = count(state);
        if stuck > max {
            (worst, max) = (state, stuck);
        }
        open.extend(next[state].iter().copied().filter(|&to| seen.insert(to)));
    }
    worst
}
