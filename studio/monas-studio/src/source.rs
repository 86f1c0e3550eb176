//! The sources of a studio's view.

#[cfg(unix)]
use std::sync::Arc;
use std::time::Duration;

use serde_json::Value;

#[cfg(unix)]
use crate::live_state::LiveState;
use crate::viewer_request::ViewerRequest;

/// A run or a tape that viewers can open.
pub(crate) trait Source: Send + Sync {
    /// A view for one viewer.
    fn open(&self) -> Box<dyn Session>;

    /// Whether viewers may change it.
    fn allows_control(&self) -> bool {
        false
    }

    /// The run for third-party viewers, if the source is a run.
    #[cfg(unix)]
    fn live_state(&self) -> Option<Arc<LiveState>> {
        None
    }
}

/// The view of one viewer.
pub(crate) trait Session: Send {
    /// Handles a request. Returns the reply, if it has one.
    fn handle(&mut self, request: ViewerRequest) -> Option<Value>;

    /// The changes that the viewer has not seen; `elapsed` is the time since the last call.
    fn frame(&mut self, elapsed: Duration) -> Option<Value>;
}
