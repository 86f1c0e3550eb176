//! The only clock: wall time since the run began, or since that of another process did.

use std::time::{Duration, Instant};

use narukom::Moment;

/// Reading the processor's time takes long, so it is read for one cycle or call in so many.
pub(crate) const CPU_EVERY: u64 = 64;

/// How long the processor has worked for this thread, where the system tells.
#[cfg(unix)]
pub(crate) fn cpu_time() -> Option<Duration> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::try_from(time).ok()
}

/// How long the processor has worked for this thread, where the system tells.
#[cfg(not(unix))]
pub(crate) fn cpu_time() -> Option<Duration> {
    None
}

/// Tells how long a run has lasted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    start: Instant,
    /// What it showed then.
    begin: Moment,
}

impl Clock {
    /// A clock that begins now.
    #[expect(clippy::disallowed_methods, reason = "the runtime is who hands time in")]
    pub(crate) fn start() -> Clock {
        Clock { start: Instant::now(), begin: Moment::ZERO }
    }

    /// The clock that is so many nanoseconds ahead of this one.
    pub(crate) fn ahead_by(self, nanos: i64) -> Clock {
        let now = self.now().as_nanos().saturating_add_signed(nanos);
        Clock { begin: Moment::from_nanos(now), ..Clock::start() }
    }

    /// The moment at which the run begins.
    pub(crate) fn begin(&self) -> Moment {
        self.begin
    }

    /// The moment it is.
    pub(crate) fn now(&self) -> Moment {
        self.begin + self.start.elapsed()
    }
}
