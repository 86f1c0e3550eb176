//! A reference interpreter of statecharts, random charts, and their comparison with the machine of
//! `yase`.
//!
//! The interpreter ([`parallel::compare`] runs it) is slow and simple: it interprets the statechart
//! without compilation and shares no code with the machine. A [case](random::Case) is a chart, its
//! inputs and its semantics, all derived from its number. [`parallel::compare`] plays cases on both
//! interpreters, counts what occurred in them, and shrinks the first difference.
//!
//! The tests of the machine's rules, snapshots and migrations are in this crate, since they share
//! its test environment: [charts as text](chart()), a [`TestHost`] with blackboards and activities,
//! and timed inputs ([`Script`]).
//!
//! ```
//! use yase_reference::{chart, play};
//!
//! let lamp = chart("START\noff\non\nc/START -> off\noff -> on : button\n");
//! let log = play(&lamp, "1 button");
//! assert!(log.last().is_some_and(|line| line.contains("off -> on")), "{log:?}");
//! ```

#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "it serves tests only")]

pub mod chart;
pub mod chooser;
mod compare;
pub mod histogram;
pub mod parallel;
pub mod random;
pub mod script;
mod shrink;
mod stepper;
pub mod test_host;

pub use chart::chart;
pub use script::{ByMicroSteps, Interpreter, Script, play};
pub use test_host::TestHost;
