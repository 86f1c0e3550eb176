//! States that look alike and do alike are one.

use super::search::without_idle_questions;
use super::{Flat, Piece, Way};

impl Flat {
    /// Takes states for one that have the same active nodes and from which nobody can tell which of them it was: a history that is forgotten before anybody asks for it makes
    /// no difference, for example. It is the minimisation of Moore (1956), with what is asked and done in place of outputs.
    pub(super) fn merged(mut self) -> Flat {
        let alike = |state: usize| {
            let same = |other: &super::FlatState| *other == self.states[state];
            self.states.iter().position(same).unwrap_or(state)
        };
        let mut first: Vec<usize> = (0..self.states.len()).map(alike).collect();
        loop {
            let done: Vec<(usize, Vec<Way>)> = first
                .iter()
                .zip(&self.ways)
                .map(|(&first_alike, ways)| (first_alike, ways.iter().map(|way| led(way, &first)).collect()))
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
        self.start = led(&self.start, &number);
        self.ways = kept
            .iter()
            .map(|&state| self.ways[state].iter().map(|way| led(way, &number)).collect())
            .collect();
        self.states = kept.iter().map(|&state| self.states[state].clone()).collect();
        self
    }
}

/// The same way with other numbers for the states at its ends.
fn led(way: &Way, numbers: &[usize]) -> Way {
    let piece = |piece: &Piece| match piece {
        Piece::Do(action) => Piece::Do(*action),
        Piece::If(condition, other) => Piece::If(*condition, led(other, numbers)),
    };
    without_idle_questions(Way { pieces: way.pieces.iter().map(piece).collect(), to: numbers[way.to] })
}
