//! What the hand-over is made of: a lock with a place to sleep, and a flag. Threads have one kind of them, the checker another.

use std::hint;
use std::ops::DerefMut;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// One kind of primitives.
pub(in crate::talws) trait Primitives: 'static {
    /// A lock with a place to sleep.
    type Monitor<T: Send + 'static>: Monitor<T>;
    /// A flag.
    type Flag: Flag;

    /// Looks again and again for a short while whether it is worth it. What comes of it is a hint.
    fn linger(worth: impl Fn() -> bool);
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

/// The primitives of the standard library.
pub(in crate::talws) struct Threads;

/// So many rounds somebody who has nothing to do looks for something before he sleeps, each twice as long as the one before: a few
/// microseconds. Waking a thread that sleeps takes several times as long, and whoever has just handed out an activity that does little has
/// it back by then. He does not yield: on a busy machine that puts him behind all others, while one who sleeps is woken at once.
const ROUNDS: u32 = 7;

impl Primitives for Threads {
    type Monitor<T: Send + 'static> = ThreadMonitor<T>;
    type Flag = AtomicBool;

    fn linger(worth: impl Fn() -> bool) {
        for round in 0..ROUNDS {
            if worth() {
                return;
            }
            (0..1 << round).for_each(|_| hint::spin_loop());
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
