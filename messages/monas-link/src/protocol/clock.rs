//! Estimation of another host's clock offset, after the Network Time Protocol (RFC 5905, sections 8
//! and 10).

use narukom::Timestamp;

/// Number of measurements of which the one with the shortest round trip is used.
const MEASUREMENTS: usize = 8;

/// The largest step, in nanoseconds, of a clock that advances in steps, as in simulated time.
const LONGEST_STEP: i128 = 50_000_000;

/// The estimated offset of another host's clock.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ClockOffset {
    /// Nanoseconds by which the other clock is ahead of this one.
    pub ahead: i64,
    /// Round-trip time in nanoseconds; the error of the offset is at most half of it, plus one step
    /// if the clocks advance in steps.
    pub round_trip: u64,
}

impl ClockOffset {
    /// Converts a time of the other clock to this clock.
    pub fn local(self, other: Timestamp) -> Timestamp {
        let nanos = i128::from(other.as_nanos()) - i128::from(self.ahead);
        Timestamp::from_nanos(u64::try_from(nanos.max(0)).unwrap_or(u64::MAX))
    }
}

/// The last measurements.
#[derive(Default, Debug)]
pub(crate) struct ClockFilter {
    measured: [Option<ClockOffset>; MEASUREMENTS],
    next: usize,
}

impl ClockFilter {
    /// Adds a measurement: this host sent at `sent`, the other received it at `heard` and replied
    /// at `answered`, which arrived here at `received`. The middle two are times of the other
    /// clock. Impossible measurements are ignored.
    ///
    /// If a clock advances in steps, a round trip may appear negative. It is not ignored, since the
    /// steps of one side may be synchronous with the beats of the other, and then all round trips
    /// appear so; its absolute value is used.
    pub(crate) fn measure(
        &mut self,
        sent: Timestamp,
        heard: Timestamp,
        answered: Timestamp,
        received: Timestamp,
    ) {
        let [sent, heard, answered, received] =
            [sent, heard, answered, received].map(|moment| i128::from(moment.as_nanos()));
        let round_trip = (received - sent) - (answered - heard);
        let ahead = ((heard - sent) + (answered - received)) / 2;
        if received < sent || answered < heard || round_trip < -LONGEST_STEP {
            return;
        }
        let (Ok(ahead), Ok(round_trip)) = (i64::try_from(ahead), u64::try_from(round_trip.abs())) else {
            return;
        };
        self.measured[self.next] = Some(ClockOffset { ahead, round_trip });
        self.next = (self.next + 1) % MEASUREMENTS;
    }

    /// The best of the last measurements.
    pub(crate) fn offset(&self) -> Option<ClockOffset> {
        self.measured.iter().flatten().min_by_key(|offset| offset.round_trip).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(nanos: u64) -> Timestamp {
        Timestamp::from_nanos(nanos)
    }

    #[test]
    fn the_offset_is_exact_when_both_ways_are_equally_long() {
        let mut filter = ClockFilter::default();
        // The other clock is 1000 ahead, each way takes 5, the reply is delayed by 20.
        filter.measure(at(100), at(1105), at(1125), at(130));
        assert_eq!(filter.offset(), Some(ClockOffset { ahead: 1000, round_trip: 10 }));
        assert_eq!(filter.offset().unwrap().local(at(1500)), at(500));
    }

    #[test]
    fn the_shortest_way_is_believed() {
        let mut filter = ClockFilter::default();
        filter.measure(at(100), at(1190), at(1190), at(200));
        filter.measure(at(300), at(1305), at(1305), at(310));
        assert_eq!(filter.offset(), Some(ClockOffset { ahead: 1000, round_trip: 10 }));
    }

    #[test]
    fn impossible_values_are_rejected() {
        let mut filter = ClockFilter::default();
        filter.measure(at(100), at(5), at(4), at(200));
        filter.measure(at(100), at(5), at(50_000_200), at(101));
        filter.measure(at(100), at(0), at(0), at(99));
        filter.measure(at(0), at(u64::MAX), at(u64::MAX), at(0));
        assert_eq!(filter.offset(), None);
    }

    #[test]
    fn a_way_that_seems_too_short_is_that_of_a_clock_that_goes_in_steps() {
        let mut filter = ClockFilter::default();
        filter.measure(at(100), at(1000), at(1040), at(130));
        assert_eq!(filter.offset(), Some(ClockOffset { ahead: 905, round_trip: 10 }));
        filter.measure(at(200), at(1100), at(1132), at(230));
        assert_eq!(filter.offset().unwrap().round_trip, 2, "the one that seems least wrong is believed");
    }

    #[test]
    fn moments_before_the_beginning_are_the_beginning() {
        assert_eq!(ClockOffset { ahead: 10, round_trip: 0 }.local(at(3)), Timestamp::ZERO);
        assert_eq!(ClockOffset { ahead: -10, round_trip: 0 }.local(at(u64::MAX)), Timestamp::MAX);
    }
}
