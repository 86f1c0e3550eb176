//! Activities, agents, the registry of a program, and `ChartRunner`, which drives a chart of an
//! agent: what runs on every host, without threads, files, sockets or a clock.
//!
//! The software of a robot consists of **activities**: units of behaviour with one task each, plain
//! functions on a [`Blackboard`] or types that implement [`Activity`]. An [`Agent`] groups
//! activities: a list with a frequency, or a statechart that selects the running activities. The
//! [`Registry`] holds what a program registers by name with [`activity!`], [`function!`] and
//! [`statechart!`]; configurations and models use these names.
//!
//! | module | holds |
//! |---|---|
//! | [`activity`](mod@activity), [`agent`], [`parameters`], [`frequency`] | what users write |
//! | [`registry`], [`function`](mod@function), [`generated`], [`module`](mod@module) | what programs register and modules export |
//! | [`binder`], [`vocabulary`], [`unreachable_sources`] | binds a chart to a program and checks it |
//! | [`chart_runner`], [`call`] | drives one chart: the trait `ChartDriver`, activity slots, blackboards |
//! | [`monitors`], [`coverage`], [`listener`], [`statistics`], [`records`] | observation |
//! | [`scenario`] | charts executed against scripted messages |
//!
//! Programs use the crate `monas`, which re-exports the items of this one. The crates beside this
//! one add what needs the system: `monas-config` reads files, `monas-log` writes them,
//! `monas-module` loads shared objects, `monas-runtime` has the threads and the clock.
//!
//! ```
//! use monas_core::{Activity, Agent, Blackboard, Hz, Registry};
//!
//! fn hello(blackboard: &mut Blackboard) {
//!     println!("hello at {}", blackboard.now());
//! }
//! monas_core::activity!(fn hello as "Hello");
//!
//! let registry = Registry::linked();
//! assert_eq!(registry.activity("Hello")?.name(), "hello");
//! let _agent = Agent::new("greeter", Hz(10)).activity(hello);
//! # Ok::<(), monas_core::Error>(())
//! ```

pub mod activity;
pub mod activity_context;
pub mod activity_name;
pub mod agent;
pub mod binder;
pub mod call;
pub mod call_slot;
pub mod chart_runner;
pub mod coverage;
pub mod duration;
pub mod error;
pub mod frequency;
pub mod function;
pub mod generated;
mod guarded_activity;
pub mod listener;
pub mod memory;
pub mod module;
pub mod monitors;
pub mod parameters;
pub mod publishing_activity;
pub mod records;
pub mod registry;
pub mod run_hash;
pub mod scenario;
pub mod scheduling;
pub mod seeds;
pub mod statistics;
pub mod stopwatch;
pub mod unreachable_sources;
pub mod vocabulary;

pub use activity::{Activity, BoxError, IntoProgress, Progress, Topics};
pub use agent::{Agent, ChartSettings, FailurePolicy};
pub use coverage::{ChartCoverage, StateCoverage, TransitionCoverage};
pub use error::{Error, ErrorKind};
pub use frequency::{Frequency, Hz};
pub use listener::{ChartListener, MicroStep};
pub use module::{BuildFingerprint, Module};
pub use monitors::ViolationResponse;
pub use narukom::{Blackboard, Timestamp};
pub use parameters::{ParameterFault, Parameters};
pub use registry::Registry;
pub use run_hash::RunHash;
pub use statistics::{
    ActivityStatistics, AgentStatistics, BodyStatistics, MovingAverage, Percentiles, Statistics,
};
pub use stopwatch::{Histogram, Stopwatch, TimeSource, TimingGuard, TimingPolicy, Totals};

/// Items used by the expansions of this crate's macros.
#[doc(hidden)]
pub mod linked {
    pub use crate::function::{Argument, FUNCTIONS, FunctionDeclaration, ReturnValue};
    pub use crate::generated::{CHARTS, ChartDeclaration, assembled};
    pub use crate::module::{ModuleAbi, NoteSection, open, padded_length};
    pub use crate::registry::{ACTIVITIES, ActivityDeclaration};
    pub use linkme;
}
