//! Simulated time, paced by the wall clock.

use std::time::Duration;

use monas_studio::Pace;
use monas_terminal::{Interrupt, WallClock};

use super::RunArguments;

/// The longest wait before a run handles requests.
const MAX_WAIT: Duration = Duration::from_millis(50);

/// Keeps simulated time from running ahead of a pace, which may change meanwhile.
pub(super) struct Pacer {
    clock: WallClock,
    pace: Pace,
    /// The factor since the anchor.
    factor: f64,
    /// Wall-clock and simulated time at which the factor was set.
    anchor: (Duration, Duration),
}

impl Pacer {
    pub(super) fn new(clock: WallClock, pace: Pace) -> Pacer {
        let factor = pace.factor();
        Pacer { clock, pace, factor, anchor: (clock.elapsed(), Duration::ZERO) }
    }

    /// Waits until a simulated time may be passed, or until an interrupt, but no longer than
    /// [`MAX_WAIT`]. Returns whether the wait is over: a held run still handles requests.
    pub(super) fn wait(&mut self, simulated: Duration, interrupt: &Interrupt) -> bool {
        let latest = self.clock.elapsed().saturating_add(MAX_WAIT);
        loop {
            let factor = self.pace.factor();
            if factor != self.factor {
                self.factor = factor;
                self.anchor = (self.clock.elapsed(), simulated);
            }
            if factor.is_infinite() {
                return true;
            }
            let pace = &self.pace;
            let due = due(self.anchor, simulated, factor);
            self.clock.wait_until_or(due.min(latest), || interrupt.is_requested() || pace.factor() != factor);
            if interrupt.is_requested() {
                return true;
            }
            if pace.factor() == factor {
                return due <= latest;
            }
        }
    }
}

/// The pace at the beginning.
pub(super) fn factor(arguments: &RunArguments) -> f64 {
    #[cfg(unix)]
    let is_viewed = arguments.studio;
    #[cfg(not(unix))]
    let is_viewed = false;
    let unlimited = if arguments.realtime || is_viewed { 1.0 } else { f64::INFINITY };
    arguments.pace.unwrap_or(unlimited)
}

/// The wall-clock time at which a simulated time is due; with a factor of 0 it never is.
fn due((wall, begin): (Duration, Duration), simulated: Duration, factor: f64) -> Duration {
    let seconds = simulated.saturating_sub(begin).as_secs_f64() / factor;
    let length = Duration::try_from_secs_f64(seconds);
    length.ok().filter(|_| factor > 0.0).map_or(Duration::MAX, |length| wall.saturating_add(length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simulated_time_is_due_by_the_pace_since_its_change() {
        let seconds = Duration::from_secs;
        let anchor = (seconds(100), seconds(10));
        assert_eq!(due(anchor, seconds(14), 1.0), seconds(104));
        assert_eq!(due(anchor, seconds(14), 2.0), seconds(102));
        assert_eq!(due(anchor, seconds(14), 0.5), seconds(108));
        assert_eq!(due(anchor, seconds(10), 0.0), Duration::MAX);
        assert_eq!(due(anchor, seconds(14), 1e-300), Duration::MAX);
    }
}
