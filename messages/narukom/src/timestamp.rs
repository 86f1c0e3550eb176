//! Points in time, passed in by the runtime.

use std::fmt;
use std::ops::{Add, AddAssign, Sub};
use std::time::Duration;

const NANOS_PER_SEC: f64 = 1e9;

/// A point in time: nanoseconds since the start of the run.
///
/// Narukom reads no clock; times come from the runtime, simulated or real. 64 bits of nanoseconds
/// last for 584 years, and arithmetic saturates instead of wrapping.
///
/// ```
/// use narukom::Timestamp;
/// use std::time::Duration;
///
/// let kick_off = Timestamp::from_nanos(2_000_000_000);
/// let goal = kick_off + Duration::from_millis(1500);
/// assert_eq!(goal.since(kick_off), Duration::from_millis(1500));
/// assert_eq!(kick_off.since(goal), Duration::ZERO);
/// assert_eq!(goal.to_string(), "3.500000000 s");
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct Timestamp(u64);

impl Timestamp {
    /// The start of the run.
    pub const ZERO: Timestamp = Timestamp(0);
    /// The latest representable time.
    pub const MAX: Timestamp = Timestamp(u64::MAX);

    /// The time `nanos` nanoseconds after the start of the run.
    pub const fn from_nanos(nanos: u64) -> Timestamp {
        Timestamp(nanos)
    }

    /// Nanoseconds since the start of the run.
    pub const fn as_nanos(self) -> u64 {
        self.0
    }

    /// The time `seconds` after the start of the run, to the nearest nanosecond; negative values
    /// and NaN become [`Timestamp::ZERO`], values too large [`Timestamp::MAX`].
    pub fn from_secs_f64(seconds: f64) -> Timestamp {
        Timestamp((seconds * NANOS_PER_SEC).round() as u64)
    }

    /// Seconds since the start of the run.
    pub fn as_secs_f64(self) -> f64 {
        self.0 as f64 / NANOS_PER_SEC
    }

    /// The time elapsed since `earlier`; zero if `earlier` is later.
    pub const fn since(self, earlier: Timestamp) -> Duration {
        Duration::from_nanos(self.0.saturating_sub(earlier.0))
    }

    /// The absolute difference.
    pub const fn distance(self, other: Timestamp) -> Duration {
        Duration::from_nanos(self.0.abs_diff(other.0))
    }
}

/// The nanoseconds of `duration`, saturated.
fn saturated_nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

impl Add<Duration> for Timestamp {
    type Output = Timestamp;

    fn add(self, duration: Duration) -> Timestamp {
        Timestamp(self.0.saturating_add(saturated_nanos(duration)))
    }
}

impl AddAssign<Duration> for Timestamp {
    fn add_assign(&mut self, duration: Duration) {
        *self = *self + duration;
    }
}

impl Sub<Duration> for Timestamp {
    type Output = Timestamp;

    fn sub(self, duration: Duration) -> Timestamp {
        Timestamp(self.0.saturating_sub(saturated_nanos(duration)))
    }
}

impl fmt::Display for Timestamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{:09} s", self.0 / 1_000_000_000, self.0 % 1_000_000_000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_saturates_and_never_wraps() {
        let hour = Duration::from_secs(3600);
        assert_eq!(Timestamp::MAX + hour, Timestamp::MAX);
        assert_eq!(Timestamp::ZERO - hour, Timestamp::ZERO);
        assert_eq!(Timestamp::ZERO + Duration::MAX, Timestamp::MAX);
    }

    #[test]
    fn seconds_that_are_no_moment_are_clamped() {
        assert_eq!(Timestamp::from_secs_f64(-1.0), Timestamp::ZERO);
        assert_eq!(Timestamp::from_secs_f64(f64::NAN), Timestamp::ZERO);
        assert_eq!(Timestamp::from_secs_f64(f64::INFINITY), Timestamp::MAX);
        assert_eq!(Timestamp::from_secs_f64(0.1), Timestamp::from_nanos(100_000_000));
    }

    #[test]
    fn distance_has_no_direction() {
        let (early, late) = (Timestamp::from_nanos(3), Timestamp::from_nanos(10));
        assert_eq!(early.distance(late), late.distance(early));
        assert_eq!(early.distance(late), Duration::from_nanos(7));
    }
}
