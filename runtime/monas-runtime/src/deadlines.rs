//! Deadlines of the cycles of a list in real time.

use std::time::Duration;

use narukom::Timestamp;

use monas_core::frequency::Frequency;

/// Deadlines on the grid of a frequency. They are absolute, so they do not drift, however long
/// cycles take.
pub(crate) struct Deadlines {
    frequency: Frequency,
    /// The number of the next cycle on the grid.
    next: u64,
    overruns: u64,
    missed: u64,
}

impl Deadlines {
    pub(crate) fn new(frequency: Frequency, begin: Timestamp) -> Deadlines {
        Deadlines { frequency, next: frequency.first_due(begin), overruns: 0, missed: 0 }
    }

    /// The time of the next cycle.
    pub(crate) fn next(&self) -> Timestamp {
        if self.frequency.is_free() {
            return Timestamp::ZERO;
        }
        self.frequency.due(self.next)
    }

    /// Changes the grid from `now` on.
    pub(crate) fn set_frequency(&mut self, frequency: Frequency, now: Timestamp) {
        self.frequency = frequency;
        self.skip_to(now);
    }

    /// Skips all cycles before `now`.
    pub(crate) fn skip_to(&mut self, now: Timestamp) {
        self.next = self.frequency.first_due(now);
    }

    /// Number of cycles that ended after the next was due.
    pub(crate) fn overruns(&self) -> u64 {
        self.overruns
    }

    /// Number of cycles that were skipped as a result.
    pub(crate) fn missed(&self) -> u64 {
        self.missed
    }

    /// Ends a cycle. After an overrun, returns how late the next cycle is; it begins immediately,
    /// and the other missed cycles are skipped.
    pub(crate) fn ended(&mut self, moment: Timestamp) -> Option<Duration> {
        self.next += 1;
        let due = self.next();
        if due >= moment || self.frequency.is_free() {
            return None;
        }
        self.overruns += 1;
        let last = self.last_due(moment).max(self.next);
        self.missed += last - self.next;
        self.next = last;
        Some(moment.since(due))
    }

    /// The last number on the grid that is due at `moment`.
    fn last_due(&self, moment: Timestamp) -> u64 {
        let near = (moment.as_secs_f64() * self.frequency.hertz()) as u64;
        // The estimate may be off by one in either direction.
        let candidates = [near + 1, near, near.saturating_sub(1)];
        candidates.into_iter().find(|number| self.frequency.due(*number) <= moment).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use monas_core::frequency::Hz;

    fn at(millis: u64) -> Timestamp {
        Timestamp::from_nanos(millis * 1_000_000)
    }

    #[test]
    fn a_cycle_in_time_leaves_the_grid_alone() {
        let mut deadlines = Deadlines::new(Hz(100), at(0));
        assert_eq!(deadlines.next(), at(0));
        assert_eq!(deadlines.ended(at(7)), None);
        assert_eq!(deadlines.next(), at(10));
        assert_eq!(deadlines.ended(at(20)), None, "just in time");
        assert_eq!((deadlines.next(), deadlines.overruns()), (at(20), 0));
    }

    #[test]
    fn after_an_overrun_the_next_cycle_begins_at_once_and_the_grid_stays() {
        let mut deadlines = Deadlines::new(Hz(100), at(0));
        assert_eq!(deadlines.ended(at(13)), Some(Duration::from_millis(3)));
        assert_eq!(deadlines.next(), at(10), "which has come already");
        assert_eq!(deadlines.ended(at(15)), None);
        assert_eq!((deadlines.next(), deadlines.overruns()), (at(20), 1));
    }

    #[test]
    fn free_running_agents_are_always_due_and_never_late() {
        let mut deadlines = Deadlines::new(Hz(0), at(0));
        assert_eq!((deadlines.next(), deadlines.ended(at(500)), deadlines.next()), (at(0), None, at(0)));
        assert_eq!((deadlines.overruns(), deadlines.missed()), (0, 0));
    }

    #[test]
    fn a_run_that_begins_late_has_missed_nothing() {
        let mut deadlines = Deadlines::new(Hz(100), at(5005));
        assert_eq!(deadlines.next(), at(5010));
        assert_eq!(deadlines.ended(at(5012)), None);
    }

    #[test]
    fn cycles_that_were_missed_are_not_made_up_for() {
        let mut deadlines = Deadlines::new(Hz(100), at(0));
        assert_eq!(deadlines.ended(at(57)), Some(Duration::from_millis(47)));
        assert_eq!((deadlines.overruns(), deadlines.missed()), (1, 4));
        assert_eq!(deadlines.next(), at(50));
        assert_eq!(deadlines.ended(at(58)), None);
        assert_eq!(deadlines.next(), at(60));
    }

    #[test]
    fn an_hour_of_overrun_is_left_behind_in_one_step() {
        let mut deadlines = Deadlines::new(Hz(1_000_000), at(0));
        assert!(deadlines.ended(at(3_600_000)).is_some());
        assert_eq!(deadlines.next(), at(3_600_000));
    }
}
