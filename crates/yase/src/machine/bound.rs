//! Notices charts that never rest.

use std::num::NonZeroU32;

use crate::chart::CompoundId;
use crate::moment::Moment;

/// So many of the last transitions are remembered, to name a cycle.
pub(super) const MEMORY: usize = 64;

/// Counts the micro-steps of a step, and the steps at one moment.
#[derive(Clone, Debug)]
pub(super) struct Bound {
    pub(super) micro_steps: u32,
    pub(super) instant: Moment,
    pub(super) steps: u32,
    recent: [CompoundId; MEMORY],
    taken: usize,
}

impl Bound {
    pub(super) fn new() -> Bound {
        let recent = [CompoundId(0); MEMORY];
        Bound { micro_steps: 0, instant: Moment::ZERO, steps: 0, recent, taken: 0 }
    }

    pub(super) fn reset(&mut self, now: Moment) {
        (self.micro_steps, self.instant, self.steps, self.taken) = (0, now, 0, 0);
    }

    /// Begins a step and counts its first micro-step, if there may be one more step at this moment.
    #[inline(always)]
    pub(super) fn begin_with_one(&mut self, now: Moment, limit: NonZeroU32) -> bool {
        if self.instant != now {
            (self.instant, self.steps, self.taken) = (now, 0, 0);
        }
        let may = self.steps < limit.get();
        self.steps += u32::from(may);
        self.micro_steps = u32::from(may);
        may
    }

    /// A step begins.
    pub(super) fn begin(&mut self, now: Moment) {
        self.micro_steps = 0;
        if self.instant != now {
            (self.instant, self.steps, self.taken) = (now, 0, 0);
        }
    }

    pub(super) fn count_micro_step(&mut self) {
        self.micro_steps += 1; // allowed, so below the limit
    }

    pub(super) fn allows_micro_step(&self, limit: NonZeroU32) -> bool {
        self.micro_steps < limit.get()
    }

    /// A step that does something: counts it, if there may be one more at this moment.
    pub(super) fn admits_step(&mut self, limit: NonZeroU32) -> bool {
        let may = self.steps < limit.get();
        self.steps += u32::from(may);
        may
    }

    pub(super) fn remember(&mut self, compound: CompoundId) {
        self.recent[self.taken % MEMORY] = compound;
        self.taken += 1;
    }

    /// What is remembered, oldest first.
    pub(super) fn last(&self) -> Vec<CompoundId> {
        let known = self.taken.min(MEMORY);
        (self.taken - known..self.taken).map(|index| self.recent[index % MEMORY]).collect()
    }

    /// The transitions that were taken again and again: the shortest row whose repetition makes up the last half of what is remembered,
    /// or all of it.
    pub(super) fn cycle(&self) -> Vec<CompoundId> {
        let last = self.last();
        let known = last.len();
        let repeats = |&period: &usize| {
            let recent = &last[known - (2 * period).max(known / 2)..];
            recent.iter().zip(&recent[period..]).all(|(a, b)| a == b)
        };
        let period = (1..=known / 2).find(repeats).unwrap_or(known);
        last[known - period..].to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cycle_of(numbers: &[u32]) -> Vec<u32> {
        let mut bound = Bound::new();
        for &number in numbers {
            bound.remember(CompoundId(number));
        }
        bound.cycle().into_iter().map(|compound| compound.0).collect()
    }

    #[test]
    fn a_cycle_is_the_shortest_row_that_repeats_to_the_end() {
        assert_eq!(cycle_of(&[]), []);
        assert_eq!(cycle_of(&[7]), [7]);
        assert_eq!(cycle_of(&[9, 1, 1, 1, 1]), [1]);
        assert_eq!(cycle_of(&[9, 8, 1, 2, 2, 1, 2, 2]), [1, 2, 2]);
        assert_eq!(cycle_of(&[1, 2, 3, 4]), [1, 2, 3, 4]);
        assert_eq!(cycle_of(&[9, 1, 2, 3, 1, 2]), [9, 1, 2, 3, 1, 2]);
        let long: Vec<u32> = (0..1000).map(|number| number % 5).collect();
        assert_eq!(cycle_of(&long), [0, 1, 2, 3, 4]);
    }
}
