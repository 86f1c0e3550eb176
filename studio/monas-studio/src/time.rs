//! The wall clock, which paces what is sent to viewers and the playing of tapes.

use std::time::Instant;

/// The present time.
#[expect(clippy::disallowed_methods, reason = "frames and the playing of tapes are paced for viewers")]
pub(crate) fn now() -> Instant {
    Instant::now()
}
