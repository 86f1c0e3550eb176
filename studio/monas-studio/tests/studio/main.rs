//! The studio over real sockets.

#![allow(clippy::panic, clippy::unwrap_used)] // a test may fail

mod kit;
#[cfg(unix)]
mod run;
mod tape;
