//! What the hand-over is made of: a lock with a place to sleep, and a flag. Threads have one kind of them, the checker another.

use std::hint;
use std::ops::DerefMut;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, LazyLock, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// One kind of primitives.
pub(in crate::talws) trait Primitives: 'static {
    /// A lock with a place to sleep.
    type Monitor<T: Send + 'static>: Monitor<T>;
    /// A flag.
    type Flag: Flag;

    /// A clock, in nanoseconds.
    fn nanos() -> u64;
    /// Looks again and again whether it is worth it, for at most so many nanoseconds. What comes of it is a hint.
    fn look_out(at_most: u64, worth: impl Fn() -> bool);
}

/// A lock around a value, with a place where those sleep who wait for the value to change.
pub(in crate::talws) trait Monitor<T>: Send + Sync {
    /// Has the lock.
    type Guard<'a>: DerefMut<Target = T>
    where
        Self: 'a;

    fn new(value: T) -> Self;
    fn lock(&self) -> Self::Guard<'_>;
    /// Lets go of the lock and sleeps until somebody wakes, or the time is over, or for no reason at all.
    fn sleep<'a>(&'a self, guard: Self::Guard<'a>, at_most: Option<Duration>) -> Self::Guard<'a>;
    fn wake_one(&self);
    fn wake_all(&self);
}

/// True or false, from any thread.
pub(in crate::talws) trait Flag: Send + Sync {
    fn new() -> Self;
    fn is_set(&self) -> bool;
    fn set(&self, value: bool);
    /// Sets it, and says what it was.
    fn raise(&self) -> bool;
}

/// After so many nanoseconds whoever looks out lets others have the processor: what he waits for may be done on the very same.
const ALONE: u64 = 2_000;

thread_local! {
    /// The same for this thread: no time at all if there is one core for it, since then it surely is.
    static ALONE_HERE: u64 = match thread::available_parallelism() {
        Ok(cores) if cores.get() == 1 => 0,
        _ => ALONE,
    };
}

/// The primitives of the standard library.
pub(in crate::talws) struct Threads;

impl Primitives for Threads {
    type Monitor<T: Send + 'static> = ThreadMonitor<T>;
    type Flag = AtomicBool;

    #[expect(clippy::disallowed_methods, reason = "how long threads sleep is the runtime's own affair")]
    fn nanos() -> u64 {
        static BEGIN: LazyLock<Instant> = LazyLock::new(Instant::now);
        BEGIN.elapsed().as_nanos() as u64
    }

    fn look_out(at_most: u64, worth: impl Fn() -> bool) {
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
pub(in crate::talws) struct ThreadMonitor<T> {
    value: Mutex<T>,
    changed: Condvar,
}

/// No code of a user runs under these locks, and their own does not panic, so that a poisoned one is as good as any.
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
