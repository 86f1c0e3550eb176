//! What goes on forever: whether a chart can always go on so that the formulas hold of all of its trace.
//!
//! An infinite trace is one of formulas if each `x~` that is to be done is begun again and again, and what comes once has come: a generalised Büchi
//! condition with a set for each `x~`. A chart that waits for its surroundings has traces that do not meet it, whatever it is like: a ball may never come. So it is asked
//! for less, that after whatever has happened it is still possible to meet it. Where it is not, the chart itself has cut something short.
//!
//! The other direction needs nothing of its own: an infinite trace is one of the chart if all its beginnings are, since a chart has finitely many states.

use std::collections::{BTreeMap, BTreeSet};

use super::graph::{Graph, Shows};
use super::{At, MOST};
use crate::check::language::{Endless, Language, Rest};
use crate::components::components;

/// A state of the chart with one of the rests of the formulas there.
type Place = (usize, Rest);

/// Where a step leads, whether it can be part of what goes on forever, and what it begins a turn of.
type Step = (usize, (bool, BTreeSet<Endless>));

/// The first of some states of affairs from which the formulas cannot be met any more, and which of their `x~` are not begun again; none of those if it is
/// something else.
pub(super) enum Endlessly {
    /// They can be met from all of them.
    Met,
    /// From this one they cannot.
    Missed(usize, Vec<String>),
    /// There is too much to look at.
    Unknown,
}

/// Looks at states of affairs in the order in which they are reached.
pub(super) fn endlessly(
    graph: &Graph,
    language: &mut Language,
    all: Rest,
    reached: &[At],
    may_end_early: bool,
) -> Endlessly {
    let Some(product) = Product::new(graph, language, all) else { return Endlessly::Unknown };
    let turns = product.turns(language);
    let met = product.met(graph, language, &turns, may_end_early);
    let is_met =
        |at: &At| at.1.iter().any(|&rest| product.numbers.get(&(at.0, rest)).is_none_or(|&place| met[place]));
    match reached.iter().position(|at| !is_met(at)) {
        None => Endlessly::Met,
        Some(index) => Endlessly::Missed(index, product.starved(language, &turns, &reached[index])),
    }
}

/// All that chart and formulas can come to together.
struct Product {
    places: Vec<Place>,
    numbers: BTreeMap<Place, usize>,
    next: Vec<Vec<Step>>,
}

/// The circles of what goes on forever: the component of each place, and what is begun in each.
struct Turns {
    of_place: Vec<usize>,
    begun: Vec<BTreeSet<Endless>>,
}

impl Product {
    /// None if it is too large.
    fn new(graph: &Graph, language: &mut Language, all: Rest) -> Option<Product> {
        let mut product = Product { places: Vec::new(), numbers: BTreeMap::new(), next: Vec::new() };
        for &state in &graph.initial {
            product.number((state, all));
        }
        while let Some(&(state, rest)) = product.places.get(product.next.len()) {
            if product.places.len() > MOST || language.is_too_large() {
                return None;
            }
            let mut steps = Vec::new();
            for way in &graph.ways[state] {
                match way.shows {
                    Shows::Nothing => {
                        steps.push((product.number((way.to, rest)), (true, BTreeSet::new())));
                    }
                    Shows::Letter(letter) => {
                        for step in language.steps(rest, letter) {
                            steps.push((product.number((way.to, step.rest)), (step.recurs, step.begun)));
                        }
                    }
                    Shows::Other => {}
                }
            }
            product.next.push(steps);
        }
        Some(product)
    }

    fn number(&mut self, place: Place) -> usize {
        let number = *self.numbers.entry(place).or_insert(self.places.len());
        if number == self.places.len() {
            self.places.push(place);
        }
        number
    }

    fn turns(&self, language: &Language) -> Turns {
        let recurring = |steps: &Vec<Step>| -> Vec<(usize, ())> {
            steps.iter().filter(|(_, (recurs, _))| *recurs).map(|(to, _)| (*to, ())).collect()
        };
        let next: Vec<Vec<(usize, ())>> = self.next.iter().map(recurring).collect();
        let of_place = components(&next);
        let count = of_place.iter().max().map_or(0, |last| last + 1);
        let mut begun = vec![BTreeSet::new(); count];
        for (from, steps) in self.next.iter().enumerate() {
            for (to, (recurs, numbers)) in steps {
                let is_owed = language.owed(self.places[from].1).is_some();
                if *recurs && is_owed && of_place[from] == of_place[*to] {
                    begun[of_place[from]].extend(numbers);
                }
            }
        }
        Turns { of_place, begun }
    }

    /// From which places the formulas can be met: from those where they are, and from those that lead there.
    fn met(&self, graph: &Graph, language: &Language, turns: &Turns, may_end_early: bool) -> Vec<bool> {
        let mut before: Vec<Vec<usize>> = vec![Vec::new(); self.places.len()];
        for (from, steps) in self.next.iter().enumerate() {
            steps.iter().for_each(|(to, _)| before[*to].push(from));
        }
        let is_met = |place: usize| {
            let (state, rest) = self.places[place];
            let has_ended = graph.ends[state] && (may_end_early || language.may_end(rest));
            // with nothing owed it may be silent for ever; whether it could end is another question
            let is_satisfied = |owed: BTreeSet<Endless>| owed.is_subset(&turns.begun[turns.of_place[place]]);
            has_ended || language.owed(rest).is_some_and(is_satisfied)
        };
        let mut met: Vec<bool> = (0..self.places.len()).map(is_met).collect();
        let mut open: Vec<usize> = (0..met.len()).filter(|&place| met[place]).collect();
        while let Some(place) = open.pop() {
            for &earlier in &before[place] {
                if !std::mem::replace(&mut met[earlier], true) {
                    open.push(earlier);
                }
            }
        }
        met
    }

    /// What is owed in a state of affairs and never begun again from there on, as it is written.
    fn starved(&self, language: &Language, turns: &Turns, at: &At) -> Vec<String> {
        let first: Vec<usize> =
            at.1.iter().filter_map(|&rest| self.numbers.get(&(at.0, rest)).copied()).collect();
        let (mut seen, mut open): (BTreeSet<usize>, Vec<usize>) = (first.iter().copied().collect(), first);
        let (mut owed, mut begun) = (BTreeSet::new(), BTreeSet::new());
        while let Some(place) = open.pop() {
            owed.extend(language.owed(self.places[place].1).unwrap_or_default());
            begun.extend(&turns.begun[turns.of_place[place]]);
            open.extend(self.next[place].iter().map(|(to, _)| *to).filter(|to| seen.insert(*to)));
        }
        owed.difference(&begun).map(|&number| language.endless(number).to_owned()).collect()
    }
}
