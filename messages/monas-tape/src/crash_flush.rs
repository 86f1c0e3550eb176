//! Flushing a tape from a crash handler.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// The states of a request; 0 is none.
const REQUESTED: u8 = 1;
const DONE: u8 = 2;

/// Has the thread of a [`Tape`](crate::Tape) close its chunk while another thread is held in a
/// crash handler, so that the tape reaches up to the crash.
///
/// [`request`](CrashFlush::request) and [`is_done`](CrashFlush::is_done) neither allocate nor take
/// a lock: a signal handler may call them. The thread looks at requests every 10 ms; it does not
/// answer if it has crashed itself.
#[derive(Clone, Debug, Default)]
pub struct CrashFlush(Arc<AtomicU8>);

impl CrashFlush {
    /// Requests the flush.
    pub fn request(&self) {
        self.0.store(REQUESTED, Ordering::Release);
    }

    /// Whether the last request was answered.
    pub fn is_done(&self) -> bool {
        self.0.load(Ordering::Acquire) == DONE
    }

    /// Whether a request waits. The writer asks before it takes the messages of its queue, so that
    /// it flushes all that were published before the request.
    pub(crate) fn is_requested(&self) -> bool {
        self.0.load(Ordering::Acquire) == REQUESTED
    }

    pub(crate) fn answer(&self) {
        self.0.store(DONE, Ordering::Release);
    }
}
