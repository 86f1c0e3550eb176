//! What a thread is doing, for whoever looks whether it still does anything.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use narukom::Moment;

/// Set by a thread when it begins something that ends soon, looked at by the supervisor.
#[derive(Default)]
pub(crate) struct Pulse {
    /// When it began, in nanoseconds and one; 0 if nothing is under way.
    began: AtomicU64,
    cycle: AtomicU64,
    activity: AtomicUsize,
    /// Whether it was given up: nothing that it does is published.
    cut: AtomicBool,
}

/// Something that goes on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct UnderWay {
    pub(super) since: Duration,
    pub(super) cycle: u64,
    /// The place of the activity among those of the thread.
    pub(super) activity: usize,
}

impl Pulse {
    /// A cycle begins.
    pub(super) fn begins(&self, now: Moment, cycle: u64) {
        self.cycle.store(cycle, Ordering::Relaxed);
        self.cut.store(false, Ordering::Relaxed);
        self.began.store(now.as_nanos().saturating_add(1), Ordering::Release);
    }

    /// An activity is called.
    pub(crate) fn calls(&self, activity: usize) {
        self.activity.store(activity, Ordering::Relaxed);
    }

    /// What began has ended.
    pub(super) fn ends(&self) {
        self.began.store(0, Ordering::Release);
    }

    /// Whether it was given up.
    pub(crate) fn is_cut(&self) -> bool {
        self.cut.load(Ordering::Acquire)
    }

    /// Gives it up.
    pub(super) fn cut_off(&self) {
        self.cut.store(true, Ordering::Release);
    }

    /// What goes on, if anything does.
    pub(super) fn under_way(&self, now: Moment) -> Option<UnderWay> {
        let began = self.began.load(Ordering::Acquire).checked_sub(1)?;
        Some(UnderWay {
            since: now.since(Moment::from_nanos(began)),
            cycle: self.cycle.load(Ordering::Relaxed),
            activity: self.activity.load(Ordering::Relaxed),
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
        let expected = UnderWay { since: Duration::from_nanos(5), cycle: 7, activity: 2 };
        assert_eq!(pulse.under_way(Moment::from_nanos(5)), Some(expected));
        pulse.cut_off();
        assert!(pulse.is_cut());
        pulse.ends();
        assert_eq!(pulse.under_way(Moment::from_nanos(9)), None);
        pulse.begins(Moment::ZERO, 8);
        assert!(!pulse.is_cut(), "what is given up is one cycle");
    }
}
