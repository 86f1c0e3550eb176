//! Activities, agents, statechart agents, and Talws, which runs them.
//!
//! A robot's software is made of **activities**: pieces of work with one task each, plain functions on a [`Blackboard`] or types
//! that implement [`Activity`]. An [`Agent`] puts some together: a list that runs so many times a second, or a statechart that
//! decides which of them run when. [`Talws`] holds the agents of a robot, or of a whole team with its bodies and the world
//! around them, and runs them in real time or in simulated time. Nobody else knows which.
//!
//! ```
//! use monas::{Agent, Blackboard, Hz, Talws};
//!
//! fn hello(blackboard: &mut Blackboard) {
//!     println!("hello at {}", blackboard.now());
//! }
//!
//! fn main() -> Result<(), monas::Error> {
//!     let running = Talws::new().agent(Agent::new("greeter", Hz(10)).activity(hello)).start()?;
//!     running.stop();
//!     Ok(())
//! }
//! ```
//!
//! # A chart from a formula
//!
//! A role is a liveness formula (crate `aseme`); its statechart names activities, which [`activity!`] puts into the registry of
//! the program. Guards read messages; what wakes the chart is a message that a guard reads, a timer, or an activity that
//! returns. The test of such a role is ordinary code without threads or sleeping:
//!
//! ```
//! use monas::{Agent, Blackboard, Moment, Talws};
//! use yase::Source;
//!
//! fn look(_: &mut Blackboard) {}
//! fn greet(_: &mut Blackboard) {}
//! monas::activity!(fn look as "Look");
//! monas::activity!(fn greet as "Greet");
//!
//! let role = "
//!     Liveness:
//!     visitor = (Look . Greet)~
//!     Transitions:
//!     Look -> Greet : [wait] / StartTimeout(wait, 500ms)
//! ";
//! let (chart, diagnostics) = aseme::statechart_of(&Source::new("visitor.srm", role));
//! assert!(diagnostics.is_empty());
//!
//! let mut simulation = Talws::new().agent(Agent::statechart("visitor", chart)).simulate(7)?;
//! simulation.run_until(Moment::from_secs_f64(10.0))?;
//! assert_eq!(simulation.statistics().calls("local", "Greet"), 20);
//! # Ok::<(), monas::Error>(())
//! ```
//!
//! # What holds
//!
//! - **A cycle is a transaction.** It begins by delivering what has arrived, runs activities against a blackboard that does
//!   not move meanwhile, and ends by publishing everything at once. No lock is held while an activity runs. Each activity of a
//!   chart is a transaction of its own.
//! - **Time is handed in.** Only the runtime reads a clock, waits or starts a thread. Activities know time and chance through
//!   their blackboard, so that in simulated time the same seed gives the same bytes: [`RunHash`] tells.
//! - **An activity harms nobody else.** One that fails or panics is caught, named in the log with its agent and the cycle, and
//!   handled as the agent's [`Policy`] says.
//! - **What a person writes is answered at once and in full.** [`config`] finds everything that is wrong with a configuration, its
//!   models and their expressions before anything runs.
//! - **What happens can be told.** The [`records`] of every cycle and every micro-step are messages like any other, so that
//!   whatever records topics records them.

mod activity;
mod agent;
mod binder;
mod call;
mod chart;
pub mod config;
mod coverage;
mod error;
mod frequency;
mod function;
pub mod generated;
mod link;
mod list;
mod listener;
pub mod logger;
pub mod memory;
mod module;
mod monitors;
mod origin;
mod parameters;
mod provenance;
mod reach;
pub mod records;
mod registry;
mod run_hash;
pub mod scenario;
mod statistics;
mod stopwatch;
mod talws;
mod vocabulary;

pub use activity::{Activity, BoxError, IntoProgress, Progress, Topics};
pub use agent::{Agent, ChartSettings, Policy};
pub use coverage::{ChartCoverage, StateCoverage, TransitionCoverage};
pub use error::{Error, ErrorKind};
pub use frequency::{Frequency, Hz};
pub use link::{Certificates, Endpoints, LinkConfig, LinkStatistics, LinkTransport};
pub use listener::{ChartListener, MicroStep};
pub use module::{BuildNote, Module, ModuleFile};
pub use monitors::OnViolation;
pub use narukom::{Blackboard, Moment};
pub use parameters::{ParameterFault, Parameters};
pub use provenance::Provenance;
pub use registry::Registry;
pub use run_hash::RunHash;
pub use statistics::{ActivityStatistics, AgentStatistics, Average, Percentiles, Statistics};
pub use stopwatch::{Histogram, Lap, Plain, Stopwatch, TimeSource, TimingPolicy};
pub use talws::{HostConfig, Overview, Running, Simulation, Stopper, Talws, World};

/// Running agents again on what was recorded: [`Talws::replay`], and [`Talws::replay_real_time`].
pub mod replay {
    pub use crate::talws::{Company, Difference, Input, Recorded, RecordedMessage, Replay, Tally};
}

/// What the benches of this crate measure from inside.
#[doc(hidden)]
pub mod measured {
    pub use crate::talws::measured::RoundTrip;
}

/// What the macros of this crate expand to.
#[doc(hidden)]
pub mod linked {
    pub use crate::function::{Answer, Argument, FUNCTIONS, FunctionDeclaration};
    pub use crate::generated::{CHARTS, ChartDeclaration, assembled};
    pub use crate::module::{Gate, NoteSection, open, padded_length};
    pub use crate::registry::{ACTIVITIES, ActivityDeclaration};
    pub use linkme;
}

/// The Rust of the chapters in `docs`, which is tested with the documentation.
#[cfg(doctest)]
mod chapters {
    #[doc = include_str!("../../../docs/first-agent.md")]
    mod first_agent {}
    #[doc = include_str!("../../../docs/first-chart.md")]
    mod first_chart {}
    #[doc = include_str!("../../../docs/messages.md")]
    mod messages {}
    #[doc = include_str!("../../../docs/modules.md")]
    mod modules {}
    #[doc = include_str!("../../../docs/porting.md")]
    mod porting {}
    #[doc = include_str!("../../../docs/time.md")]
    mod time {}
}
