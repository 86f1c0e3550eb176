//! Detects charts in real time that loop without a wait: each return of an activity leads to the
//! next call at once, as fast as the processor allows.

use std::time::Duration;

use narukom::Timestamp;
use yase::NodeId;

/// From this rate on a loop is reported: calls per second that only returns of activities caused.
const RATE: f64 = 1000.0;

/// The interval over which the rate is measured.
const WINDOW: Duration = Duration::from_secs(1);

/// Number of recent calls from which the loop is determined.
const RECENT: usize = 32;

/// Counts the calls of a chart that only returns of its activities caused.
#[derive(Default)]
pub(crate) struct FreeLoop {
    /// Whether only returns caused the present turn.
    is_free: bool,
    since: Timestamp,
    calls: u32,
    /// The states of the last of these calls, in a ring.
    recent: Vec<NodeId>,
    next: usize,
    /// Whether the loop has been reported.
    was_reported: bool,
}

/// A loop without a wait.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct LoopReport {
    /// Its states, in the order of their calls.
    pub(crate) states: Vec<NodeId>,
    /// Calls per second.
    pub(crate) rate: f64,
}

impl FreeLoop {
    /// Begins a turn. A message, a time that was reached and a command are waits.
    pub(crate) fn begin_turn(&mut self, is_free: bool) {
        self.is_free = is_free;
    }

    /// Notes a call of the activity of a state.
    pub(crate) fn called(&mut self, node: NodeId) {
        if !self.is_free {
            return;
        }
        self.calls += 1;
        match self.recent.get_mut(self.next) {
            Some(place) => *place = node,
            None => self.recent.push(node),
        }
        self.next = (self.next + 1) % RECENT;
    }

    /// Ends a turn. Returns a loop that was not reported before.
    pub(crate) fn end_turn(&mut self, now: Timestamp) -> Option<LoopReport> {
        let elapsed = now.since(self.since);
        if elapsed < WINDOW {
            return None;
        }
        let rate = f64::from(self.calls) / elapsed.as_secs_f64();
        let found = (rate >= RATE && !self.was_reported).then(|| LoopReport { states: self.states(), rate });
        self.was_reported |= found.is_some();
        (self.since, self.calls) = (now, 0);
        found
    }

    /// The shortest sequence of states that the recent calls repeat; without one, all their states.
    fn states(&self) -> Vec<NodeId> {
        let (newer, older) = self.recent.split_at(self.next.min(self.recent.len()));
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
        assert_eq!(reports.len(), 1);
        let mut states = reports[0].states.clone();
        assert_eq!(states.len(), 3);
        let first = states.iter().position(|node| *node == NodeId(3)).unwrap();
        states.rotate_left(first);
        assert_eq!(states, [3, 5, 4].map(NodeId));
        assert!((reports[0].rate - 10_000.0).abs() < 10.0, "{reports:?}");
    }

    #[test]
    fn a_slower_loop_and_one_that_waits_are_not() {
        assert_eq!(looped(&[3, 5], 1100, true), []);
        assert_eq!(looped(&[3, 5], 100, false), []);
    }

    #[test]
    fn calls_without_a_period_are_named_once_each() {
        let mut free_loop = FreeLoop { is_free: true, ..FreeLoop::default() };
        [1, 2, 1, 1, 2, 2, 1, 2].into_iter().for_each(|node| free_loop.called(NodeId(node)));
        for _ in 0..2000 {
            free_loop.calls += 1;
        }
        assert_eq!(free_loop.end_turn(after(1500)).unwrap().states, [1, 2].map(NodeId));
    }
}
