//! The speed of simulated time.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Seconds of simulated time that pass in a second, shared between a run and its viewers.
///
/// It is not part of the run: the same seed gives the same messages at any pace.
///
/// ```
/// let pace = monas_studio::Pace::new(1.0);
/// let viewer = pace.clone();
/// assert!(viewer.set(0.5) && !viewer.set(-1.0) && !viewer.set(f64::NAN));
/// assert_eq!(pace.factor(), 0.5);
/// ```
#[derive(Clone, Debug)]
pub struct Pace(Arc<AtomicU64>);

impl Pace {
    /// A pace of `factor`: 1 for real time, 0 to hold, infinite for as fast as possible.
    pub fn new(factor: f64) -> Pace {
        Pace(Arc::new(AtomicU64::new(factor.to_bits())))
    }

    /// The factor.
    pub fn factor(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }

    /// Changes the factor, unless it is negative or no number. Returns whether it is accepted.
    pub fn set(&self, factor: f64) -> bool {
        let is_accepted = factor >= 0.0;
        if is_accepted {
            self.0.store(factor.to_bits(), Ordering::Relaxed);
        }
        is_accepted
    }
}
