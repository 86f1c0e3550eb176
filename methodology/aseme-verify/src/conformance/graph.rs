//! The observable behaviour of a chart: states, and the activities that return between them.

use std::collections::BTreeMap;

use yase::Status;
use yase_explore::Exploration;

use crate::conformance::derivatives::Symbol;

/// An edge of the graph.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct LabelledEdge {
    /// The observation of the step.
    pub(crate) observable: Observable,
    /// The target state.
    pub(crate) to: usize,
    /// An edge of the exploration with this observation.
    pub(crate) edge: usize,
}

/// The observable effect of a step in a trace.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Observable {
    /// No activity returned.
    Nothing,
    /// An activity returned that formulas name.
    Letter(Symbol),
    /// An activity returned that no formula names.
    Other,
}

/// States and labelled edges.
#[derive(Debug)]
pub(crate) struct Graph {
    pub(crate) initial: Vec<usize>,
    /// Whether the chart has ended in each state.
    pub(crate) ends: Vec<bool>,
    /// The edges out of each state.
    pub(crate) edges: Vec<Vec<LabelledEdge>>,
}

/// The signature of a state: a bit for each pair of observation and target class.
type Signature = Vec<u64>;

/// Limit of equivalence classes; minimising a chart with more gains little.
const MOST_CLASSES: usize = 2_000;

/// Limit of the rounds in which classes are split: each takes as long as there are states, and a
/// chart that needs more of them is mostly one long sequence, which does not become smaller.
const MOST_ROUNDS: usize = 200;

impl Graph {
    /// The graph of an exploration.
    pub(crate) fn of(found: &Exploration, shows: impl Fn(usize) -> Observable) -> Graph {
        let mut edges = vec![Vec::new(); found.states().len()];
        for (index, edge) in found.edges().iter().enumerate() {
            let shows = shows(index);
            if shows != Observable::Nothing || edge.from != edge.to {
                edges[edge.from].push(LabelledEdge { observable: shows, to: edge.to, edge: index });
            }
        }
        let ends = found.states().iter().map(|state| state.status == Status::Finished).collect();
        Graph { initial: found.initial().collect(), ends, edges }
    }

    /// An equivalent graph with fewer states: the quotient by branching bisimilarity. `None` if too
    /// many classes remain.
    ///
    /// Classes are split as long as some states of a class have a signature that others lack: an
    /// observable edge, or an edge to another class, possibly after unobservable steps within the
    /// class. This reduces loops that run at their own rate, which dominate the state space of a
    /// player's chart, to one state each.
    pub(crate) fn collapsed(&self) -> Option<Graph> {
        let (classes, count) = self.classes(self.ends.iter().map(|&ends| usize::from(ends)).collect())?;
        Some(self.of_classes(&classes, count))
    }

    /// Refines an initial partition into bisimulation classes: the class of each state and the
    /// number of classes. None if there are too many, or too many rounds.
    pub(crate) fn classes(&self, mut classes: Vec<usize>) -> Option<(Vec<usize>, usize)> {
        let mut count = 0;
        for _ in 0..MOST_ROUNDS {
            let mut numbers = BTreeMap::new();
            let mut next = Vec::with_capacity(classes.len());
            for state in classes.iter().copied().zip(self.signatures(&classes)) {
                let number = numbers.len();
                next.push(*numbers.entry(state).or_insert(number));
            }
            match numbers.len() {
                same if same == count => return Some((next, count)),
                more if more > MOST_CLASSES => return None,
                more => (classes, count) = (next, more),
            }
        }
        None
    }

    fn signatures(&self, classes: &[usize]) -> Vec<Signature> {
        let mut numbers = BTreeMap::new();
        let mut before: Vec<Vec<usize>> = vec![Vec::new(); self.edges.len()];
        let mut own = vec![Vec::new(); self.edges.len()];
        for (from, edges) in self.edges.iter().enumerate() {
            for edge in edges {
                let class = classes[edge.to];
                if edge.observable == Observable::Nothing && class == classes[from] {
                    before[edge.to].push(from);
                } else {
                    let number = numbers.len();
                    own[from].push(*numbers.entry((edge.observable, class)).or_insert(number));
                }
            }
        }
        let mut signatures = vec![vec![0; numbers.len().div_ceil(64)]; self.edges.len()];
        for (signature, own) in signatures.iter_mut().zip(own) {
            own.into_iter().for_each(|number: usize| signature[number / 64] |= 1 << (number % 64));
        }
        propagate_back(&mut signatures, &before);
        signatures
    }

    /// The quotient graph.
    pub(crate) fn of_classes(&self, classes: &[usize], count: usize) -> Graph {
        let mut quotient: Vec<BTreeMap<(Observable, usize), usize>> = vec![BTreeMap::new(); count];
        let mut ends = vec![false; count];
        for (from, out) in self.edges.iter().enumerate() {
            let class = classes[from];
            ends[class] = self.ends[from];
            for edge in
                out.iter().filter(|edge| edge.observable != Observable::Nothing || classes[edge.to] != class)
            {
                quotient[class].entry((edge.observable, classes[edge.to])).or_insert(edge.edge);
            }
        }
        let edge = |((shows, to), edge)| LabelledEdge { observable: shows, to, edge };
        let mut initial: Vec<usize> = self.initial.iter().map(|&state| classes[state]).collect();
        initial.sort_unstable();
        initial.dedup();
        Graph {
            initial,
            ends,
            edges: quotient.into_iter().map(|quotient| quotient.into_iter().map(edge).collect()).collect(),
        }
    }
}

/// Propagates signatures backwards along unobservable steps within a class.
fn propagate_back(signatures: &mut [Signature], before: &[Vec<usize>]) {
    let mut open: Vec<usize> = (0..signatures.len()).collect();
    let mut is_open = vec![true; signatures.len()];
    while let Some(to) = open.pop() {
        is_open[to] = false;
        let behind = std::mem::take(&mut signatures[to]);
        for &from in before[to].iter().filter(|&&from| from != to) {
            let had = &mut signatures[from];
            let has_more = had.iter().zip(&behind).any(|(had, behind)| behind & !had != 0);
            had.iter_mut().zip(&behind).for_each(|(had, behind)| *had |= behind);
            if has_more && !std::mem::replace(&mut is_open[from], true) {
                open.push(from);
            }
        }
        signatures[to] = behind;
    }
}
