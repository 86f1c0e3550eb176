//! Cooperative cancellation of the activity that uses a blackboard.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Cancellation token of the activity that uses a blackboard, for use from any thread. Clones refer
/// to the same blackboard.
///
/// Cancellation is cooperative: the activity polls
/// [`Blackboard::is_cancelled`](crate::Blackboard::is_cancelled).
#[derive(Clone, Debug, Default)]
pub struct Cancellation {
    requested: Arc<AtomicBool>,
}

impl Cancellation {
    /// Requests cancellation.
    pub fn request(&self) {
        self.requested.store(true, Ordering::Release);
    }

    /// Withdraws the request, for the next activity that uses the blackboard.
    pub fn withdraw(&self) {
        self.requested.store(false, Ordering::Release);
    }

    /// Whether cancellation is requested.
    pub fn is_requested(&self) -> bool {
        self.requested.load(Ordering::Acquire)
    }
}
