//! Adaptive spinning: the usual length of a wait determines how long a thread spins before it
//! sleeps.
//!
//! Waking a sleeping thread takes tens of microseconds, a short activity a fraction of one. A
//! thread that sleeps during each call of such an activity spends nearly all its time on waking up;
//! one that never sleeps takes a core from the others. A waiting thread therefore spins longer
//! while its waits are short, and hardly at all otherwise: after one long wait it sleeps
//! immediately. This also holds on a busy machine, where yielding to others takes long: the waits
//! become long.

use std::sync::atomic::{AtomicU64, Ordering};

use super::primitives::Primitives;

/// Approximate time to wake a thread, in nanoseconds. Longer spinning does not pay off.
const WAKE_UP_TIME: u64 = 50_000;

/// Spin time of a thread whose waits are usually longer, in nanoseconds.
const SHORT_SPIN: u64 = 2_000;

/// Upper bound of a wait in the average, in nanoseconds, so that a single long wait does not
/// dominate.
const MAX_COUNTED_WAIT: u64 = 4 * WAKE_UP_TIME;

/// The usual length of the waits of one thread, or of several that wait for the same event. It is a
/// hint: concurrent updates may overwrite each other.
pub(crate) struct AdaptiveSpin {
    usual: AtomicU64,
}

/// A wait in progress, with the time at which it began.
pub(crate) struct Wait(u64);

impl AdaptiveSpin {
    pub(crate) fn new() -> AdaptiveSpin {
        AdaptiveSpin { usual: AtomicU64::new(WAKE_UP_TIME) }
    }

    /// Begins a wait: spins until `worth` holds, for at most `at_most` nanoseconds.
    pub(crate) fn spin_then_park<P: Primitives>(&self, at_most: u64, worth: impl Fn() -> bool) -> Wait {
        let wait = Wait(P::nanos());
        let usual = self.usual.load(Ordering::Relaxed);
        let limit = if usual < WAKE_UP_TIME { WAKE_UP_TIME } else { SHORT_SPIN }.min(at_most);
        P::spin(limit, worth);
        wait
    }

    /// Ends a wait.
    pub(crate) fn waited<P: Primitives>(&self, wait: &Wait) {
        let took = P::nanos().saturating_sub(wait.0).min(MAX_COUNTED_WAIT);
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

    /// A manually set clock that records the spin times.
    struct ByHand;

    impl Primitives for ByHand {
        type Monitor<T: Send + 'static> = ThreadMonitor<T>;
        type Flag = AtomicBool;

        fn nanos() -> u64 {
            NOW.get()
        }

        fn spin(at_most: u64, _: impl Fn() -> bool) {
            LOOKED_OUT.set(at_most);
        }
    }

    /// The spin times in waits of these lengths.
    fn looked_out(spin: &AdaptiveSpin, waits: &[u64]) -> Vec<u64> {
        let look_out = |&took: &u64| {
            let wait = spin.spin_then_park::<ByHand>(u64::MAX, || false);
            NOW.set(NOW.get() + took);
            spin.waited::<ByHand>(&wait);
            LOOKED_OUT.get()
        };
        waits.iter().map(look_out).collect()
    }

    #[test]
    fn short_waits_spin_and_long_waits_sleep() {
        let spin = AdaptiveSpin::new();
        assert_eq!(looked_out(&spin, &[1_000, 1_000]), [SHORT_SPIN, WAKE_UP_TIME]);
        let hour = 3_600_000_000_000;
        let waits = [hour, 1_000, 1_000, 1_000, hour, hour];
        assert_eq!(
            looked_out(&spin, &waits),
            [WAKE_UP_TIME, SHORT_SPIN, SHORT_SPIN, WAKE_UP_TIME, WAKE_UP_TIME, SHORT_SPIN]
        );
        // After a few short waits the long ones no longer matter.
        let last = looked_out(&spin, &[1_000; 6]).pop();
        assert_eq!(last, Some(WAKE_UP_TIME));
    }

    #[test]
    fn spinning_is_bounded_by_the_deadline() {
        AdaptiveSpin::new().spin_then_park::<ByHand>(300, || false);
        assert_eq!(LOOKED_OUT.get(), 300);
    }
}
