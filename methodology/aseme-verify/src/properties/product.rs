//! The product of a chart's state space and the automaton of a negated property.
//!
//! A product state is a pair of a chart state and a [`Clause`] of the negated property. A run
//! violates the property if it reaches a product state without obligations, if it ends in one
//! without unfulfilled obligations, or if it enters an accepting cycle. A cycle counts only if the
//! chart can repeat it: running activities return, timers that are started expire, and time, if
//! counted, advances.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

use yase::Status;
use yase_explore::{LabelledGraph, LabelledStep, PendingEvent};

use super::clause::{Clause, Scratch, TimedLetter};
use super::compiled_property::{CompiledProperty, Subformula};
use crate::run_replay::Unconfirmed;
use crate::strongly_connected_components::strongly_connected_components;

/// A violating run, as steps.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Violation {
    pub(crate) prefix: Vec<usize>,
    /// The steps of the cycle at its end; empty if the run is finite.
    pub(crate) cycle: Vec<usize>,
}

/// The result of the search.
pub(crate) enum SearchOutcome {
    Violation(Violation),
    /// Runs of the graph violate the property, but none of those that were tried is confirmed to be
    /// a run of the chart: the first one, and why not.
    NotConfirmed(Violation, String),
    Nothing,
    /// The limit of states was reached.
    TooMuch,
}

/// The number of runs that are tried.
const MAX_RUNS: usize = 256;

/// Confirms that a run of the graph is one of the chart, or says why it is not known to be.
pub(crate) type Confirmation<'c> = dyn FnMut(&Violation) -> Result<(), Unconfirmed> + 'c;

/// Searches for a run that satisfies the negation of a property, among at most `limit` product
/// states. Bounds are in ticks. Runs that are not confirmed are passed over.
pub(crate) fn violation(
    found: &LabelledGraph,
    negation: &CompiledProperty,
    is_timed: bool,
    has_idle: bool,
    limit: usize,
    confirm: &mut Confirmation<'_>,
) -> SearchOutcome {
    let mut candidates = Candidates { confirm, tried: 0, first: None };
    let (from, begin) = outgoing(found);
    let mut search = ProductSearch {
        found,
        negation,
        has_idle,
        from,
        positions: Vec::new(),
        numbers: BTreeMap::new(),
        next: Vec::new(),
        limit,
        is_whole: true,
    };
    if let Some(violation) = search.reached(begin, &mut candidates) {
        return SearchOutcome::Violation(violation);
    }
    let circles = CycleSearch { search: &search, is_timed };
    match (circles.find(&mut candidates), candidates.first) {
        (Some(violation), _) => SearchOutcome::Violation(violation),
        (None, Some((violation, why))) => SearchOutcome::NotConfirmed(violation, why),
        (None, None) if search.is_whole => SearchOutcome::Nothing,
        (None, None) => SearchOutcome::TooMuch,
    }
}

/// Runs of the graph that violate the property.
struct Candidates<'c, 'f> {
    confirm: &'c mut Confirmation<'f>,
    tried: usize,
    /// The first that is not confirmed, and why.
    first: Option<(Violation, String)>,
}

impl Candidates<'_, '_> {
    /// The run, or one that differs from it only in what it reads, if it is confirmed. At each step
    /// are given the steps that lead between the same places.
    fn confirmed(&mut self, run: Violation, alternatives: &[Vec<usize>]) -> Option<Violation> {
        let mut chosen = vec![0; alternatives.len()];
        let mut candidate = run.clone();
        while self.tried < MAX_RUNS {
            self.tried += 1;
            let Err(unconfirmed) = (self.confirm)(&candidate) else { return Some(candidate) };
            self.first.get_or_insert_with(|| (run.clone(), unconfirmed.reason));
            // the second turn of a circle is made of the same steps
            let index = match unconfirmed.step {
                step if step < chosen.len() => step,
                step => step.saturating_sub(run.cycle.len()).min(chosen.len().checked_sub(1)?),
            };
            let has_more = |&position: &usize| chosen[position] + 1 < alternatives[position].len();
            let last = (0..=index).rev().find(has_more)?;
            chosen[last] += 1;
            chosen[last + 1..].fill(0);
            let steps = candidate.prefix.iter_mut().chain(&mut candidate.cycle);
            for (step, (alternatives, chosen)) in steps.zip(alternatives.iter().zip(&chosen)) {
                *step = alternatives[*chosen];
            }
        }
        None
    }
}

/// The steps out of each state, and those that start the chart.
fn outgoing(found: &LabelledGraph) -> (Vec<Vec<usize>>, Vec<usize>) {
    let mut from = vec![Vec::new(); found.states().len()];
    let mut begin = Vec::new();
    for (index, step) in found.steps().iter().enumerate() {
        match step.from {
            Some(state) => from[state].push(index),
            None => begin.push(index),
        }
    }
    (from, begin)
}

