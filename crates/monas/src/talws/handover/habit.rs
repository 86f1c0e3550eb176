//! How long somebody usually waits, and how long he therefore looks for what he waits for before he sleeps.
//!
//! Waking a thread that sleeps takes tens of microseconds, an activity that does little a fraction of one. Whoever sleeps through each
//! call of such an activity spends nearly all his time on waking up; whoever never sleeps takes a core from the others. So one who
//! waits looks out for longer as long as what he waited for came soon, and hardly at all otherwise: after one long rest he sleeps at
//! once again. That holds for a busy machine too, where letting others go first costs a long time: then the waits become long.

use std::sync::atomic::{AtomicU64, Ordering};

use super::primitives::Primitives;

/// About as long as it takes to wake a thread, in nanoseconds. It is not worth while to look out for longer.
const WAKING: u64 = 50_000;

/// How long one looks out who usually waits for longer, in nanoseconds.
const BRIEFLY: u64 = 2_000;

/// What a wait counts at most, in nanoseconds, so that a single one does not count for many.
const MOST: u64 = 4 * WAKING;

/// The usual length of the waits of one thread, or of several that wait for the same. It is a hint: who changes it last is right.
pub(super) struct Habit {
    usual: AtomicU64,
}

/// A wait that goes on, with the time at which it began.
pub(super) struct Wait(u64);

impl Habit {
    pub(super) fn new() -> Habit {
        Habit { usual: AtomicU64::new(WAKING) }
    }

    /// Begins to wait: looks out until it is worth it, for at most so many nanoseconds.
    pub(super) fn linger<P: Primitives>(&self, at_most: u64, worth: impl Fn() -> bool) -> Wait {
        let wait = Wait(P::nanos());
        let usual = self.usual.load(Ordering::Relaxed);
        let limit = if usual < WAKING { WAKING } else { BRIEFLY }.min(at_most);
        P::look_out(limit, worth);
        wait
    }

    /// The wait is over.
    pub(super) fn waited<P: Primitives>(&self, wait: &Wait) {
        let took = P::nanos().saturating_sub(wait.0).min(MOST);
        let usual = self.usual.load(Ordering::Relaxed);
        self.usual.store((3 * usual + took) / 4, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::sync::atomic::AtomicBool;

    use super::super::primitives::ThreadMonitor;
    use super::*;

    thread_local! {
        static NOW: Cell<u64> = const { Cell::new(0) };
        static LOOKED_OUT: Cell<u64> = const { Cell::new(0) };
    }

    /// A clock that is set by hand, and notes of who looked out for how long.
    struct ByHand;

    impl Primitives for ByHand {
        type Monitor<T: Send + 'static> = ThreadMonitor<T>;
        type Flag = AtomicBool;

        fn nanos() -> u64 {
            NOW.get()
        }

        fn look_out(at_most: u64, _: impl Fn() -> bool) {
            LOOKED_OUT.set(at_most);
        }
    }

    /// How long one looks out in waits of these lengths.
    fn looked_out(habit: &Habit, waits: &[u64]) -> Vec<u64> {
        let look_out = |&took: &u64| {
            let wait = habit.linger::<ByHand>(u64::MAX, || false);
            NOW.set(NOW.get() + took);
            habit.waited::<ByHand>(&wait);
            LOOKED_OUT.get()
        };
        waits.iter().map(look_out).collect()
    }

    #[test]
    fn who_waits_briefly_looks_out_and_who_rests_sleeps() {
        let habit = Habit::new();
        assert_eq!(looked_out(&habit, &[1_000, 1_000]), [BRIEFLY, WAKING]);
        let hour = 3_600_000_000_000;
        let waits = [hour, 1_000, 1_000, 1_000, hour, hour];
        assert_eq!(looked_out(&habit, &waits), [WAKING, BRIEFLY, BRIEFLY, WAKING, WAKING, BRIEFLY]);
        // a few short ones, and the rests are forgotten
        let last = looked_out(&habit, &[1_000; 6]).pop();
        assert_eq!(last, Some(WAKING));
    }

    #[test]
    fn nobody_looks_out_for_longer_than_there_is_time() {
        Habit::new().linger::<ByHand>(300, || false);
        assert_eq!(LOOKED_OUT.get(), 300);
    }
}
