//! Measurement of the calls of activities, the same in simulated and in real time.

use std::time::Duration;

use monas_core::chart_runner::{ActivityCall, CallTiming, FinishedCall};
use monas_core::statistics::Timing;
use narukom::Timestamp;

use super::clock::{CPU_EVERY, RunClock, cpu_time};

/// Calls activities on one thread. With a clock it measures them, and accounts the memory that they
/// allocate. A run in simulated time has a clock only if its caller asks for measurements; they
/// never reach an agent or a topic.
#[derive(Default)]
pub(crate) struct CallMeter {
    clock: Option<RunClock>,
    /// The end of the last operation. One reading of the clock ends an operation and begins the
    /// next.
    last_time: Timestamp,
}

impl CallMeter {
    /// A meter with this clock; without one, it measures nothing.
    pub(crate) fn new(clock: Option<RunClock>) -> CallMeter {
        CallMeter { clock, ..CallMeter::default() }
    }

    /// Marks the start of the next operation.
    pub(crate) fn begin(&mut self) {
        if let Some(clock) = &self.clock {
            self.last_time = clock.now();
        }
    }

    /// The time since the last operation has ended; `None` without a clock.
    pub(crate) fn lap(&mut self) -> Option<Duration> {
        let now = self.clock.as_ref()?.now();
        let began = std::mem::replace(&mut self.last_time, now);
        Some(now.since(began))
    }

    /// Calls an activity.
    pub(crate) fn call(&mut self, call: ActivityCall) -> FinishedCall {
        if self.clock.is_none() {
            return call.run();
        }
        let cpu = if call.number % CPU_EVERY == 1 { cpu_time() } else { None };
        let finished = call.run_with_memory_account();
        let cpu = cpu
            .and_then(|before| Some((before, cpu_time()?)))
            .map(|(before, after)| after.saturating_sub(before));
        let timing = self.lap().map(|wall| CallTiming { wall, cpu });
        FinishedCall { timing, ..finished }
    }

    /// Adds the operation that has just ended to a statistic.
    pub(crate) fn measure(&mut self, timing: &mut Timing) {
        if let Some(wall) = self.lap() {
            timing.add(wall, None);
        }
    }
}
