//! What a machine is doing, looked at, kept and brought back: one micro-step at a time, by name, and as text.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

#[path = "../kit/mod.rs"]
mod kit;
#[path = "../reference/oracle/mod.rs"]
#[allow(dead_code)] // charts are made, but nothing is compared with the reference
mod oracle;

mod editing;
mod every_step;
mod micro_steps;
mod misfits;
mod profiles;
mod stage;
