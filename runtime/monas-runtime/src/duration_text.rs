//! Durations in log lines.

use std::fmt;
use std::time::Duration;

/// A duration for people: `44.6µs`; `-` if nothing was measured.
#[derive(Clone, Copy)]
pub(crate) struct DurationText(pub(crate) Option<Duration>);

impl fmt::Display for DurationText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(duration) => write!(f, "{duration:.1?}"),
            None => f.write_str("-"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duration_is_written_for_people() {
        let text = |nanos| DurationText(Some(Duration::from_nanos(nanos))).to_string();
        assert_eq!([text(44_557), text(1_250_000), text(2_000_000_000)], ["44.6µs", "1.2ms", "2.0s"]);
        assert_eq!(DurationText(None).to_string(), "-");
    }
}
