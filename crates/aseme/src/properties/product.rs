//! A chart's steps together with what a run that violates a property still has to do.
//!
//! Each pair of a state and a [`Clause`] of the contrary is a place. A run violates the property if it comes to a place where nothing is left to be done, if it ends
//! where nothing has to come any more, or if it goes round for ever in a circle that meets everything that has to come. A circle counts only if the chart may really
//! go round in it: what runs comes back some day, what is set expires, and where time is counted it goes on.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

use yase::Status;
use yase::explore::{Pending, Watched, WatchedStep};

use super::clause::{Clause, Position, Stack};
use super::plan::{Plan, Term};
use crate::components::components;

/// A run that violates a property, by its steps.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Violation {
    pub(super) way: Vec<usize>,
    /// What is repeated for ever after that; nothing if the run has gone wrong at the end of the way, or ends there.
    pub(super) circle: Vec<usize>,
}

/// What came of the search.
pub(super) enum Found {
    Violation(Violation),
    Nothing,
    /// There was more than was looked at.
    TooMuch,
}

/// Looks for a run that meets the contrary of a property, looking at no more than `limit` places. Bounds are in ticks.
pub(super) fn violation(
    found: &Watched,
    contrary: &Plan,
    is_timed: bool,
    has_idle: bool,
    limit: usize,
) -> Found {
    let (from, begin) = outgoing(found);
    let mut search = Search {
        found,
        contrary,
        has_idle,
        from,
        places: Vec::new(),
        numbers: BTreeMap::new(),
        next: Vec::new(),
        limit,
        is_whole: true,
    };
    if let Some(violation) = search.reached(begin) {
        return Found::Violation(violation);
    }
    let circles = Circles { search: &search, is_timed };
    match circles.find() {
        Some(violation) => Found::Violation(violation),
        None if search.is_whole => Found::Nothing,
        None => Found::TooMuch,
    }
}

/// The steps out of each state, and those that start the chart.
fn outgoing(found: &Watched) -> (Vec<Vec<usize>>, Vec<usize>) {
    let mut from = vec![Vec::new(); found.states().len()];
    let mut begin = Vec::new();
    for (place, step) in found.steps().iter().enumerate() {
        match step.from {
            Some(state) => from[state].push(place),
            None => begin.push(place),
        }
    }
    (from, begin)
}

struct Place {
    state: usize,
    clause: Clause,
    /// The place before it and the step that led here first.
    came: (Option<usize>, usize),
}

struct Search<'a> {
    found: &'a Watched,
    contrary: &'a Plan,
    /// Whether parts of the chart are left to do nothing: then it is never at rest.
    has_idle: bool,
    from: Vec<Vec<usize>>,
    places: Vec<Place>,
    numbers: BTreeMap<(usize, Clause), usize>,
    /// Where each place leads, and by which step.
    next: Vec<Vec<(usize, usize)>>,
    limit: usize,
    is_whole: bool,
}

impl<'a> Search<'a> {
    fn step(&self, place: usize) -> &'a WatchedStep {
        &self.found.steps()[place]
    }

    /// The shortest run at whose end the property is violated.
    fn reached(&mut self, begin: Vec<usize>) -> Option<Violation> {
        let mut stack = Stack::new();
        let mut open = VecDeque::new();
        for step in begin {
            let at = Position { letter: self.step(step).letter, now: 0 };
            let result = stack.begin(self.contrary, at);
            self.is_whole &= result.is_ok();
            if let Some(way) = self.arrive(None, step, &stack, &mut open) {
                return Some(way);
            }
        }
        while let Some(place) = open.pop_front() {
            let Place { state, clause, .. } = self.places[place];
            if self.may_end(state) && !clause.awaits(self.contrary) {
                return Some(Violation { way: self.way_to(Some(place)), circle: Vec::new() });
            }
            for step in self.from[state].clone() {
                let at = Position { letter: self.step(step).letter, now: self.step(step).elapsed };
                let result = stack.step(self.contrary, &[clause], at);
                self.is_whole &= result.is_ok();
                if let Some(way) = self.arrive(Some(place), step, &stack, &mut open) {
                    return Some(way);
                }
            }
        }
        None
    }

    /// Whether nothing need happen any more.
    fn may_end(&self, state: usize) -> bool {
        let it = &self.found.states()[state];
        it.status != Status::Running || (it.pending.is_empty() && !self.has_idle)
    }

    fn arrive(
        &mut self,
        from: Option<usize>,
        step: usize,
        stack: &Stack,
        open: &mut VecDeque<usize>,
    ) -> Option<Violation> {
        let WatchedStep { to, elapsed, .. } = *self.step(step);
        for clause in stack.clauses() {
            if clause.is_true() {
                let mut way = self.way_to(from);
                way.push(step);
                return Some(Violation { way, circle: Vec::new() });
            }
            let clause = clause.aged(elapsed, self.contrary);
            let count = self.places.len();
            let place = match self.numbers.entry((to, clause)) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(_) if count == self.limit => {
                    self.is_whole = false;
                    continue;
                }
                Entry::Vacant(new) => {
                    new.insert(count);
                    self.places.push(Place { state: to, clause, came: (from, step) });
                    self.next.push(Vec::new());
                    open.push_back(count);
                    count
                }
            };
            if let Some(from) = from {
                self.next[from].push((place, step));
            }
        }
        None
    }

    fn way_to(&self, mut place: Option<usize>) -> Vec<usize> {
        let mut way = Vec::new();
        while let Some(at) = place {
            let (before, step) = self.places[at].came;
            way.push(step);
            place = before;
        }
        way.reverse();
        way
    }
}

