//! Activities, agents, statechart agents, and Talws, which runs them.
//!
//! The software of a robot consists of **activities**: units of behaviour with one task each, plain
//! functions on a [`Blackboard`] or types that implement [`Activity`]. An [`Agent`] groups
//! activities: a list with a frequency, or a statechart that selects the running activities.
//! [`Talws`] holds the agents of one robot, or of a team with its bodies and the world, and
//! executes them in real or simulated time. Activities and agents do not depend on which.
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
//! A role is a liveness formula (crate `aseme`); its statechart names activities, which
//! [`activity!`] adds to the registry of the program. Guards read messages; the chart wakes up for
//! a message that a guard reads, a timer, or an activity that returns. A test of such a role is
//! ordinary code without threads or sleeping:
//!
//! ```
//! use monas::{Agent, Blackboard, Talws, Timestamp};
//! use yase::Source;
//!
//! fn watch(_: &mut Blackboard) {}
//! fn greet(_: &mut Blackboard) {}
//! monas::activity!(fn watch as "Watch");
//! monas::activity!(fn greet as "Greet");
//!
//! let role = "
//!     Liveness:
//!     visitor = (Watch . Greet)~
//!     Transitions:
//!     Watch -> Greet : [wait] / StartTimeout(wait, 500ms)
//! ";
//! let (chart, diagnostics) = aseme_models::statechart_of(&Source::new("visitor.srm", role));
//! assert!(diagnostics.is_empty());
//!
//! let mut simulation = Talws::new().agent(Agent::statechart("visitor", chart)).simulate(7)?;
//! simulation.run_until(Timestamp::from_secs_f64(10.0))?;
//! assert_eq!(simulation.statistics().calls("local", "Greet"), 20);
//! # Ok::<(), monas::Error>(())
//! ```
//!
//! # Guarantees
//!
//! - **A cycle is a transaction.** It first delivers messages, then runs activities on a blackboard
//!   that does not change meanwhile, and publishes all outputs at its end. No lock is held while an
//!   activity runs. Each activity of a chart is a transaction.
//! - **Time is an input.** Only the runtime reads a clock, waits or starts a thread. Activities
//!   read time and random numbers from their blackboard, so that in simulated time equal seeds give
//!   equal bytes: [`RunHash`] verifies it.
//! - **Failures are isolated.** An activity that fails or panics is caught, logged with its agent
//!   and cycle, and handled by the agent's [`FailurePolicy`].
//! - **Configurations are checked completely.** [`config`] reports all errors of a configuration,
//!   its models and their expressions before anything runs.
//! - **Execution is observable.** The [`records`] of all cycles and micro-steps are ordinary
//!   messages, so that every recorder of topics records them.

pub use monas_core::{
    Activity, ActivityStatistics, Agent, AgentStatistics, Blackboard, BodyStatistics, BoxError,
    BuildFingerprint, ChartCoverage, ChartListener, ChartSettings, Error, ErrorKind, FailurePolicy,
    Frequency, Histogram, Hz, IntoProgress, MicroStep, Module, MovingAverage, ParameterFault, Parameters,
    Percentiles, Progress, Registry, RunHash, StateCoverage, Statistics, Stopwatch, TimeSource, Timestamp,
    TimingGuard, TimingPolicy, Topics, Totals, TransitionCoverage, ViolationResponse,
};
pub use monas_core::{activity, function, module, statechart};
pub use monas_core::{activity_name, call, call_slot, duration, generated, memory, records, scenario};

pub use monas_config as config;
pub use monas_config::ConfigurationBundle;
pub use monas_link::{Certificates, LinkConfig, LinkStatistics, LinkTransport, ZenohEndpoints};
pub use monas_log as logger;
pub use monas_log::fatal;
pub use monas_module::{ModuleFile, seal as seal_module};
pub use monas_runtime::replay;
pub use monas_runtime::{
    HostConfig, RealTimeRun, RunHandle, Simulation, StopHandle, Talws, World, cpu_time, permits_real_time,
};

/// Items used by the expansions of macros.
#[doc(hidden)]
pub use monas_core::linked;

/// The Rust examples of the chapters in `docs`, tested with the documentation.
#[cfg(doctest)]
mod chapters {
    #[doc = include_str!("../../../docs/cookbook.md")]
    mod cookbook {}
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
