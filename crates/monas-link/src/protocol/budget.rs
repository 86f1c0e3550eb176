//! How much may be sent: rules of robot soccer allow a team so many packets in so many seconds.

use std::collections::VecDeque;
use std::time::Duration;

use narukom::Moment;

const MINUTE: Duration = Duration::from_secs(60);

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

    /// A robot's share of what the rules allow a team in a game of some length, spread evenly: so many packets in any minute. It
    /// is rounded down.
    ///
    /// In 2024 the rules of RoboCup's standard platform league gave a team of seven 1200 packets of at most 128 bytes for the twenty
    /// minutes of a game: `Budget::of_game(1200, Duration::from_secs(1200), 7, 128)` are 8 in any minute.
    pub fn of_game(packets: u32, length: Duration, robots: u32, payload: usize) -> Budget {
        // A game of five minutes and a bit touches six.
        let minutes = length.as_nanos().div_ceil(MINUTE.as_nanos()).max(1);
        let packets = u128::from(packets) / minutes / u128::from(robots.max(1));
        Budget { packets: packets.min(Budget::MOST_PACKETS.into()) as u32, window: MINUTE, payload }
    }
}

/// How much of a budget is used up.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Spent {
    /// What may be sent.
    pub budget: Budget,
    /// How many packets were sent in the window that ends now.
    pub packets: u32,
    /// When the next packet may go. Earlier, if that is in the past.
    pub next: Moment,
}

/// The packets of the last window. The oldest of as many as are allowed says when the next may go, so no window ever holds more.
///
/// What an earlier life of this host has sent is not known, so the first window is waited out.
#[derive(Debug)]
pub(crate) struct Spending {
    budget: Budget,
    sent: VecDeque<Moment>,
    /// When the first packet may go; none before the clock was seen.
    first: Option<Moment>,
}

impl Spending {
    pub(crate) fn new(budget: Budget) -> Spending {
        let packets = budget.packets.min(Budget::MOST_PACKETS);
        Spending { budget: Budget { packets, ..budget }, sent: VecDeque::new(), first: None }
    }

    pub(crate) fn payload(&self) -> usize {
        self.budget.payload
    }

    /// Sees the clock: the first time the window begins that is waited out.
    pub(crate) fn begin(&mut self, now: Moment) {
        let free = self.freed(now);
        self.first.get_or_insert(free);
    }

    /// When the next packet may go; never, if none may.
    pub(crate) fn next(&self) -> Moment {
        if self.budget.packets == 0 {
            return Moment::MAX;
        }
        let is_full = self.sent.len() == self.budget.packets as usize;
        let freed = self.sent.front().filter(|_| is_full).map(|oldest| self.freed(*oldest));
        freed.max(self.first).unwrap_or(Moment::ZERO)
    }

    /// When what was sent at `moment` is in no window with what is sent next. A window holds both of its ends, so one nanosecond more.
    fn freed(&self, moment: Moment) -> Moment {
        moment + self.budget.window + Duration::from_nanos(1)
    }

    /// How much is used up.
    pub(crate) fn spent(&self, now: Moment) -> Spent {
        let packets = self.sent.iter().filter(|sent| self.freed(**sent) > now).count() as u32;
        Spent { budget: self.budget, packets, next: self.next() }
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
        let spent = |now| spending.spent(Moment::from_nanos(now)).packets;
        assert_eq!((spent(2), spent(11), spent(12), spent(13)), (2, 2, 1, 0));
    }

    #[test]
    fn the_first_window_is_waited_out() {
        let budget = Budget { packets: 2, window: Duration::from_nanos(10), payload: 128 };
        let mut spending = Spending::new(budget);
        assert_eq!(spending.next(), Moment::ZERO, "the clock has not been seen");
        spending.begin(Moment::from_nanos(5));
        spending.begin(Moment::from_nanos(9));
        assert_eq!(spending.next(), Moment::from_nanos(16));
    }

    #[test]
    fn a_team_shares_what_a_game_allows() {
        let budget = Budget::of_game(1200, Duration::from_secs(1200), 7, 128);
        assert_eq!(budget, Budget { packets: 8, window: Duration::from_secs(60), payload: 128 });
        assert_eq!(Budget::of_game(600, Duration::from_secs(301), 1, 128).packets, 100);
        assert_eq!(Budget::of_game(1, Duration::ZERO, 0, 128).packets, 1);
    }

    #[test]
    fn a_budget_of_nothing_lets_nothing_pass() {
        let budget = Budget { packets: 0, window: Duration::from_secs(1), payload: 128 };
        assert_eq!(Spending::new(budget).next(), Moment::MAX);
    }
}