/// The search for a circle, among places that are all known.
struct Circles<'a> {
    search: &'a Search<'a>,
    is_timed: bool,
}

impl Circles<'_> {
    fn find(&self) -> Option<Violation> {
        let components = components(&self.search.next);
        let mut members: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (place, &component) in components.iter().enumerate() {
            members.entry(component).or_default().push(place);
        }
        // the one that is reached first
        let mut candidates: Vec<(usize, Vec<usize>)> = members.into_values().map(|it| (it[0], it)).collect();
        candidates.sort_unstable();
        candidates.into_iter().find_map(|(first, members)| {
            let inside: BTreeSet<usize> = members.into_iter().collect();
            let stops = self.stops(&inside)?;
            let circle = self.round(first, &stops, &inside)?;
            Some(Violation { way: self.search.way_to(Some(first)), circle })
        })
    }

    /// What a circle has to go by to be a run that violates the property; none if it cannot.
    fn stops(&self, inside: &BTreeSet<usize>) -> Option<Vec<Stop>> {
        let search = self.search;
        let mut stops = Vec::new();
        for (obligation, &(term, _)) in search.contrary.obligations.iter().enumerate() {
            if matches!(search.contrary.terms[term], Term::Until { bound: None, .. }) {
                let met = |place: &&usize| !search.places[**place].clause.has(obligation);
                stops.push(Stop::Place(*inside.iter().find(met)?));
            }
        }
        let steps = || {
            inside.iter().flat_map(|&place| {
                let next = search.next[place].iter().filter(|(to, _)| inside.contains(to));
                next.map(move |&(to, step)| (place, to, step))
            })
        };
        steps().next()?;
        if self.is_timed {
            let (from, to, step) = steps().find(|&(.., step)| search.step(step).elapsed > 0)?;
            stops.push(Stop::Step(from, to, step));
            return Some(stops);
        }
        let pending = |place: usize| &search.found.states()[search.places[place].state].pending;
        let first = *inside.first()?;
        let always =
            pending(first).iter().filter(|it| inside.iter().all(|&place| pending(place).contains(it)));
        for &waiting in always {
            let ends =
                |&(.., step): &(usize, usize, usize)| search.step(step).ends == Some::<Pending>(waiting);
            let (from, to, step) = steps().find(ends)?;
            stops.push(Stop::Step(from, to, step));
        }
        for &waiting in pending(first) {
            if let Some(&place) = inside.iter().find(|&&place| !pending(place).contains(&waiting)) {
                stops.push(Stop::Place(place));
            }
        }
        Some(stops)
    }

    /// A circle from a place by all stops.
    fn round(&self, first: usize, stops: &[Stop], inside: &BTreeSet<usize>) -> Option<Vec<usize>> {
        let (mut at, mut circle) = (first, Vec::new());
        for stop in stops {
            match *stop {
                Stop::Place(place) => circle.extend(self.way_within(at, place, inside)?),
                Stop::Step(from, ..) => circle.extend(self.way_within(at, from, inside)?),
            }
            at = match *stop {
                Stop::Place(place) => place,
                Stop::Step(_, to, step) => {
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
        circle.extend(self.way_within(at, first, inside)?);
        Some(circle)
    }

    fn way_within(&self, from: usize, to: usize, inside: &BTreeSet<usize>) -> Option<Vec<usize>> {
        let mut came: BTreeMap<usize, Option<(usize, usize)>> = BTreeMap::from([(from, None)]);
        let mut open = VecDeque::from([from]);
        while let Some(at) = open.pop_front() {
            if at == to {
                let (mut way, mut at) = (Vec::new(), at);
                while let Some(Some((before, step))) = came.get(&at) {
                    way.push(*step);
                    at = *before;
                }
                way.reverse();
                return Some(way);
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

/// What a circle goes by.
enum Stop {
    Place(usize),
    Step(usize, usize, usize),
}
