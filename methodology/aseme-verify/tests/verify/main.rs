//! `aseme_verify::check`: each check on a model that has the fault, and on one that nearly has it.

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
mod speed;
mod traces;
