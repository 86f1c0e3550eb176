//! Models of all kinds: parsed, written, and converted in both directions.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "the functions around tests are tests too"
)]

mod diff;
mod edit;
mod faults;
mod generators;
mod kit;
mod regenerate;
mod round_trip;
mod shared;
mod text;
mod transformations;
mod xmi;
