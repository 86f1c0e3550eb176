//! Time as passed to the machine.

use std::fmt;
use std::ops::Add;
use std::time::Duration;

use serde::{Deserialize, Serialize};

/// A time on the host's clock: nanoseconds since an origin of its choice. Its text form is that
/// number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Timestamp(u64);

impl Timestamp {
    /// The origin of the clock.
    pub const ZERO: Timestamp = Timestamp(0);

    /// The time `nanos` nanoseconds after the origin.
    pub const fn from_nanos(nanos: u64) -> Timestamp {
        Timestamp(nanos)
    }

    /// The time `millis` milliseconds after the origin; saturates at the last representable time.
    pub const fn from_millis(millis: u64) -> Timestamp {
        Timestamp(millis.saturating_mul(1_000_000))
    }

    /// Nanoseconds since the origin.
    pub const fn as_nanos(self) -> u64 {
        self.0
    }

    /// The time elapsed since `earlier`; zero if that is not earlier.
    pub const fn since(self, earlier: Timestamp) -> Duration {
        Duration::from_nanos(self.0.saturating_sub(earlier.0))
    }
}

impl Add<Duration> for Timestamp {
    type Output = Timestamp;

    /// A later time; saturates at the last representable time (584 years).
    fn add(self, delay: Duration) -> Timestamp {
        let nanos = u64::try_from(delay.as_nanos()).unwrap_or(u64::MAX);
        Timestamp(self.0.saturating_add(nanos))
    }
}

impl fmt::Display for Timestamp {
    /// Seconds with three decimals, or more if needed: `0.350 s`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (seconds, nanos) = (self.0 / 1_000_000_000, self.0 % 1_000_000_000);
        match nanos % 1_000_000 {
            0 => write!(f, "{seconds}.{:03} s", nanos / 1_000_000),
            _ => write!(f, "{seconds}.{nanos:09} s"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn additions_and_differences_stay_within_the_clock() {
        let late = Timestamp::from_nanos(u64::MAX);
        assert_eq!(late + Duration::MAX, late);
        assert_eq!(Timestamp::from_millis(u64::MAX), late);
        assert_eq!(Timestamp::ZERO.since(late), Duration::ZERO);
        assert_eq!(
            (Timestamp::ZERO + Duration::from_millis(3)).since(Timestamp::from_millis(1)).as_millis(),
            2
        );
    }

    #[test]
    fn display_shows_milliseconds_and_what_is_finer() {
        assert_eq!(Timestamp::from_millis(12_350).to_string(), "12.350 s");
        assert_eq!(Timestamp::from_nanos(1_000_001).to_string(), "0.001000001 s");
    }
}
