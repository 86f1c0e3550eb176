//! Send budgets: rules of robot soccer limit the packets of a team in a period.

use std::collections::VecDeque;
use std::time::Duration;

use narukom::Timestamp;

const MINUTE: Duration = Duration::from_secs(60);

/// The most that a link may send.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SendBudget {
    /// The most packets, of any kind,
    pub packets: u32,
    /// in any window of this length.
    pub window: Duration,
    /// The most bytes in each packet, stamp included.
    pub payload: usize,
}

impl SendBudget {
    /// The most packets per window that are tracked: larger budgets are reduced to it.
    pub const MOST_PACKETS: u32 = 1 << 16;

    /// A robot's share of the packets that the rules allow a team in a game of a given length,
    /// spread evenly: the number of packets in any minute, rounded down.
    ///
    /// In 2024 the rules of RoboCup's standard platform league allowed a team of seven 1200 packets
    /// of at most 128 bytes in the twenty minutes of a game:
    /// `SendBudget::of_game(1200, Duration::from_secs(1200), 7, 128)` is 8 in any minute.
    pub fn of_game(packets: u32, length: Duration, robots: u32, payload: usize) -> SendBudget {
        // A game of slightly more than five minutes overlaps six windows.
        let minutes = length.as_nanos().div_ceil(MINUTE.as_nanos()).max(1);
        let packets = u128::from(packets) / minutes / u128::from(robots.max(1));
        SendBudget { packets: packets.min(SendBudget::MOST_PACKETS.into()) as u32, window: MINUTE, payload }
    }
}

/// Use of a budget.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BudgetUsage {
    /// The budget.
    pub budget: SendBudget,
    /// The number of packets sent in the window that ends now.
    pub packets: u32,
    /// When the next packet may be sent; at once if that is in the past.
    pub next: Timestamp,
}

/// The packets of the last window. The budgeted number of packets is remembered, and the oldest
/// determines when the next may be sent, so no window ever contains more.
///
/// The data sent by an earlier incarnation of this host is unknown, so the link waits for the first
/// window to pass.
#[derive(Debug)]
pub(crate) struct BudgetWindow {
    budget: SendBudget,
    sent: VecDeque<Timestamp>,
    /// When the first packet may be sent; `None` before the first time was passed in.
    first: Option<Timestamp>,
}

impl BudgetWindow {
    pub(crate) fn new(budget: SendBudget) -> BudgetWindow {
        let packets = budget.packets.min(SendBudget::MOST_PACKETS);
        BudgetWindow { budget: SendBudget { packets, ..budget }, sent: VecDeque::new(), first: None }
    }

    pub(crate) fn payload(&self) -> usize {
        self.budget.payload
    }

    /// Passes in the time; the first call starts the initial window.
    pub(crate) fn begin(&mut self, now: Timestamp) {
        let free = self.freed(now);
        self.first.get_or_insert(free);
    }

    /// When the next packet may be sent; never, if the budget is zero.
    pub(crate) fn next(&self) -> Timestamp {
        if self.budget.packets == 0 {
            return Timestamp::MAX;
        }
        let is_full = self.sent.len() == self.budget.packets as usize;
        let freed = self.sent.front().filter(|_| is_full).map(|oldest| self.freed(*oldest));
        freed.max(self.first).unwrap_or(Timestamp::ZERO)
    }

    /// When a packet sent at `moment` shares no window with the next one. A window includes both
    /// ends, so one nanosecond more.
    fn freed(&self, moment: Timestamp) -> Timestamp {
        moment + self.budget.window + Duration::from_nanos(1)
    }

    /// The use of the budget.
    pub(crate) fn spent(&self, now: Timestamp) -> BudgetUsage {
        let packets = self.sent.iter().filter(|sent| self.freed(**sent) > now).count() as u32;
        BudgetUsage { budget: self.budget, packets, next: self.next() }
    }

    pub(crate) fn spend(&mut self, now: Timestamp) {
        if self.sent.len() == self.budget.packets as usize {
            self.sent.pop_front();
        }
        self.sent.push_back(now);
    }

    /// Shortest interval between beats: they may use a quarter of the budget.
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
            let budget = SendBudget { packets, window: Duration::from_nanos(window), payload: 128 };
            let mut spending = BudgetWindow::new(budget);
            let (mut now, mut sent) = (0, Vec::new());
            for step in steps {
                now += step;
                if spending.next() <= Timestamp::from_nanos(now) {
                    spending.spend(Timestamp::from_nanos(now));
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
        let budget = SendBudget { packets: 2, window: Duration::from_nanos(10), payload: 128 };
        let mut spending = BudgetWindow::new(budget);
        spending.spend(Timestamp::from_nanos(1));
        spending.spend(Timestamp::from_nanos(2));
        assert_eq!(spending.next(), Timestamp::from_nanos(12));
        let spent = |now| spending.spent(Timestamp::from_nanos(now)).packets;
        assert_eq!((spent(2), spent(11), spent(12), spent(13)), (2, 2, 1, 0));
    }

    #[test]
    fn the_first_window_is_waited_out() {
        let budget = SendBudget { packets: 2, window: Duration::from_nanos(10), payload: 128 };
        let mut spending = BudgetWindow::new(budget);
        assert_eq!(spending.next(), Timestamp::ZERO, "the clock has not been seen");
        spending.begin(Timestamp::from_nanos(5));
        spending.begin(Timestamp::from_nanos(9));
        assert_eq!(spending.next(), Timestamp::from_nanos(16));
    }

    #[test]
    fn a_team_shares_what_a_game_allows() {
        let budget = SendBudget::of_game(1200, Duration::from_secs(1200), 7, 128);
        assert_eq!(budget, SendBudget { packets: 8, window: Duration::from_secs(60), payload: 128 });
        assert_eq!(SendBudget::of_game(600, Duration::from_secs(301), 1, 128).packets, 100);
        assert_eq!(SendBudget::of_game(1, Duration::ZERO, 0, 128).packets, 1);
    }

    #[test]
    fn a_budget_of_nothing_lets_nothing_pass() {
        let budget = SendBudget { packets: 0, window: Duration::from_secs(1), payload: 128 };
        assert_eq!(BudgetWindow::new(budget).next(), Timestamp::MAX);
    }
}
