//! How far another host's clock is from this one's, after the Network Time Protocol (RFC 5905, sections 8 and 10).

use narukom::Moment;

/// Of so many measurements the one with the shortest way there and back is believed.
const MEASUREMENTS: usize = 8;

/// A clock may go in steps, as that of a run in simulated time does, of at most this many nanoseconds.
const LONGEST_STEP: i128 = 50_000_000;

/// What is known of another host's clock.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ClockOffset {
    /// Nanoseconds by which the other clock is ahead of this one.
    pub ahead: i64,
    /// Nanoseconds of the way there and back; the offset is wrong by at most half of it, and by a step of the clocks if they go in steps.
    pub way: u64,
}

impl ClockOffset {
    /// A moment of the other clock, by this one.
    pub fn local(self, other: Moment) -> Moment {
        let nanos = i128::from(other.as_nanos()) - i128::from(self.ahead);
        Moment::from_nanos(u64::try_from(nanos.max(0)).unwrap_or(u64::MAX))
    }
}

/// The last measurements.
#[derive(Default, Debug)]
pub(crate) struct ClockFilter {
    measured: [Option<ClockOffset>; MEASUREMENTS],
    next: usize,
}

impl ClockFilter {
    /// Takes a measurement: this host sent at `sent`, the other received that at `heard` and answered at `answered`, which came here
    /// at `received`. The middle two are of the other's clock. What cannot be so is not taken.
    ///
    /// Where a clock goes in steps a way may seem to take less than no time. That is not refused, since the steps of one side and the beats
    /// of the other may keep pace, and then all ways seem so; such a way is taken for as long as it seems too short.
    pub(crate) fn measure(&mut self, sent: Moment, heard: Moment, answered: Moment, received: Moment) {
        let [sent, heard, answered, received] =
            [sent, heard, answered, received].map(|moment| i128::from(moment.as_nanos()));
        let way = (received - sent) - (answered - heard);
        let ahead = ((heard - sent) + (answered - received)) / 2;
        if received < sent || answered < heard || way < -LONGEST_STEP {
            return;
        }
        let (Ok(ahead), Ok(way)) = (i64::try_from(ahead), u64::try_from(way.abs())) else { return };
        self.measured[self.next] = Some(ClockOffset { ahead, way });
        self.next = (self.next + 1) % MEASUREMENTS;
    }

    /// The best of the last measurements.
    pub(crate) fn offset(&self) -> Option<ClockOffset> {
        self.measured.iter().flatten().min_by_key(|offset| offset.way).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(nanos: u64) -> Moment {
        Moment::from_nanos(nanos)
    }

    #[test]
    fn the_offset_is_exact_when_both_ways_are_equally_long() {
        let mut filter = ClockFilter::default();
        // The other clock is 1000 ahead, each way takes 5, the answer waits for 20.
        filter.measure(at(100), at(1105), at(1125), at(130));
        assert_eq!(filter.offset(), Some(ClockOffset { ahead: 1000, way: 10 }));
        assert_eq!(filter.offset().unwrap().local(at(1500)), at(500));
    }

    #[test]
    fn the_shortest_way_is_believed() {
        let mut filter = ClockFilter::default();
        filter.measure(at(100), at(1190), at(1190), at(200));
        filter.measure(at(300), at(1305), at(1305), at(310));
        assert_eq!(filter.offset(), Some(ClockOffset { ahead: 1000, way: 10 }));
    }

    #[test]
    fn what_cannot_be_is_not_believed() {
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
        assert_eq!(filter.offset(), Some(ClockOffset { ahead: 905, way: 10 }));
        filter.measure(at(200), at(1100), at(1132), at(230));
        assert_eq!(filter.offset().unwrap().way, 2, "the one that seems least wrong is believed");
    }

    #[test]
    fn moments_before_the_beginning_are_the_beginning() {
        assert_eq!(ClockOffset { ahead: 10, way: 0 }.local(at(3)), Moment::ZERO);
        assert_eq!(ClockOffset { ahead: -10, way: 0 }.local(at(u64::MAX)), Moment::MAX);
    }
}
