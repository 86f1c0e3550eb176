//! Inclusion of infinite traces.
//!
//! An infinite trace satisfies formulas if each required `x~` is begun infinitely often: a
//! generalised Büchi condition with a set for each `x~`. A chart that waits for its environment has
//! traces that violate it in any case: a ball may never come. The check is therefore weaker: after
//! every finite trace it must still be possible to satisfy the condition. If it is not, the chart
//! itself has cut something short.
//!
//! The other direction follows from finite traces: an infinite trace is one of the chart if all its
//! prefixes are, since a chart has finitely many states.

use std::collections::{BTreeMap, BTreeSet};

use super::graph::{Graph, Observable};
use super::{MAX_PAIRS, ProductState};
use crate::conformance::derivatives::{Language, LoopId, Residual};
use crate::strongly_connected_components::strongly_connected_components;

/// A state of the chart with one residual of the formulas there.
type LoopProductState = (usize, Residual);

/// The target of a step, whether the step can be part of an endless repetition, and the `x~` of
/// which it starts an iteration.
type LoopProductStep = (usize, (bool, BTreeSet<LoopId>));

/// Whether the formulas can be satisfied from all product states.
pub(crate) enum InfiniteTraceResult {
    /// They can be satisfied from each of them.
    Met,
    /// They cannot be satisfied from this one. The texts are the `x~` that are not repeated; empty
    /// if the cause is something else.
    Missed(usize, Vec<String>),
    /// The product exceeded its limit.
    Unknown,
}

/// Checks product states in the order in which they were reached.
pub(crate) fn endlessly(
    graph: &Graph,
    language: &mut Language,
    all: Residual,
    reached: &[ProductState],
    may_end_early: bool,
) -> InfiniteTraceResult {
    let Some(product) = LoopProduct::new(graph, language, all) else { return InfiniteTraceResult::Unknown };
    let turns = product.turns(language);
    let met = product.satisfying_states(graph, language, &turns, may_end_early);
    let is_met = |at: &ProductState| {
        at.1.iter().any(|&rest| product.numbers.get(&(at.0, rest)).is_none_or(|&position| met[position]))
    };
    match reached.iter().position(|at| !is_met(at)) {
        None => InfiniteTraceResult::Met,
        Some(index) => {
            InfiniteTraceResult::Missed(index, product.starved_loop(language, &turns, &reached[index]))
        }
    }
}

/// The product of the chart and the residuals of its formulas.
struct LoopProduct {
    states: Vec<LoopProductState>,
    numbers: BTreeMap<LoopProductState, usize>,
    next: Vec<Vec<LoopProductStep>>,
}

/// The strongly connected components of repeatable steps: the component of each state, and the `x~`
/// that start in each.
struct LoopComponents {
    component_of: Vec<usize>,
    begun: Vec<BTreeSet<LoopId>>,
}

impl LoopProduct {
    /// `None` if it is too large.
    fn new(graph: &Graph, language: &mut Language, all: Residual) -> Option<LoopProduct> {
        let mut product = LoopProduct { states: Vec::new(), numbers: BTreeMap::new(), next: Vec::new() };
        for &state in &graph.initial {
            product.number((state, all));
        }
        while let Some(&(state, rest)) = product.states.get(product.next.len()) {
            if product.states.len() > MAX_PAIRS || language.is_too_large() {
                return None;
            }
            let mut steps = Vec::new();
            for edge in &graph.edges[state] {
                match edge.observable {
                    Observable::Nothing => {
                        steps.push((product.number((edge.to, rest)), (true, BTreeSet::new())));
                    }
                    Observable::Letter(letter) => {
                        for step in language.steps(rest, letter) {
                            steps.push((product.number((edge.to, step.rest)), (step.recurs, step.begun)));
                        }
                    }
                    Observable::Other => {}
                }
            }
            product.next.push(steps);
        }
        Some(product)
    }

    fn number(&mut self, index: LoopProductState) -> usize {
        let number = *self.numbers.entry(index).or_insert(self.states.len());
        if number == self.states.len() {
            self.states.push(index);
        }
        number
    }

    fn turns(&self, language: &Language) -> LoopComponents {
        let recurring = |steps: &Vec<LoopProductStep>| -> Vec<(usize, ())> {
            steps.iter().filter(|(_, (recurs, _))| *recurs).map(|(to, _)| (*to, ())).collect()
        };
        let next: Vec<Vec<(usize, ())>> = self.next.iter().map(recurring).collect();
        let component_of = strongly_connected_components(&next);
        let count = component_of.iter().max().map_or(0, |last| last + 1);
        let mut begun = vec![BTreeSet::new(); count];
        for (from, steps) in self.next.iter().enumerate() {
            for (to, (recurs, numbers)) in steps {
                let is_owed = language.owed_loops(self.states[from].1).is_some();
                if *recurs && is_owed && component_of[from] == component_of[*to] {
                    begun[component_of[from]].extend(numbers);
                }
            }
        }
        LoopComponents { component_of, begun }
    }

    /// The states from which the formulas can be satisfied: the accepting ones and their
    /// predecessors.
    fn satisfying_states(
        &self,
        graph: &Graph,
        language: &Language,
        turns: &LoopComponents,
        may_end_early: bool,
    ) -> Vec<bool> {
        let mut before: Vec<Vec<usize>> = vec![Vec::new(); self.states.len()];
        for (from, steps) in self.next.iter().enumerate() {
            steps.iter().for_each(|(to, _)| before[*to].push(from));
        }
        let is_met = |index: usize| {
            let (state, rest) = self.states[index];
            let has_ended = graph.ends[state] && (may_end_early || language.may_end(rest));
            // without required loops the chart may be silent forever; whether it could end is
            // checked elsewhere
            let is_satisfied =
                |owed: BTreeSet<LoopId>| owed.is_subset(&turns.begun[turns.component_of[index]]);
            has_ended || language.owed_loops(rest).is_some_and(is_satisfied)
        };
        let mut met: Vec<bool> = (0..self.states.len()).map(is_met).collect();
        let mut open: Vec<usize> = (0..met.len()).filter(|&position| met[position]).collect();
        while let Some(state) = open.pop() {
            for &earlier in &before[state] {
                if !std::mem::replace(&mut met[earlier], true) {
                    open.push(earlier);
                }
            }
        }
        met
    }

    /// The `x~` that are required in a product state and never start again, as text.
    fn starved_loop(&self, language: &Language, turns: &LoopComponents, at: &ProductState) -> Vec<String> {
        let first: Vec<usize> =
            at.1.iter().filter_map(|&rest| self.numbers.get(&(at.0, rest)).copied()).collect();
        let (mut seen, mut open): (BTreeSet<usize>, Vec<usize>) = (first.iter().copied().collect(), first);
        let (mut owed, mut begun) = (BTreeSet::new(), BTreeSet::new());
        while let Some(index) = open.pop() {
            owed.extend(language.owed_loops(self.states[index].1).unwrap_or_default());
            begun.extend(&turns.begun[turns.component_of[index]]);
            open.extend(self.next[index].iter().map(|(to, _)| *to).filter(|to| seen.insert(*to)));
        }
        owed.difference(&begun).map(|&number| language.endless(number).to_owned()).collect()
    }
}
