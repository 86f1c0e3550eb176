//! Each check on a model with the fault and on a similar model without it.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the functions around tests are tests too"
)]

mod allocation;
mod cases;
mod composition;
mod counterexamples;
mod large;
mod logic;
mod properties;
mod property_language;
mod protocol;
mod several_protocols;
mod shared;
mod size;
mod speed;
mod traces;
