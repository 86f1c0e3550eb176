//! The wall clock: measures the duration of a run, and paces simulated time.

use std::time::{Duration, Instant};

use crate::Interrupt;

/// The longest sleep before the interrupt is checked.
const LOOK_UP: Duration = Duration::from_millis(50);

/// A clock that starts at zero.
#[derive(Clone, Copy, Debug)]
pub struct WallClock(Instant);

impl WallClock {
    /// Starts at zero.
    #[expect(
        clippy::disallowed_methods,
        reason = "the command line paces simulated time and reports its speed"
    )]
    pub fn start() -> WallClock {
        WallClock(Instant::now())
    }

    /// The time since the start.
    pub fn elapsed(&self) -> Duration {
        self.0.elapsed()
    }

    /// Waits until this time, or until an interrupt.
    pub fn wait_until(&self, time: Duration, interrupt: &Interrupt) {
        self.wait_until_or(time, || interrupt.is_requested());
    }

    /// Waits until this time, or until `is_over`.
    #[expect(clippy::disallowed_methods, reason = "simulated time is paced by the wall clock for watchers")]
    pub fn wait_until_or(&self, time: Duration, mut is_over: impl FnMut() -> bool) {
        while !is_over() {
            match time.checked_sub(self.elapsed()) {
                None | Some(Duration::ZERO) => return,
                Some(left) => std::thread::sleep(left.min(LOOK_UP)),
            }
        }
    }
}
