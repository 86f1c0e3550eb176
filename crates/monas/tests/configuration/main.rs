//! Configurations: what the thesis writes, XML, TOML, layers, schemas, and files that are changed in place.
#![allow(clippy::unwrap_used, clippy::panic)] // a test may fail

mod agents;
mod files;
#[path = "../kit/mod.rs"]
mod kit;
mod layers;
mod links;
mod toml;
mod xml;
