//! Tapes: recorded, read, truncated, recovered, cut, merged.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on fails")]

mod ball;
mod cut;
mod edit;
mod killed;
mod python;
mod recording;
