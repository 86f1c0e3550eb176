//! Generated crates and the mapping of names.

#![allow(clippy::expect_used, clippy::panic)] // the functions around the tests are tests too

mod build;
mod golden;
mod names;
mod refusals;
mod words;
