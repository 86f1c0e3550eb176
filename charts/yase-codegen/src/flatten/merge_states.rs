//! Minimisation of states.

use super::search::without_idle_questions;
use super::{FlatMachine, FlatOp, FlatPath};

impl FlatMachine {
    /// Merges states with equal active nodes and equal behaviour, for example those that differ in
    /// a history that is overwritten before it is used. The minimisation of Moore (1956), with
    /// conditions and actions as outputs.
    pub(crate) fn merged(mut self) -> FlatMachine {
        let alike = |state: usize| {
            let same = |other: &super::FlatState| *other == self.states[state];
            self.states.iter().position(same).unwrap_or(state)
        };
        let mut first: Vec<usize> = (0..self.states.len()).map(alike).collect();
        loop {
            let done: Vec<(usize, Vec<FlatPath>)> = first
                .iter()
                .zip(&self.paths)
                .map(|(&first_alike, paths)| {
                    (first_alike, paths.iter().map(|path| with_targets(path, &first)).collect())
                })
                .collect();
            let next = done.iter().map(|one| done.iter().position(|other| other == one).unwrap_or_default());
            let next: Vec<usize> = next.collect();
            if next == first {
                break;
            }
            first = next;
        }
        let mut numbers = vec![0; first.len()];
        let kept: Vec<usize> = (0..first.len()).filter(|&state| first[state] == state).collect();
        kept.iter().enumerate().for_each(|(number, &state)| numbers[state] = number);
        let number: Vec<usize> = first.iter().map(|&state| numbers[state]).collect();
        self.start = with_targets(&self.start, &number);
        self.paths = kept
            .iter()
            .map(|&state| self.paths[state].iter().map(|path| with_targets(path, &number)).collect())
            .collect();
        self.states = kept.iter().map(|&state| self.states[state].clone()).collect();
        self
    }
}

/// The same path with renumbered target states.
fn with_targets(path: &FlatPath, numbers: &[usize]) -> FlatPath {
    let piece = |piece: &FlatOp| match piece {
        FlatOp::Do(action) => FlatOp::Do(*action),
        FlatOp::If(condition, other) => FlatOp::If(*condition, with_targets(other, numbers)),
    };
    without_idle_questions(FlatPath { pieces: path.pieces.iter().map(piece).collect(), to: numbers[path.to] })
}
