//! The only clock: wall time since the run began.

use std::time::Instant;

use narukom::Moment;

/// Tells how long a run has lasted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    start: Instant,
}

impl Clock {
    /// A clock that begins now.
    #[expect(clippy::disallowed_methods, reason = "the runtime is who hands time in")]
    pub(crate) fn start() -> Clock {
        Clock { start: Instant::now() }
    }

    /// The moment it is.
    pub(crate) fn now(&self) -> Moment {
        let elapsed = self.start.elapsed();
        Moment::ZERO + elapsed
    }
}