struct ProductPosition {
    state: usize,
    clause: Clause,
    /// The predecessor and the step that first led here.
    predecessor: (Option<usize>, usize),
}

struct ProductSearch<'a> {
    found: &'a LabelledGraph,
    negation: &'a CompiledProperty,
    /// Whether idle regions were left out: then the chart is never stable.
    has_idle: bool,
    from: Vec<Vec<usize>>,
    positions: Vec<ProductPosition>,
    numbers: BTreeMap<(usize, Clause), usize>,
    /// The successors of each product state and the steps to them.
    next: Vec<Vec<(usize, usize)>>,
    limit: usize,
    is_whole: bool,
}

impl<'a> ProductSearch<'a> {
    fn step(&self, index: usize) -> &'a LabelledStep {
        &self.found.steps()[index]
    }

    /// The shortest run at whose end the property is violated.
    fn reached(&mut self, begin: Vec<usize>, candidates: &mut Candidates<'_, '_>) -> Option<Violation> {
        let mut stack = Scratch::new();
        let mut open = VecDeque::new();
        for step in begin {
            let at = TimedLetter { letter: self.step(step).letter, now: 0 };
            if stack.begin(self.negation, at).is_err() {
                // the clauses of a step that was not finished imply nothing
                self.is_whole = false;
                continue;
            }
            if let Some(found) = self.arrive(None, step, &stack, &mut open, candidates) {
                return Some(found);
            }
        }
        while let Some(index) = open.pop_front() {
            let ProductPosition { state, clause, .. } = self.positions[index];
            if self.may_end(state) && !clause.awaits(self.negation) {
                let run = Violation { prefix: self.path_to(Some(index)), cycle: Vec::new() };
                let alternatives = self.alternatives_to(Some(index));
                if let Some(run) = candidates.confirmed(run, &alternatives) {
                    return Some(run);
                }
            }
            for step in self.from[state].clone() {
                let at = TimedLetter { letter: self.step(step).letter, now: self.step(step).elapsed };
                if stack.step(self.negation, &[clause], at).is_err() {
                    self.is_whole = false;
                    continue;
                }
                if let Some(found) = self.arrive(Some(index), step, &stack, &mut open, candidates) {
                    return Some(found);
                }
            }
        }
        None
    }

    /// Whether the run may end in a state.
    fn may_end(&self, state: usize) -> bool {
        let it = &self.found.states()[state];
        it.status != Status::Running || (it.pending.is_empty() && !self.has_idle)
    }

    fn arrive(
        &mut self,
        from: Option<usize>,
        step: usize,
        stack: &Scratch,
        open: &mut VecDeque<usize>,
        candidates: &mut Candidates<'_, '_>,
    ) -> Option<Violation> {
        let LabelledStep { to, elapsed, .. } = *self.step(step);
        for clause in stack.clauses() {
            if clause.is_true() {
                let mut indices = self.path_to(from);
                indices.push(step);
                let mut alternatives = self.alternatives_to(from);
                alternatives.push(vec![step]);
                match candidates.confirmed(Violation { prefix: indices, cycle: Vec::new() }, &alternatives) {
                    Some(run) => return Some(run),
                    None => continue,
                }
            }
            let clause = clause.shifted(elapsed, self.negation);
            let count = self.positions.len();
            let index = match self.numbers.entry((to, clause)) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(_) if count == self.limit => {
                    self.is_whole = false;
                    continue;
                }
                Entry::Vacant(new) => {
                    new.insert(count);
                    self.positions.push(ProductPosition { state: to, clause, predecessor: (from, step) });
                    self.next.push(Vec::new());
                    open.push_back(count);
                    count
                }
            };
            if let Some(from) = from {
                self.next[from].push((index, step));
            }
        }
        None
    }

    /// The steps between two places that take the same time and end the same, a given one first.
    fn alternatives(&self, from: usize, to: usize, first: usize) -> Vec<usize> {
        let like = self.step(first);
        let others = self.next[from].iter().filter(|(it, step)| *it == to && *step != first);
        let is_alike =
            |step: &usize| (self.step(*step).elapsed, self.step(*step).ends) == (like.elapsed, like.ends);
        std::iter::once(first).chain(others.map(|(_, step)| *step).filter(is_alike)).collect()
    }

    /// The alternatives at each step of the path to a place.
    fn alternatives_to(&self, mut index: Option<usize>) -> Vec<Vec<usize>> {
        let mut found = Vec::new();
        while let Some(at) = index {
            let (before, step) = self.positions[at].predecessor;
            found.push(before.map_or_else(|| vec![step], |before| self.alternatives(before, at, step)));
            index = before;
        }
        found.reverse();
        found
    }

    fn path_to(&self, mut index: Option<usize>) -> Vec<usize> {
        let mut indices = Vec::new();
        while let Some(at) = index {
            let (before, step) = self.positions[at].predecessor;
            indices.push(step);
            index = before;
        }
        indices.reverse();
        indices
    }
}

