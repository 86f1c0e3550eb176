//! Machines are inspected, captured and restored: by micro-step, by name, and as text.

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)] // the functions around the tests are tests too

mod editing;
mod every_step;
mod fixture;
mod micro_steps;
mod misfits;
mod profiles;
