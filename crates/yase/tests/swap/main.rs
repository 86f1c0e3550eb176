//! A running machine takes a changed chart.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

#[path = "../kit/mod.rs"]
mod kit;
#[path = "../reference/oracle/mod.rs"]
#[allow(dead_code)] // charts are made, but nothing is compared with the reference
mod oracle;

mod history;
mod refusals;
mod same;
mod verdicts;
mod world;