/// The search for an accepting cycle in the explored product.
struct CycleSearch<'a> {
    search: &'a ProductSearch<'a>,
    is_timed: bool,
}

impl CycleSearch<'_> {
    fn find(&self, runs: &mut Candidates<'_, '_>) -> Option<Violation> {
        let components = strongly_connected_components(&self.search.next);
        let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, &component) in components.iter().enumerate() {
            members.entry(component).or_default().push(index);
        }
        // the component that was reached first
        let mut candidates: Vec<(usize, Vec<usize>)> = members.into_values().map(|it| (it[0], it)).collect();
        candidates.sort_unstable();
        candidates.into_iter().find_map(|(first, members)| {
            let inside: BTreeSet<usize> = members.into_iter().collect();
            let stops = self.stops(&inside)?;
            let circle = self.find_cycle(first, &stops, &inside)?;
            let mut alternatives = self.search.alternatives_to(Some(first));
            let mut at = first;
            for &step in &circle {
                let to = self.search.next[at].iter().find(|(_, it)| *it == step)?.0;
                alternatives.push(self.search.alternatives(at, to, step));
                at = to;
            }
            let prefix = self.search.path_to(Some(first));
            runs.confirmed(Violation { prefix, cycle: circle }, &alternatives)
        })
    }

    /// The states and edges that a violating cycle must visit; `None` if there can be no such
    /// cycle.
    fn stops(&self, inside: &BTreeSet<usize>) -> Option<Vec<CycleStop>> {
        let search = self.search;
        let mut stops = Vec::new();
        for (obligation, &(term, _)) in search.negation.obligations.iter().enumerate() {
            if matches!(search.negation.terms[term], Subformula::Until { bound: None, .. }) {
                let met = |index: &&usize| !search.positions[**index].clause.has(obligation);
                stops.push(CycleStop::Place(*inside.iter().find(met)?));
            }
        }
        let steps = || {
            inside.iter().flat_map(|&position| {
                let next = search.next[position].iter().filter(|(to, _)| inside.contains(to));
                next.map(move |&(to, step)| (position, to, step))
            })
        };
        steps().next()?;
        if self.is_timed {
            let (from, to, step) = steps().find(|&(.., step)| search.step(step).elapsed > 0)?;
            stops.push(CycleStop::Step(from, to, step));
            return Some(stops);
        }
        let pending = |position: usize| &search.found.states()[search.positions[position].state].pending;
        let first = *inside.first()?;
        let always =
            pending(first).iter().filter(|it| inside.iter().all(|&position| pending(position).contains(it)));
        for &waiting in always {
            let ends =
                |&(.., step): &(usize, usize, usize)| search.step(step).ends == Some::<PendingEvent>(waiting);
            let (from, to, step) = steps().find(ends)?;
            stops.push(CycleStop::Step(from, to, step));
        }
        for &waiting in pending(first) {
            if let Some(&position) = inside.iter().find(|&&position| !pending(position).contains(&waiting)) {
                stops.push(CycleStop::Place(position));
            }
        }
        Some(stops)
    }

    /// A cycle through a state and all stops.
    fn find_cycle(&self, first: usize, stops: &[CycleStop], inside: &BTreeSet<usize>) -> Option<Vec<usize>> {
        let (mut at, mut circle) = (first, Vec::new());
        for stop in stops {
            match *stop {
                CycleStop::Place(index) => circle.extend(self.path_within(at, index, inside)?),
                CycleStop::Step(from, ..) => circle.extend(self.path_within(at, from, inside)?),
            }
            at = match *stop {
                CycleStop::Place(position) => position,
                CycleStop::Step(_, to, step) => {
                    circle.push(step);
                    to
                }
            };
        }
        if circle.is_empty() {
            let &(to, step) = self.search.next[at].iter().find(|(to, _)| inside.contains(to))?;
            circle.push(step);
            at = to;
        }
        circle.extend(self.path_within(at, first, inside)?);
        Some(circle)
    }

    fn path_within(&self, from: usize, to: usize, inside: &BTreeSet<usize>) -> Option<Vec<usize>> {
        let mut came: BTreeMap<usize, Option<(usize, usize)>> = BTreeMap::from([(from, None)]);
        let mut open = VecDeque::from([from]);
        while let Some(at) = open.pop_front() {
            if at == to {
                let (mut indices, mut at) = (Vec::new(), at);
                while let Some(Some((before, step))) = came.get(&at) {
                    indices.push(*step);
                    at = *before;
                }
                indices.reverse();
                return Some(indices);
            }
            for &(next, step) in self.search.next[at].iter().filter(|(next, _)| inside.contains(next)) {
                if let Entry::Vacant(entry) = came.entry(next) {
                    entry.insert(Some((at, step)));
                    open.push_back(next);
                }
            }
        }
        None
    }
}

/// A state that a cycle must visit.
enum CycleStop {
    Place(usize),
    Step(usize, usize, usize),
}
