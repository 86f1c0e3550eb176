//! Statecharts as Rust crates: folders of files to be read, and names that are mapped one to one.

#![allow(clippy::expect_used, clippy::panic)] // the functions around the tests are tests too

mod build;
mod golden;
mod names;
mod refusals;
mod words;
