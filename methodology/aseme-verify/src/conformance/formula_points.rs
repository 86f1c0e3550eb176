//! What a chart does at each point of its formulas.

use std::collections::{BTreeMap, BTreeSet};

use crate::conformance::derivatives::{Residual, Symbol};

/// The points of formulas: what is left of them, and what the chart does there of what they allow.
#[derive(Default)]
pub(crate) struct FormulaPoints {
    numbers: BTreeMap<BTreeSet<Residual>, usize>,
    points: Vec<FormulaPoint>,
}

pub(crate) struct FormulaPoint {
    /// The first trace that leads there.
    before: Vec<Symbol>,
    /// What may follow, `None` being the end, and whether it does after some trace.
    follows: BTreeMap<Option<Symbol>, bool>,
}

impl FormulaPoint {
    pub(crate) fn follow(&mut self, letter: Option<Symbol>, is_done: bool) {
        *self.follows.entry(letter).or_default() |= is_done;
    }
}

impl FormulaPoints {
    pub(crate) fn visit(&mut self, rests: &BTreeSet<Residual>, before: &[Symbol]) -> &mut FormulaPoint {
        let next = self.points.len();
        let number = match self.numbers.get(rests) {
            Some(&number) => number,
            None => {
                self.numbers.insert(rests.clone(), next);
                self.points.push(FormulaPoint { before: before.to_vec(), follows: BTreeMap::new() });
                next
            }
        };
        &mut self.points[number]
    }

    /// The first that never follows, and the trace before it.
    pub(crate) fn never_followed(&self) -> Option<(Option<Symbol>, &[Symbol])> {
        self.points.iter().find_map(|point| {
            let (letter, _) = point.follows.iter().find(|(_, is_done)| !**is_done)?;
            Some((*letter, point.before.as_slice()))
        })
    }
}
