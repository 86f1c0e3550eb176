//! How often an agent's cycle begins.

use std::fmt;
use std::time::Duration;

use narukom::Moment;

/// An agent that runs freely has so many cycles a second where cycles take no time.
const FREE: f64 = 1000.0;

/// A number of cycles a second.
#[derive(Clone, Copy, PartialEq, PartialOrd, Debug)]
pub struct Frequency {
    hertz: f64,
}

/// So many cycles a second: `Hz(10)`, `Hz(83.3)`.
///
/// `Hz(0)` runs freely: a cycle begins when the one before has ended; in simulated time, where a cycle takes no time, a thousand times a
/// second. What is below zero or no number is taken for the [lowest](Frequency::LOWEST) there is, what is above a million for a million.
#[allow(non_snake_case)] // reads as the unit it is
pub fn Hz(cycles: impl Into<f64>) -> Frequency {
    let cycles = cycles.into();
    // A comparison that a number that is none fails as well.
    let hertz = if cycles == 0.0 {
        0.0
    } else if cycles > Frequency::LOWEST {
        cycles.min(Frequency::HIGHEST)
    } else {
        Frequency::LOWEST
    };
    Frequency { hertz }
}

impl Frequency {
    /// The lowest there is, in cycles a second.
    pub const LOWEST: f64 = 1e-9;
    /// The highest there is, in cycles a second.
    pub const HIGHEST: f64 = 1e6;

    /// Cycles a second; 0 for as many as there can be.
    pub fn hertz(self) -> f64 {
        self.hertz
    }

    /// Whether a cycle begins when the one before has ended.
    pub fn is_free(self) -> bool {
        self.hertz == 0.0
    }

    /// Cycles a second where each has its moment.
    fn grid(self) -> f64 {
        if self.is_free() { FREE } else { self.hertz }
    }

    /// The time from one cycle to the next.
    pub fn period(self) -> Duration {
        Duration::from_secs_f64(1.0 / self.grid())
    }

    /// When a cycle is due, counted from 0 at the start of the run. Each is computed from its number, so that nothing adds up.
    pub fn due(self, cycle: u64) -> Moment {
        Moment::from_secs_f64(cycle as f64 / self.grid())
    }

    /// The first cycle that is due at a moment or later.
    pub(crate) fn first_due(self, moment: Moment) -> u64 {
        let near = (moment.as_secs_f64() * self.grid()) as u64;
        // The estimate may be off by one to either side.
        let candidates = near.saturating_sub(1)..=near + 1;
        candidates.into_iter().find(|cycle| self.due(*cycle) >= moment).unwrap_or(near + 2)
    }
}

impl fmt::Display for Frequency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} Hz", self.hertz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_millionth_cycle_is_due_without_drift() {
        assert_eq!(Hz(30).due(3_000_000), Moment::from_nanos(100_000 * 1_000_000_000));
        assert_eq!(Hz(10).due(1), Moment::from_nanos(100_000_000));
        assert_eq!(Hz(10).due(0), Moment::ZERO);
    }

    #[test]
    fn the_first_cycle_from_a_moment_on_is_found() {
        assert_eq!(Hz(10).first_due(Moment::ZERO), 0);
        assert_eq!(Hz(10).first_due(Moment::from_nanos(100_000_000)), 1);
        assert_eq!(Hz(10).first_due(Moment::from_nanos(100_000_001)), 2);
        assert_eq!(Hz(30).first_due(Hz(30).due(1_000_001)), 1_000_001);
    }

    #[test]
    fn what_is_no_frequency_is_brought_within_bounds() {
        for cycles in [-1.0, f64::NAN, f64::NEG_INFINITY] {
            assert_eq!(Hz(cycles).hertz(), Frequency::LOWEST);
        }
        assert_eq!(Hz(f64::INFINITY).hertz(), Frequency::HIGHEST);
        assert!(Hz(0).is_free() && Hz(0).due(5) == Moment::from_nanos(5_000_000));
        assert_eq!(Hz(1e-300).hertz(), Frequency::LOWEST);
    }
}
