//! Migration of a running machine to a changed chart.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

mod history;
mod refusals;
mod same;
mod stage;
mod verdicts;
