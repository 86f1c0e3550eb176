//! Detects charts that loop without a wait: each return of an activity leads to the next call at
//! once, in real time as fast as the processor allows, in simulated time at the same time.

use std::time::Duration;

use narukom::Timestamp;
use yase::NodeId;

/// From this rate on a loop is reported: calls per second that only returns of activities caused.
const MIN_REPORTED_RATE: f64 = 1000.0;

/// The remedy for such a loop.
pub(crate) const LOOP_REMEDY: &str =
    "let an activity return `Ongoing`, or wait in a transition for a message, an event or a timer";

/// The interval over which the rate is measured.
const WINDOW: Duration = Duration::from_secs(1);

/// Number of recent calls from which the loop is determined.
const RECENT_CALLS: usize = 32;

/// Counts the calls of a chart that only returns of its activities caused.
#[derive(Default)]
pub(crate) struct FreeLoop {
    /// Whether only returns caused the present turn.
    is_free: bool,
    since: Timestamp,
    calls: u32,
    recent: RecentCalls,
    /// Whether the chart looped in the last interval.
    is_looping: bool,
    /// Whether a loop has been reported.
    was_reported: bool,
}

/// The observation of an interval.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum LoopReport {
    /// A loop has begun.
    Begun {
        /// Its states, in the order of their calls.
        states: Vec<NodeId>,
        /// Calls per second.
        rate: f64,
        /// Whether it is the first one of the chart.
        is_first: bool,
    },
    /// The loop has ended.
    Ended,
}

/// The states of the last calls of a chart.
#[derive(Default)]
pub(crate) struct RecentCalls {
    ring: Vec<NodeId>,
    next: usize,
}

impl FreeLoop {
    /// Begins a turn. Waking up for a message, a deadline or a command counts as a wait.
    pub(crate) fn begin_turn(&mut self, is_free: bool) {
        self.is_free = is_free;
    }

    /// Notes a call of the activity of a state.
    pub(crate) fn called(&mut self, node: NodeId) {
        if !self.is_free {
            return;
        }
        self.calls += 1;
        self.recent.add(node);
    }

    /// Ends a turn. Returns whether a loop has begun or ended since the last interval.
    pub(crate) fn end_turn(&mut self, now: Timestamp) -> Option<LoopReport> {
        let elapsed = now.since(self.since);
        if elapsed < WINDOW {
            return None;
        }
        let rate = f64::from(self.calls) / elapsed.as_secs_f64();
        (self.since, self.calls) = (now, 0);
        let was_looping = std::mem::replace(&mut self.is_looping, rate >= MIN_REPORTED_RATE);
        match (was_looping, self.is_looping) {
            (false, true) => {
                let is_first = !std::mem::replace(&mut self.was_reported, true);
                Some(LoopReport::Begun { states: self.recent.states(), rate, is_first })
            }
            (true, false) => Some(LoopReport::Ended),
            _ => None,
        }
    }
}

impl RecentCalls {
    /// Whether it consists of this number of last calls.
    pub(crate) fn is_filled_by(&self, calls: u32) -> bool {
        calls as usize >= RECENT_CALLS
    }

    /// Adds a call of the activity of a state.
    pub(crate) fn add(&mut self, node: NodeId) {
        match self.ring.get_mut(self.next) {
            Some(oldest) => *oldest = node,
            None => self.ring.push(node),
        }
        self.next = (self.next + 1) % RECENT_CALLS;
    }

    /// The shortest sequence of states that the recent calls repeat; without one, all their states.
    pub(crate) fn states(&self) -> Vec<NodeId> {
        let (newer, older) = self.ring.split_at(self.next.min(self.ring.len()));
        let calls: Vec<NodeId> = older.iter().chain(newer).copied().collect();
        let is_period = |length: &usize| calls.windows(length + 1).all(|window| window[0] == window[*length]);
        match (1..=calls.len() / 2).find(is_period) {
            Some(length) => calls[calls.len() - length..].to_vec(),
            None => {
                let mut states = calls;
                states.sort_unstable();
                states.dedup();
                states
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(millis: u64) -> Timestamp {
        Timestamp::from_nanos(millis * 1_000_000)
    }

    /// Calls these states in turn, with an interval of microseconds, for more than a second.
    fn looped(nodes: &[u32], micros: u64, is_free: bool) -> Vec<LoopReport> {
        let mut free_loop = FreeLoop::default();
        let calls = (0..3_000_000 / micros).zip(nodes.iter().cycle());
        let reports = calls.filter_map(|(number, node)| {
            free_loop.begin_turn(is_free);
            free_loop.called(NodeId(*node));
            free_loop.end_turn(Timestamp::from_nanos(number * micros * 1000))
        });
        reports.collect()
    }

    #[test]
    fn a_loop_as_fast_as_the_processor_allows_is_reported_once_with_its_states() {
        let reports = looped(&[3, 5, 4], 100, true);
        let [LoopReport::Begun { states, rate, is_first: true }] = reports.as_slice() else {
            panic!("{reports:?}")
        };
        let mut states = states.clone();
        assert_eq!(states.len(), 3);
        let first = states.iter().position(|node| *node == NodeId(3)).unwrap();
        states.rotate_left(first);
        assert_eq!(states, [3, 5, 4].map(NodeId));
        assert!((rate - 10_000.0).abs() < 10.0, "{reports:?}");
    }

    #[test]
    fn a_slower_loop_and_one_that_waits_are_not() {
        assert_eq!(looped(&[3, 5], 1100, true), []);
        assert_eq!(looped(&[3, 5], 100, false), []);
    }

    #[test]
    fn the_end_of_a_loop_is_noticed_and_a_second_one_is_not_the_first() {
        let mut free_loop = FreeLoop { is_free: true, ..FreeLoop::default() };
        let reports = [2000, 3000, 0, 10, 2000].into_iter().zip(1_u64..).map(|(calls, seconds)| {
            (0..calls).for_each(|_| free_loop.called(NodeId(3)));
            free_loop.end_turn(after(1000 * seconds))
        });
        let begun = |rate, is_first| Some(LoopReport::Begun { states: vec![NodeId(3)], rate, is_first });
        let expected = [begun(2000.0, true), None, Some(LoopReport::Ended), None, begun(2000.0, false)];
        assert_eq!(reports.collect::<Vec<_>>(), expected);
    }

    #[test]
    fn calls_without_a_period_are_named_once_each() {
        let mut recent = RecentCalls::default();
        [1, 2, 1, 1, 2, 2, 1, 2].into_iter().for_each(|node| recent.add(NodeId(node)));
        assert_eq!(recent.states(), [1, 2].map(NodeId));
    }
}
