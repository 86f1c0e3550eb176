//! What ends a run from outside, and what those who wait for their time wait on.

use std::sync::{Arc, Condvar, Mutex, PoisonError};

use narukom::Moment;

use super::clock::Clock;

/// Ends a run; clones end the same one. A signal handler may hold one.
#[derive(Clone, Debug, Default)]
pub struct Stopper {
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    stopped: Mutex<bool>,
    changed: Condvar,
    /// What is called when the run is to end, for those who do not wait here.
    bells: Mutex<Vec<Bell>>,
}

type Bell = Box<dyn Fn() + Send + Sync>;

impl std::fmt::Debug for Shared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shared").field("stopped", &self.stopped).finish_non_exhaustive()
    }
}

impl Stopper {
    /// A stopper for a run that has not begun.
    pub fn new() -> Stopper {
        Stopper::default()
    }

    /// Ends the run: agents finish the cycle they are in.
    pub fn stop(&self) {
        *self.shared.stopped.lock().unwrap_or_else(PoisonError::into_inner) = true;
        self.shared.changed.notify_all();
        self.shared.bells.lock().unwrap_or_else(PoisonError::into_inner).iter().for_each(|ring| ring());
    }

    /// Calls `bell` when the run is to end.
    pub(super) fn on_stop(&self, bell: Bell) {
        self.shared.bells.lock().unwrap_or_else(PoisonError::into_inner).push(bell);
    }

    /// Whether the run is to end.
    pub fn is_stopped(&self) -> bool {
        *self.shared.stopped.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until the run is to end.
    pub(super) fn wait(&self) {
        let stopped = self.shared.stopped.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.shared.changed.wait_while(stopped, |stopped| !*stopped);
        drop(waited.unwrap_or_else(PoisonError::into_inner));
    }

    /// Waits until a moment comes; false if the run is to end first.
    pub(super) fn wait_until(&self, moment: Moment, clock: &Clock) -> bool {
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
