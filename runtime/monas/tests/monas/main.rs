//! The runtime as its users see it: agents, charts, configurations, changes at run time, replays.
#![allow(clippy::unwrap_used, clippy::panic)] // a test may fail

mod changes;
mod charts;
mod configuration;
mod failures;
mod generated;
mod kit;
mod locks;
mod management;
mod measured;
mod panics;
mod pool;
mod real_time;
mod simulation;
mod stalls;
mod taped;
