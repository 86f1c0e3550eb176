//! A running machine takes a changed chart.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

#[path = "../kit/mod.rs"]
mod kit;
#[path = "../kit/random.rs"]
mod random;

mod history;
mod refusals;
mod same;
mod verdicts;
mod world;
