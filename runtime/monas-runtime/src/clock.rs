//! The clocks of a run: real time since the run began, or since the run of another process began;
//! and simulated time.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use narukom::Timestamp;

/// Interval in cycles or calls between readings of the CPU time, which are slow.
pub(crate) const CPU_EVERY: u64 = 64;

/// CPU time of the calling thread; `None` if the system does not provide it.
#[cfg(unix)]
pub fn cpu_time() -> Option<Duration> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::try_from(time).ok()
}

/// CPU time of the calling thread; `None` if the system does not provide it.
#[cfg(not(unix))]
pub fn cpu_time() -> Option<Duration> {
    None
}

/// The time since the beginning of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RunClock {
    start: Instant,
    /// The time of the run at the clock's creation.
    begin: Timestamp,
}

impl RunClock {
    /// A clock that starts now.
    #[expect(clippy::disallowed_methods, reason = "the runtime supplies the time")]
    pub(crate) fn start() -> RunClock {
        RunClock { start: Instant::now(), begin: Timestamp::ZERO }
    }

    /// A clock that is ahead of this one by a number of nanoseconds.
    pub(crate) fn ahead_by(self, nanos: i64) -> RunClock {
        let now = self.now().as_nanos().saturating_add_signed(nanos);
        RunClock { begin: Timestamp::from_nanos(now), ..RunClock::start() }
    }

    /// The time at which the run begins.
    pub(crate) fn begin(&self) -> Timestamp {
        self.begin
    }

    /// The present time.
    pub(crate) fn now(&self) -> Timestamp {
        self.begin + self.start.elapsed()
    }
}

/// The time of a simulated run, shared between threads.
#[derive(Default)]
pub(crate) struct SimulatedClock(AtomicU64);

impl SimulatedClock {
    pub(crate) fn set(&self, moment: Timestamp) {
        self.0.store(moment.as_nanos(), Ordering::Release);
    }

    pub(crate) fn get(&self) -> Timestamp {
        Timestamp::from_nanos(self.0.load(Ordering::Acquire))
    }
}
