//! The only clock: wall time since the run began, or since that of another process did.

use std::time::Instant;

use narukom::Moment;

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
