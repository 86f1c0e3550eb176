//! How much may be sent: rules of robot soccer allow a team so many packets in so many seconds.

use std::collections::VecDeque;
use std::time::Duration;

use narukom::Moment;

/// The most that a link may send.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Budget {
    /// So many packets, whatever they carry,
    pub packets: u32,
    /// in any span of this length, wherever it begins.
    pub window: Duration,
    /// And so many bytes in each of them, stamp included.
    pub payload: usize,
}

impl Budget {
    /// The widest budget that is kept track of: more packets in a window than this are cut to it.
    pub const MOST_PACKETS: u32 = 1 << 16;
}

/// The packets of the last window. The oldest of as many as are allowed says when the next may go, so no window ever holds more.
#[derive(Debug)]
pub(crate) struct Spending {
    budget: Budget,
    sent: VecDeque<Moment>,
}

impl Spending {
    pub(crate) fn new(budget: Budget) -> Spending {
        let packets = budget.packets.min(Budget::MOST_PACKETS);
        Spending { budget: Budget { packets, ..budget }, sent: VecDeque::new() }
    }

    pub(crate) fn payload(&self) -> usize {
        self.budget.payload
    }

    /// When the next packet may go; never, if none may.
    pub(crate) fn next(&self) -> Moment {
        if self.budget.packets == 0 {
            return Moment::MAX;
        }
        if self.sent.len() < self.budget.packets as usize {
            return Moment::ZERO;
        }
        // A window holds both of its ends, so one nanosecond more.
        self.sent
            .front()
            .map_or(Moment::ZERO, |oldest| *oldest + self.budget.window + Duration::from_nanos(1))
    }

    pub(crate) fn spend(&mut self, now: Moment) {
        if self.sent.len() == self.budget.packets as usize {
            self.sent.pop_front();
        }
        self.sent.push_back(now);
    }

    /// How often a link may speak of itself: a quarter of the budget.
    pub(crate) fn shortest_beat(&self) -> Duration {
        self.budget.window.saturating_mul(4) / self.budget.packets.max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_window_holds_more_than_the_budget(
            packets in 1_u32..6,
            window in 1_u64..50,
            steps in proptest::collection::vec(0_u64..20, 1..200),
        ) {
            let budget = Budget { packets, window: Duration::from_nanos(window), payload: 128 };
            let mut spending = Spending::new(budget);
            let (mut now, mut sent) = (0, Vec::new());
            for step in steps {
                now += step;
                if spending.next() <= Moment::from_nanos(now) {
                    spending.spend(Moment::from_nanos(now));
                    sent.push(now);
                }
            }
            for start in &sent {
                let inside = sent.iter().filter(|at| (*start..=start + window).contains(*at)).count();
                prop_assert!(inside <= packets as usize, "{inside} from {start} on");
            }
        }
    }

    #[test]
    fn a_budget_is_used_up_to_its_end() {
        let budget = Budget { packets: 2, window: Duration::from_nanos(10), payload: 128 };
        let mut spending = Spending::new(budget);
        spending.spend(Moment::from_nanos(1));
        spending.spend(Moment::from_nanos(2));
        assert_eq!(spending.next(), Moment::from_nanos(12));
    }

    #[test]
    fn a_budget_of_nothing_lets_nothing_pass() {
        let budget = Budget { packets: 0, window: Duration::from_secs(1), payload: 128 };
        assert_eq!(Spending::new(budget).next(), Moment::MAX);
    }
}
