//! The built command as a person or a program meets it.

#![allow(clippy::expect_used, reason = "a test that cannot be prepared fails")]

mod kit;
mod model;
mod run;
mod usage;
