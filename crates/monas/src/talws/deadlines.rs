//! When the cycles of a list are due in real time.

use std::time::Duration;

use narukom::Moment;

use crate::frequency::Frequency;

/// Deadlines on the grid of a frequency. They are absolute, so nothing drifts, however long cycles take.
pub(super) struct Deadlines {
    frequency: Frequency,
    /// The next cycle, by its number on the grid.
    next: u64,
    overruns: u64,
    missed: u64,
}

impl Deadlines {
    pub(super) fn new(frequency: Frequency, begin: Moment) -> Deadlines {
        Deadlines { frequency, next: frequency.first_due(begin), overruns: 0, missed: 0 }
    }

    /// When the next cycle begins.
    pub(super) fn next(&self) -> Moment {
        if self.frequency.is_free() {
            return Moment::ZERO;
        }
        self.frequency.due(self.next)
    }

    /// Another grid from a moment on.
    pub(super) fn set_frequency(&mut self, frequency: Frequency, now: Moment) {
        self.frequency = frequency;
        self.skip_to(now);
    }

    /// Nothing is due before a moment.
    pub(super) fn skip_to(&mut self, now: Moment) {
        self.next = self.frequency.first_due(now);
    }

    /// How many cycles ended after the next was due.
    pub(super) fn overruns(&self) -> u64 {
        self.overruns
    }

    /// How many cycles were left out because of that.
    pub(super) fn missed(&self) -> u64 {
        self.missed
    }

    /// A cycle has ended. If the next was due before, tells since when; it then begins at once, and those that were missed besides are
    /// left out.
    pub(super) fn ended(&mut self, moment: Moment) -> Option<Duration> {
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

    /// The last number on the grid that is due by a moment.
    fn last_due(&self, moment: Moment) -> u64 {
        let near = (moment.as_secs_f64() * self.frequency.hertz()) as u64;
        // The estimate may be off by one to either side.
        let candidates = [near + 1, near, near.saturating_sub(1)];
        candidates.into_iter().find(|number| self.frequency.due(*number) <= moment).unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frequency::Hz;

    fn at(millis: u64) -> Moment {
        Moment::from_nanos(millis * 1_000_000)
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
    fn what_runs_freely_is_always_due_and_never_late() {
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
