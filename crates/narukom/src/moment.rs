//! Points in time, handed in by whoever runs the agents.

use std::fmt;
use std::ops::{Add, AddAssign, Sub};
use std::time::Duration;

const NANOS_PER_SEC: f64 = 1e9;

/// A point in time: nanoseconds since the start of the run.
///
/// Nothing in Narukom reads a clock; moments come from the runtime, simulated or real. 64 bits of nanoseconds last for
/// 584 years, and arithmetic saturates instead of wrapping.
///
/// ```
/// use narukom::Moment;
/// use std::time::Duration;
///
/// let kick_off = Moment::from_nanos(2_000_000_000);
/// let goal = kick_off + Duration::from_millis(1500);
/// assert_eq!(goal.since(kick_off), Duration::from_millis(1500));
/// assert_eq!(kick_off.since(goal), Duration::ZERO);
/// assert_eq!(goal.to_string(), "3.500000000 s");
/// ```
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct Moment(u64);

impl Moment {
    /// The start of the run.
    pub const ZERO: Moment = Moment(0);
    /// The last moment there is.
    pub const MAX: Moment = Moment(u64::MAX);

    /// The moment `nanos` nanoseconds after the start of the run.
    pub const fn from_nanos(nanos: u64) -> Moment {
        Moment(nanos)
    }

    /// Nanoseconds since the start of the run.
    pub const fn as_nanos(self) -> u64 {
        self.0
    }

    /// The moment `seconds` after the start of the run, to the nearest nanosecond; what is negative or not a number is
    /// [`Moment::ZERO`], what is too large is [`Moment::MAX`].
    pub fn from_secs_f64(seconds: f64) -> Moment {
        Moment((seconds * NANOS_PER_SEC).round() as u64)
    }

    /// Seconds since the start of the run.
    pub fn as_secs_f64(self) -> f64 {
        self.0 as f64 / NANOS_PER_SEC
    }

    /// How long after `earlier` this is; nothing if it is not after.
    pub const fn since(self, earlier: Moment) -> Duration {
        Duration::from_nanos(self.0.saturating_sub(earlier.0))
    }

    /// How far the two are apart, whichever comes first.
    pub const fn distance(self, other: Moment) -> Duration {
        Duration::from_nanos(self.0.abs_diff(other.0))
    }
}

/// The nanoseconds of `duration`, as many as fit.
fn saturated_nanos(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}

impl Add<Duration> for Moment {
    type Output = Moment;

    fn add(self, duration: Duration) -> Moment {
        Moment(self.0.saturating_add(saturated_nanos(duration)))
    }
}

impl AddAssign<Duration> for Moment {
    fn add_assign(&mut self, duration: Duration) {
        *self = *self + duration;
    }
}

impl Sub<Duration> for Moment {
    type Output = Moment;

    fn sub(self, duration: Duration) -> Moment {
        Moment(self.0.saturating_sub(saturated_nanos(duration)))
    }
}

impl fmt::Display for Moment {
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
        assert_eq!(Moment::MAX + hour, Moment::MAX);
        assert_eq!(Moment::ZERO - hour, Moment::ZERO);
        assert_eq!(Moment::ZERO + Duration::MAX, Moment::MAX);
    }

    #[test]
    fn seconds_that_are_no_moment_are_clamped() {
        assert_eq!(Moment::from_secs_f64(-1.0), Moment::ZERO);
        assert_eq!(Moment::from_secs_f64(f64::NAN), Moment::ZERO);
        assert_eq!(Moment::from_secs_f64(f64::INFINITY), Moment::MAX);
        assert_eq!(Moment::from_secs_f64(0.1), Moment::from_nanos(100_000_000));
    }

    #[test]
    fn distance_has_no_direction() {
        let (early, late) = (Moment::from_nanos(3), Moment::from_nanos(10));
        assert_eq!(early.distance(late), late.distance(early));
        assert_eq!(early.distance(late), Duration::from_nanos(7));
    }
}
