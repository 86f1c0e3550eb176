//! What a thread is doing, for whoever looks whether it still does anything.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use narukom::Moment;

/// Set by a thread when it begins something that ends soon, looked at by the supervisor.
///
/// When it began and whether it was given up are one number, so that what is given up is what was looked at: a cycle that has ended meanwhile has
/// ended well, and the one after it is none of it.
#[derive(Default)]
pub(crate) struct Pulse {
    /// When it began, in nanoseconds and one, and perhaps [`CUT`]; 0 if nothing is under way.
    began: AtomicU64,
    cycle: AtomicU64,
    activity: AtomicUsize,
}

/// Marks what was given up: nothing that it does is published. Clocks do not come so far in 292 years.
const CUT: u64 = 1 << 63;

/// Something that goes on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct UnderWay {
    pub(super) since: Duration,
    pub(super) cycle: u64,
    /// The place of the activity among those of the thread.
    pub(super) activity: usize,
    /// What was looked at.
    mark: u64,
}

impl Pulse {
    /// A cycle begins.
    pub(super) fn begins(&self, now: Moment, cycle: u64) {
        self.cycle.store(cycle, Ordering::Relaxed);
        self.began.store(now.as_nanos().saturating_add(1) & !CUT, Ordering::Release);
    }

    /// An activity is called.
    pub(crate) fn calls(&self, activity: usize) {
        self.activity.store(activity, Ordering::Relaxed);
    }

    /// What began has ended. False if it was given up before.
    pub(crate) fn ends(&self) -> bool {
        self.began.swap(0, Ordering::AcqRel) & CUT == 0
    }

    /// Whether it was given up.
    pub(crate) fn is_cut(&self) -> bool {
        self.began.load(Ordering::Acquire) & CUT != 0
    }

    /// Gives up what was looked at. False if it has ended since.
    pub(super) fn cut_off(&self, under_way: UnderWay) -> bool {
        let mark = under_way.mark;
        self.began.compare_exchange(mark, mark | CUT, Ordering::AcqRel, Ordering::Acquire).is_ok()
    }

    /// What goes on, if anything does.
    pub(super) fn under_way(&self, now: Moment) -> Option<UnderWay> {
        let mark = self.began.load(Ordering::Acquire);
        let began = (mark & !CUT).checked_sub(1)?;
        Some(UnderWay {
            since: now.since(Moment::from_nanos(began)),
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
    fn what_is_under_way_is_told_until_it_ends() {
        let pulse = Pulse::default();
        assert_eq!(pulse.under_way(Moment::from_nanos(5)), None);
        pulse.begins(Moment::ZERO, 7);
        pulse.calls(2);
        let seen = pulse.under_way(Moment::from_nanos(5)).unwrap();
        assert_eq!((seen.since, seen.cycle, seen.activity), (Duration::from_nanos(5), 7, 2));
        assert!(pulse.cut_off(seen) && pulse.is_cut());
        let again = pulse.under_way(Moment::from_nanos(6)).unwrap();
        assert_eq!((again.since, again.cycle), (Duration::from_nanos(6), 7));
        assert!(pulse.cut_off(again), "it stays given up");
        assert!(!pulse.ends());
        assert_eq!(pulse.under_way(Moment::from_nanos(9)), None);
        pulse.begins(Moment::ZERO, 8);
        assert!(!pulse.is_cut(), "what is given up is one cycle");
    }

    #[test]
    fn what_has_ended_since_it_was_looked_at_is_not_given_up_nor_what_came_after_it() {
        let pulse = Pulse::default();
        pulse.begins(Moment::ZERO, 1);
        let seen = pulse.under_way(Moment::from_nanos(5)).unwrap();
        assert!(pulse.ends());
        assert!(!pulse.cut_off(seen));
        pulse.begins(Moment::from_nanos(6), 2);
        assert!(!pulse.cut_off(seen));
        assert!(!pulse.is_cut() && pulse.ends());
    }
}
