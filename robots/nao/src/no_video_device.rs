//! Platforms without Video4Linux: no camera can be opened.

use std::convert::Infallible;
use std::io::{Error, ErrorKind, Result};
use std::path::Path;
use std::time::Duration;

use crate::camera_thread::FrameSource;
use crate::frame::Frame;

/// A camera; no value of this type exists.
pub(crate) struct VideoDevice(Infallible);

impl VideoDevice {
    pub(crate) fn open(_: &Path) -> Result<VideoDevice> {
        Err(Error::new(ErrorKind::Unsupported, "cameras need Linux on a processor with 64 bits"))
    }

    pub(crate) fn stream(self, _: bool) -> Result<VideoStream> {
        match self.0 {}
    }
}

/// A camera that takes images; no value of this type exists.
pub(crate) struct VideoStream(Infallible);

impl FrameSource for VideoStream {
    fn next_frame(&mut self, _: Duration) -> Result<Option<Frame>> {
        match self.0 {}
    }
}
