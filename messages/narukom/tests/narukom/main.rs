//! Hubs, blackboards and their promises.
#![allow(clippy::unwrap_used)] // tests

mod bounds;
mod cycle;
mod erased;
mod hosts;
mod hub;
mod interleavings;
mod keeping;
#[path = "../messages/mod.rs"]
mod messages;
mod regions;
mod timing;
