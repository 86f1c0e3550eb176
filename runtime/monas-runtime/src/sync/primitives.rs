//! Primitives of the hand-over: a lock with a condition variable, and a flag. Threads and the
//! checker have separate implementations.

use std::hint;
use std::ops::DerefMut;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// A family of primitives.
pub(crate) trait Primitives: 'static {
    /// A lock with a condition variable.
    type Monitor<T: Send + 'static>: Monitor<T>;
    /// A flag.
    type Flag: Flag;

    /// The present time, in nanoseconds.
    fn nanos() -> u64;
    /// Polls `worth` until it holds, for at most `at_most` nanoseconds. The result is a hint.
    fn spin(at_most: u64, worth: impl Fn() -> bool);
}

/// A lock around a value, with a condition variable for its changes.
pub(crate) trait Monitor<T>: Send + Sync {
    /// Holds the lock.
    type Guard<'a>: DerefMut<Target = T>
    where
        Self: 'a;

    fn new(value: T) -> Self;
    fn lock(&self) -> Self::Guard<'_>;
    /// Releases the lock and sleeps until a wake-up, a timeout, or a spurious wake-up.
    fn sleep<'a>(&'a self, guard: Self::Guard<'a>, at_most: Option<Duration>) -> Self::Guard<'a>;
    fn wake_one(&self);
    fn wake_all(&self);
}

/// A boolean that any thread may access.
pub(crate) trait Flag: Send + Sync {
    fn new() -> Self;
    fn is_set(&self) -> bool;
    fn set(&self, value: bool);
    /// Sets it and returns the previous value.
    fn raise(&self) -> bool;
}

/// Spin time after which the thread yields the processor, in nanoseconds: the awaited work may be
/// on the same core.
const YIELD_AFTER: u64 = 2_000;

thread_local! {
    /// The same for this thread: zero if it has a single core, where the awaited work is certainly
    /// on the same core.
    static ALONE_HERE: u64 = match thread::available_parallelism() {
        Ok(cores) if cores.get() == 1 => 0,
        _ => YIELD_AFTER,
    };
}

/// The primitives of the standard library.
pub(crate) struct Threads;

impl Primitives for Threads {
    type Monitor<T: Send + 'static> = ThreadMonitor<T>;
    type Flag = AtomicBool;

    #[expect(clippy::disallowed_methods, reason = "sleep times are internal to the runtime")]
    fn nanos() -> u64 {
        static BEGIN: LazyLock<Instant> = LazyLock::new(Instant::now);
        BEGIN.elapsed().as_nanos() as u64
    }

    fn spin(at_most: u64, worth: impl Fn() -> bool) {
        let (begin, alone) = (Threads::nanos(), ALONE_HERE.with(|alone| *alone));
        while !worth() {
            match Threads::nanos().saturating_sub(begin) {
                waited if waited >= at_most => return,
                waited if waited >= alone => thread::yield_now(),
                _ => (0..8).for_each(|_| hint::spin_loop()),
            }
        }
    }
}

/// A mutex and its condition variable.
pub(crate) struct ThreadMonitor<T> {
    value: Mutex<T>,
    changed: Condvar,
}

/// No user code runs under these locks and their own code does not panic, so a poisoned lock is
/// still consistent.
impl<T: Send> Monitor<T> for ThreadMonitor<T> {
    type Guard<'a>
        = MutexGuard<'a, T>
    where
        Self: 'a;

    fn new(value: T) -> ThreadMonitor<T> {
        ThreadMonitor { value: Mutex::new(value), changed: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, T> {
        self.value.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn sleep<'a>(&'a self, guard: MutexGuard<'a, T>, at_most: Option<Duration>) -> MutexGuard<'a, T> {
        match at_most {
            Some(limit) => {
                let woken = self.changed.wait_timeout(guard, limit);
                woken.unwrap_or_else(PoisonError::into_inner).0
            }
            None => self.changed.wait(guard).unwrap_or_else(PoisonError::into_inner),
        }
    }

    fn wake_one(&self) {
        self.changed.notify_one();
    }

    fn wake_all(&self) {
        self.changed.notify_all();
    }
}

impl Flag for AtomicBool {
    fn new() -> AtomicBool {
        AtomicBool::new(false)
    }

    fn is_set(&self) -> bool {
        self.load(Ordering::Acquire)
    }

    fn set(&self, value: bool) {
        self.store(value, Ordering::Release);
    }

    fn raise(&self) -> bool {
        self.swap(true, Ordering::SeqCst)
    }
}
