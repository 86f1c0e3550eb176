//! Heartbeat that lets the supervisor detect stuck calls.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use narukom::Timestamp;

/// Set by a thread when it begins an operation that should end soon, and read by the supervisor.
///
/// The start time and the abandoned mark share one atomic number, so that exactly the observed
/// operation is abandoned: a cycle that has ended meanwhile has succeeded, and the next one is not
/// affected.
#[derive(Default)]
pub(crate) struct Watchdog {
    /// Start time in nanoseconds plus one, possibly with [`ABANDONED`]; 0 while nothing is in
    /// progress.
    began: AtomicU64,
    cycle: AtomicU64,
    activity: AtomicUsize,
}

/// Marks an abandoned operation, whose results are not published. Clocks do not reach this bit in
/// 292 years.
const ABANDONED: u64 = 1 << 63;

/// An operation in progress.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct WatchedCall {
    pub(crate) since: Duration,
    pub(crate) cycle: u64,
    /// Index of the activity among those of the thread.
    pub(crate) activity: usize,
    /// The observed value.
    mark: u64,
}

impl Watchdog {
    /// Marks the start of a cycle.
    pub(crate) fn start_cycle(&self, now: Timestamp, cycle: u64) {
        self.cycle.store(cycle, Ordering::Relaxed);
        self.began.store(now.as_nanos().saturating_add(1) & !ABANDONED, Ordering::Release);
    }

    /// Marks the call of an activity.
    pub(crate) fn set_activity(&self, activity: usize) {
        self.activity.store(activity, Ordering::Relaxed);
    }

    /// Marks the end of the operation. Returns false if it was abandoned before.
    pub(crate) fn end_cycle(&self) -> bool {
        self.began.swap(0, Ordering::AcqRel) & ABANDONED == 0
    }

    /// Whether the operation was abandoned.
    pub(crate) fn is_abandoned(&self) -> bool {
        self.began.load(Ordering::Acquire) & ABANDONED != 0
    }

    /// Abandons an observed operation. Returns false if it has ended since.
    pub(crate) fn abandon(&self, under_way: WatchedCall) -> bool {
        let mark = under_way.mark;
        self.began.compare_exchange(mark, mark | ABANDONED, Ordering::AcqRel, Ordering::Acquire).is_ok()
    }

    /// The operation in progress, if any.
    pub(crate) fn current_call(&self, now: Timestamp) -> Option<WatchedCall> {
        let mark = self.began.load(Ordering::Acquire);
        let began = (mark & !ABANDONED).checked_sub(1)?;
        Some(WatchedCall {
            since: now.since(Timestamp::from_nanos(began)),
            cycle: self.cycle.load(Ordering::Relaxed),
            activity: self.activity.load(Ordering::Relaxed),
            mark,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn running_calls_are_reported_until_they_end() {
        let pulse = Watchdog::default();
        assert_eq!(pulse.current_call(Timestamp::from_nanos(5)), None);
        pulse.start_cycle(Timestamp::ZERO, 7);
        pulse.set_activity(2);
        let seen = pulse.current_call(Timestamp::from_nanos(5)).unwrap();
        assert_eq!((seen.since, seen.cycle, seen.activity), (Duration::from_nanos(5), 7, 2));
        assert!(pulse.abandon(seen) && pulse.is_abandoned());
        let again = pulse.current_call(Timestamp::from_nanos(6)).unwrap();
        assert_eq!((again.since, again.cycle), (Duration::from_nanos(6), 7));
        assert!(pulse.abandon(again), "it stays given up");
        assert!(!pulse.end_cycle());
        assert_eq!(pulse.current_call(Timestamp::from_nanos(9)), None);
        pulse.start_cycle(Timestamp::ZERO, 8);
        assert!(!pulse.is_abandoned(), "what is given up is one cycle");
    }

    #[test]
    fn a_call_that_ended_meanwhile_is_not_abandoned() {
        let pulse = Watchdog::default();
        pulse.start_cycle(Timestamp::ZERO, 1);
        let seen = pulse.current_call(Timestamp::from_nanos(5)).unwrap();
        assert!(pulse.end_cycle());
        assert!(!pulse.abandon(seen));
        pulse.start_cycle(Timestamp::from_nanos(6), 2);
        assert!(!pulse.abandon(seen));
        assert!(!pulse.is_abandoned() && pulse.end_cycle());
    }
}
