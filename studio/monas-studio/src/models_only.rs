//! A studio without a run: its pages edit models.

use std::time::Duration;

use serde_json::Value;

use crate::source::{Session, Source};
use crate::viewer_request::ViewerRequest;

/// Has no run and no tape.
pub(crate) struct ModelsOnly;

impl Source for ModelsOnly {
    fn open(&self) -> Box<dyn Session> {
        Box::new(ModelsOnly)
    }
}

impl Session for ModelsOnly {
    fn handle(&mut self, _: ViewerRequest) -> Option<Value> {
        None
    }

    fn frame(&mut self, _: Duration) -> Option<Value> {
        None
    }
}
