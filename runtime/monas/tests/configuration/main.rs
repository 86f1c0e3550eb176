//! Configurations: listings of the thesis, XML, TOML, layers, schemas, and editing of files.
#![allow(clippy::unwrap_used, clippy::panic)] // a test may fail

mod agents;
mod files;
#[path = "../kit/mod.rs"]
mod kit;
mod layers;
mod links;
mod toml;
mod xml;
