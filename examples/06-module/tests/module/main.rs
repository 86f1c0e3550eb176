//! Tests of the module: loaded into agents in simulated time, and into the running program.

#![allow(clippy::expect_used, clippy::panic, reason = "a test that cannot be prepared fails")]

mod built;
#[path = "../../../../cli/monas-cli/tests/command/copying.rs"]
mod copying;
mod kit;
mod live;
#[path = "../../../../cli/monas-cli/tests/command/reading.rs"]
#[allow(dead_code, reason = "the chapters of the command use more of it")]
mod reading;
#[path = "../../../../cli/monas-cli/tests/command/running.rs"]
#[allow(dead_code, reason = "the tests of the command use more of it")]
mod running;
mod simulated;
