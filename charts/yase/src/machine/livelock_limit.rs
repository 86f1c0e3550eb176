//! Detects livelocks.

use std::num::NonZeroU32;

use crate::ids::CompoundTransitionId;
use crate::timestamp::Timestamp;

/// The number of recent transitions kept, to identify a cycle.
pub(crate) const KEPT_TRANSITIONS: usize = 64;

/// Counts the micro-steps of a step, and the steps at one time.
#[derive(Clone, Debug)]
pub(crate) struct LivelockLimit {
    pub(crate) micro_steps: u32,
    pub(crate) instant: Timestamp,
    pub(crate) steps: u32,
    recent: [CompoundTransitionId; KEPT_TRANSITIONS],
    taken: usize,
}

impl LivelockLimit {
    pub(crate) fn new() -> LivelockLimit {
        let recent = [CompoundTransitionId(0); KEPT_TRANSITIONS];
        LivelockLimit { micro_steps: 0, instant: Timestamp::ZERO, steps: 0, recent, taken: 0 }
    }

    pub(crate) fn reset(&mut self, now: Timestamp) {
        (self.micro_steps, self.instant, self.steps, self.taken) = (0, now, 0, 0);
    }

    /// Begins a step.
    #[inline]
    pub(crate) fn begin(&mut self, now: Timestamp) {
        self.micro_steps = 0;
        if self.instant != now {
            (self.instant, self.steps, self.taken) = (now, 0, 0);
        }
    }

    #[inline]
    pub(crate) fn count_micro_step(&mut self) {
        self.micro_steps += 1; // allowed, so below the limit
    }

    #[inline]
    pub(crate) fn allows_micro_step(&self, limit: NonZeroU32) -> bool {
        self.micro_steps < limit.get()
    }

    /// Counts a step with an effect, if the limit at this time allows one more.
    #[inline]
    pub(crate) fn admits_step(&mut self, limit: NonZeroU32) -> bool {
        let may = self.steps < limit.get();
        self.steps += u32::from(may);
        may
    }

    #[inline]
    pub(crate) fn record_transition(&mut self, compound: CompoundTransitionId) {
        self.recent[self.taken % KEPT_TRANSITIONS] = compound;
        self.taken += 1;
    }

    /// The recorded transitions, oldest first.
    pub(crate) fn last(&self) -> Vec<CompoundTransitionId> {
        let known = self.taken.min(KEPT_TRANSITIONS);
        (self.taken - known..self.taken).map(|index| self.recent[index % KEPT_TRANSITIONS]).collect()
    }

    /// The transitions that were taken repeatedly: the shortest sequence whose repetition makes up
    /// the last half of the record, or the whole record.
    pub(crate) fn cycle(&self) -> Vec<CompoundTransitionId> {
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
        let mut bound = LivelockLimit::new();
        for &number in numbers {
            bound.record_transition(CompoundTransitionId(number));
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
