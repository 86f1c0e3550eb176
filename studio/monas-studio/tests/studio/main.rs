//! The studio over real sockets.

#![allow(clippy::panic, clippy::unwrap_used)] // a test may fail

#[cfg(unix)]
mod control;
mod kit;
#[cfg(unix)]
mod models;
#[cfg(unix)]
mod run;
mod tape;
