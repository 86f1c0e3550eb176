//! The frequency of an agent's cycles.

use std::fmt;
use std::time::Duration;

use narukom::Timestamp;

/// Cycles per second of a free-running agent where cycles take no time.
const FREE_RUNNING_RATE: f64 = 1000.0;

/// A number of cycles per second.
#[derive(Clone, Copy, PartialEq, PartialOrd, Debug)]
pub struct Frequency {
    hertz: f64,
}

/// A frequency in cycles per second: `Hz(10)`, `Hz(83.3)`.
///
/// `Hz(0)` runs freely: a cycle begins when the previous one has ended; in simulated time, where a
/// cycle takes no time, a thousand times per second. Negative values and NaN become
/// [`LOWEST`](Frequency::LOWEST), values above [`HIGHEST`](Frequency::HIGHEST) become that.
#[allow(non_snake_case)] // reads as the unit it is
pub fn Hz(cycles: impl Into<f64>) -> Frequency {
    let cycles = cycles.into();
    // The comparison is false for NaN too.
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
    /// The lowest frequency, in cycles per second.
    pub const LOWEST: f64 = 1e-9;
    /// The highest frequency, in cycles per second.
    pub const HIGHEST: f64 = 1e6;

    /// Cycles per second; 0 for free-running.
    pub fn hertz(self) -> f64 {
        self.hertz
    }

    /// Whether a cycle begins as soon as the previous one has ended.
    pub fn is_free(self) -> bool {
        self.hertz == 0.0
    }

    /// Cycles per second on the grid of start times.
    fn grid(self) -> f64 {
        if self.is_free() { FREE_RUNNING_RATE } else { self.hertz }
    }

    /// The time from one cycle to the next.
    pub fn period(self) -> Duration {
        Duration::from_secs_f64(1.0 / self.grid())
    }

    /// The start time of a cycle, counted from 0 at the start of the run. Computed from its number,
    /// so that rounding errors do not accumulate.
    pub fn due(self, cycle: u64) -> Timestamp {
        Timestamp::from_secs_f64(cycle as f64 / self.grid())
    }

    /// The first cycle due at or after a time.
    pub fn first_due(self, moment: Timestamp) -> u64 {
        let near = (moment.as_secs_f64() * self.grid()) as u64;
        // The estimate may be off by one in either direction.
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
        assert_eq!(Hz(30).due(3_000_000), Timestamp::from_nanos(100_000 * 1_000_000_000));
        assert_eq!(Hz(10).due(1), Timestamp::from_nanos(100_000_000));
        assert_eq!(Hz(10).due(0), Timestamp::ZERO);
    }

    #[test]
    fn the_first_cycle_from_a_moment_on_is_found() {
        assert_eq!(Hz(10).first_due(Timestamp::ZERO), 0);
        assert_eq!(Hz(10).first_due(Timestamp::from_nanos(100_000_000)), 1);
        assert_eq!(Hz(10).first_due(Timestamp::from_nanos(100_000_001)), 2);
        assert_eq!(Hz(30).first_due(Hz(30).due(1_000_001)), 1_000_001);
    }

    #[test]
    fn invalid_frequencies_are_clamped() {
        for cycles in [-1.0, f64::NAN, f64::NEG_INFINITY] {
            assert_eq!(Hz(cycles).hertz(), Frequency::LOWEST);
        }
        assert_eq!(Hz(f64::INFINITY).hertz(), Frequency::HIGHEST);
        assert!(Hz(0).is_free() && Hz(0).due(5) == Timestamp::from_nanos(5_000_000));
        assert_eq!(Hz(1e-300).hertz(), Frequency::LOWEST);
    }
}
