//! The behaviour of a chart at each point of its formulas.

use std::collections::{BTreeMap, BTreeSet};

use crate::conformance::derivatives::{Residual, Symbol};

/// The points of formulas: the residual, and the behaviour of the chart there.
#[derive(Default)]
pub(crate) struct FormulaPoints {
    numbers: BTreeMap<BTreeSet<Residual>, usize>,
    points: Vec<FormulaPoint>,
    /// Traces, each as a shorter one and its last activity.
    traces: Vec<(Option<TraceId>, Symbol)>,
}

/// A trace, by its index; none is the empty one.
pub(crate) type TraceId = usize;

pub(crate) struct FormulaPoint {
    /// The first trace that leads there.
    before: Option<TraceId>,
    /// The symbols that may follow, `None` being the end, and whether each does after some trace.
    follows: BTreeMap<Option<Symbol>, bool>,
}

impl FormulaPoint {
    pub(crate) fn follow(&mut self, letter: Option<Symbol>, is_done: bool) {
        *self.follows.entry(letter).or_default() |= is_done;
    }
}

impl FormulaPoints {
    pub(crate) fn visit(&mut self, rests: &BTreeSet<Residual>, before: Option<TraceId>) -> &mut FormulaPoint {
        let next = self.points.len();
        let number = match self.numbers.get(rests) {
            Some(&number) => number,
            None => {
                self.numbers.insert(rests.clone(), next);
                self.points.push(FormulaPoint { before, follows: BTreeMap::new() });
                next
            }
        };
        &mut self.points[number]
    }

    /// A trace with one more activity.
    pub(crate) fn extend(&mut self, trace: Option<TraceId>, letter: Symbol) -> TraceId {
        self.traces.push((trace, letter));
        self.traces.len() - 1
    }

    fn letters_of(&self, mut trace: Option<TraceId>) -> Vec<Symbol> {
        let mut letters = Vec::new();
        while let Some((before, letter)) = trace.and_then(|trace| self.traces.get(trace)) {
            letters.push(*letter);
            trace = *before;
        }
        letters.reverse();
        letters
    }

    /// The first that never follows, and the trace before it.
    pub(crate) fn never_followed(&self) -> Option<(Option<Symbol>, Vec<Symbol>)> {
        self.points.iter().find_map(|point| {
            let (letter, _) = point.follows.iter().find(|(_, is_done)| !**is_done)?;
            Some((*letter, self.letters_of(point.before)))
        })
    }
}
