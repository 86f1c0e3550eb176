//! The wall clock: how long a run took, and holding simulated time back to it.

use std::time::{Duration, Instant};

use super::interrupt::Interrupt;

/// Whoever waits looks up this often.
const LOOK_UP: Duration = Duration::from_millis(50);

/// A clock that starts at zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallClock(Instant);

impl WallClock {
    /// Starts it.
    #[expect(
        clippy::disallowed_methods,
        reason = "the command line paces simulated time and reports its speed"
    )]
    pub(crate) fn start() -> WallClock {
        WallClock(Instant::now())
    }

    /// The time since it was started.
    pub(crate) fn elapsed(&self) -> Duration {
        self.0.elapsed()
    }

    /// Waits until it shows `time`, or until somebody interrupts.
    pub(crate) fn wait_until(&self, time: Duration, interrupt: &Interrupt) {
        self.wait_until_or(time, || interrupt.is_requested());
    }

    /// Waits until it shows `time`, or until something else is so.
    #[expect(
        clippy::disallowed_methods,
        reason = "simulated time is held back to the wall clock for those who watch"
    )]
    pub(crate) fn wait_until_or(&self, time: Duration, is_over: impl Fn() -> bool) {
        while !is_over() {
            match time.checked_sub(self.elapsed()) {
                None | Some(Duration::ZERO) => return,
                Some(left) => std::thread::sleep(left.min(LOOK_UP)),
            }
        }
    }
}
