//! The field and its rules, robots of any kind on it, and what the cameras see.
#![allow(clippy::unwrap_used)] // tests

mod any_commands;
mod camera_dials;
mod common;
mod determinism;
mod latency;
mod league;
mod matches;
mod play;
mod rules;
