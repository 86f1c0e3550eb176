//! Stops a run from outside, and provides interruptible waits for its threads.

use std::sync::{Arc, Condvar, Mutex, PoisonError};

use narukom::Timestamp;

use super::clock::RunClock;

/// Ends a run; clones end the same one. May be used by a signal handler.
#[derive(Clone, Debug, Default)]
pub struct StopHandle {
    shared: Arc<StopState>,
}

#[derive(Default)]
struct StopState {
    stopped: Mutex<bool>,
    changed: Condvar,
    /// Callbacks for the end of the run, for threads that do not wait here.
    callbacks: Mutex<Vec<StopCallback>>,
}

type StopCallback = Box<dyn Fn() + Send + Sync>;

impl std::fmt::Debug for StopState {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("StopState").field("stopped", &self.stopped).finish_non_exhaustive()
    }
}

impl StopHandle {
    /// A handle for a run that has not begun.
    pub fn new() -> StopHandle {
        StopHandle::default()
    }

    /// Ends the run after the present cycles of its agents.
    pub fn stop(&self) {
        *self.shared.stopped.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.shared.changed.notify_all();
        self.shared.callbacks.lock().unwrap_or_else(PoisonError::into_inner).iter().for_each(|ring| ring());
    }

    /// Calls `bell` when the end of the run is requested.
    pub(crate) fn on_stop(&self, bell: StopCallback) {
        self.shared.callbacks.lock().unwrap_or_else(PoisonError::into_inner).push(bell);
    }

    /// Whether the end of the run was requested.
    pub fn is_stopped(&self) -> bool {
        *self.shared.stopped.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until the end of the run is requested.
    pub(crate) fn wait(&self) {
        let stopped = self.shared.stopped.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.shared.changed.wait_while(stopped, |stopped| !*stopped);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }

    /// Waits until `moment`; returns false if the end of the run is requested before.
    pub(crate) fn wait_until(&self, moment: Timestamp, clock: &RunClock) -> bool {
        let mut stopped = self.shared.stopped.lock().unwrap_or_else(PoisonError::into_inner);
        while !*stopped {
            let now = clock.now();
            if now >= moment {
                return true;
            }
            let waited = self.shared.changed.wait_timeout(stopped, moment.since(now));
            stopped = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        false
    }
}
