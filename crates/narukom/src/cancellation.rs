//! The request to return soon, from whoever lent a blackboard to whoever works on it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Asks whoever works on a blackboard to return soon, from any thread. Clones speak of the same blackboard.
///
/// It is a request: [`Blackboard::is_cancelled`](crate::Blackboard::is_cancelled) shows it to those who look.
#[derive(Clone, Debug, Default)]
pub struct Cancellation {
    requested: Arc<AtomicBool>,
}

impl Cancellation {
    /// Asks.
    pub fn request(&self) {
        self.requested.store(true, Ordering::Release);
    }

    /// Takes the request back, for whoever works on the blackboard next.
    pub fn withdraw(&self) {
        self.requested.store(false, Ordering::Release);
    }

    /// Whether somebody asks.
    pub fn is_requested(&self) -> bool {
        self.requested.load(Ordering::Acquire)
    }
}
